// SPDX-License-Identifier: Apache-2.0
// The settings of a point as the database has them, JSON.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/keys.hpp"

namespace bitspan {

// settings_json returns {"formats.span.h.word": 34, ...} in the order of the settings, and parse_settings
// reads it back. parse_settings throws InputError where the text is unreadable.
std::string settings_json(const std::vector<KeySetting>& settings);
std::vector<KeySetting> parse_settings(std::string_view settings_json);

}  // namespace bitspan
