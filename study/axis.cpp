// SPDX-License-Identifier: Apache-2.0
#include "study/axis.hpp"

#include <algorithm>
#include <cstddef>
#include <variant>

namespace bitspan {

bool is_category(const Axis& axis) {
  if (axis.values.empty() || axis.values[0].empty()) return false;
  const KeyValue& first = axis.values[0][0];
  return std::holds_alternative<std::string>(first) || std::holds_alternative<bool>(first);
}

std::string axis_title(const Axis& axis) { return axis.name.empty() ? comma_list(axis.keys) : axis.name; }

std::string axis_text(const Axis& axis, const std::vector<KeyValue>& values) {
  std::vector<std::string> parts;
  std::vector<KeyValue> own;  // what the keys follow from
  for (std::size_t k = 0; k < values.size(); ++k) {
    parts.push_back(to_string(values[k]));
    own.push_back(axis.offsets.empty() ? values[k]
                                       : KeyValue(std::get<std::int64_t>(values[k]) - axis.offsets[k]));
  }
  const bool one = std::ranges::all_of(own, [&](const KeyValue& v) { return v == own.front(); });
  return !axis.name.empty() && one ? to_string(own.front()) : comma_list(parts);
}

std::string axis_text(const Axis& axis, const std::vector<KeySetting>& point) {
  std::vector<KeyValue> values;
  for (const std::string& key : axis.keys) {
    const auto set = std::ranges::find(point, key, &KeySetting::path);
    if (set == point.end()) return "";
    values.push_back(set->value);
  }
  return axis_text(axis, values);
}

bool varies_scenes(const Axis& axis) { return std::ranges::find(axis.keys, s_ratio_key) != axis.keys.end(); }

}  // namespace bitspan
