// SPDX-License-Identifier: Apache-2.0
// Configurations of the interface.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "bitspan/bitspan.h"
#include "config/config.hpp"

namespace bitspan::capi {

struct ConfigState {
  std::mutex mutex;  // of what follows
  Config config;
  std::string hash, text;  // what the caller was given
};

// Returns a new handle.
bs_config* add(Config config);
// A copy. Throws BS_BAD_HANDLE.
Config copy_of(const bs_config* handle, const char* function);

}  // namespace bitspan::capi
