// SPDX-License-Identifier: Apache-2.0
// What a study varies.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "study/keys.hpp"

namespace bitspan {

// Keys that are set together, and the sets of values that they take in turn.
struct Axis {
  std::vector<std::string> keys;
  std::vector<std::vector<KeyValue>> values;  // values[i][k]: of keys[k]
  std::string name = {};                      // shown in place of the keys; may be empty
  // Each key's value is the axis's own value plus the key's offset. Empty where values are given per key.
  std::vector<std::int64_t> offsets = {};
};

// Whether the axis has strings and booleans, which a search does not order.
bool is_category(const Axis& axis);
// Returns what an axis is called: its name, or its keys, joined by ", ".
std::string axis_title(const Axis& axis);
// Returns the values that an axis gives to its keys as text: per key, joined by ", ". A named axis whose keys
// follow from one value shows that value.
std::string axis_text(const Axis& axis, const std::vector<KeyValue>& values);
// Returns that text for the settings of a point, and "" where they do not set all keys of the axis.
std::string axis_text(const Axis& axis, const std::vector<KeySetting>& point);

// This key alone belongs to the scenes and not to the configuration. Its value is the s_max / s_min to which
// every scene is stretched (with_s_ratio), a real number above 1.
inline constexpr std::string_view s_ratio_key = "scene.s_ratio";
inline constexpr double s_ratio_limit = 1e6;
bool varies_scenes(const Axis& axis);  // whether the axis sets that key

}  // namespace bitspan
