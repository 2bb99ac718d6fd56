// SPDX-License-Identifier: Apache-2.0
#include "study/settings.hpp"

#include <nlohmann/json.hpp>
#include <variant>

#include "io/json_depth.hpp"

namespace bitspan {

std::string settings_json(const std::vector<KeySetting>& settings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const KeySetting& s : settings) {
    std::visit([&](const auto& value) { json[s.path] = value; }, s.value);
  }
  return json.dump();
}

std::vector<KeySetting> parse_settings(std::string_view settings_json) {
  std::vector<KeySetting> out;
  try {
    check_json_depth(settings_json);
    const auto json = nlohmann::ordered_json::parse(settings_json);
    for (const auto& [path, value] : json.items()) {
      if (value.is_boolean()) {
        out.push_back({path, value.get<bool>()});
      } else if (value.is_number_integer()) {
        out.push_back({path, value.get<std::int64_t>()});
      } else if (value.is_number()) {
        out.push_back({path, value.get<double>()});
      } else {
        out.push_back({path, value.get<std::string>()});
      }
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(std::string("a point's settings are unreadable: ") + error.what());
  }
  return out;
}

}  // namespace bitspan
