// SPDX-License-Identifier: Apache-2.0
#include "cli/config_store.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace bitspan {

std::string shipped_names() {
  std::string out;
  for (const ShippedConfig& shipped : shipped_configs()) {
    out += fmt::format("{}{}", out.empty() ? "" : ", ", shipped.name);
  }
  return out;
}

Config find_config(const std::string& name_or_path) {
  for (const ShippedConfig& shipped : shipped_configs()) {
    if (shipped.name == name_or_path) {
      Config config = parse_config(shipped.text, fmt::format("config/{}.toml", shipped.name));
      config.name = shipped.name;
      return config;
    }
  }
  std::error_code ignored;
  if (!std::filesystem::exists(name_or_path, ignored)) {
    throw InputError(
        fmt::format("{}: no such configuration file; shipped names: {}", name_or_path, shipped_names()));
  }
  return load_config(name_or_path);
}

}  // namespace bitspan
