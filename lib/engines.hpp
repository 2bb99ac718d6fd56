// SPDX-License-Identifier: Apache-2.0
// The engines of the C interface: those inside, and those of plug-ins, which are loaded when first asked for.
//
// The plug-in NAME is libbitspan-NAME.so in the folder that $BITSPAN_PLUGINS names, else in bitspan/ beside
// the library. It stays loaded.
#pragma once

#include <string_view>
#include <vector>

#include "engine/registry.hpp"

namespace bitspan::capi {

// Those inside in the registry's order, then those whose plug-in is there. The texts end with a zero.
std::vector<std::string_view> engine_list();

// Throws BS_BAD_INPUT where there is no such engine; BS_UNSUPPORTED where its plug-in is missing, cannot be
// loaded, or comes from another build.
const EngineEntry& engine_entry(std::string_view name);

}  // namespace bitspan::capi
