// SPDX-License-Identifier: Apache-2.0
#include "config/store.hpp"

#include <filesystem>

namespace bitspan {

std::string names_of_shipped() {
  std::string out;
  for (const ShippedConfig& shipped : config_texts()) {
    out.append(out.empty() ? "" : ", ").append(shipped.name);
  }
  return out;
}

Config find_config(const std::string& name_or_path) {
  for (const ShippedConfig& shipped : config_texts()) {
    if (shipped.name == name_or_path) {
      Config config = parse_config(shipped.text, "config/" + std::string(shipped.name) + ".toml");
      config.name = shipped.name;
      return config;
    }
  }
  std::error_code ignored;
  if (!std::filesystem::exists(name_or_path, ignored)) {
    throw InputError(name_or_path + ": no such configuration file; shipped names: " + names_of_shipped());
  }
  return load_config(name_or_path);
}

}  // namespace bitspan
