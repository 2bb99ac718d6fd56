// SPDX-License-Identifier: Apache-2.0
// Configurations by name (those in the binary) or by path.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "config/config.hpp"

namespace bitspan {

struct ShippedConfig {
  std::string_view name;  // "depth16"
  std::string_view text;  // the TOML file
};
std::span<const ShippedConfig> config_texts();

inline constexpr std::string_view default_config = "depth16";

// A shipped name, or else a file. Throws InputError that lists the names where it is neither.
Config find_config(const std::string& name_or_path);
// "depth16, depth20, ..."
std::string names_of_shipped();

}  // namespace bitspan
