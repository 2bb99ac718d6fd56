// SPDX-License-Identifier: Apache-2.0
// Reads and sets any key of a configuration by its path, as in the TOML file: "formats.span.h.word",
// "depth.bits", "reciprocal.pixel.kind", "start_offset.span_h". Each format has one key more, "fraction"
// (word - int). Where it is set, the word follows from it and from int.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/keys.hpp"

namespace bitspan {

struct KeySetting {
  std::string path;
  KeyValue value;
  bool operator==(const KeySetting&) const = default;
};

// Returns the configuration with the keys set, checked, so that every rule holds. Its name is the base's.
// Throws InputError, which names the key, where the key is unknown (with the nearest that exist), where the
// value is of another type, and where the result is illegal.
Config with_keys(const Config& base, const std::vector<KeySetting>& settings);
KeyValue value_of_key(const Config& config, std::string_view path);
// Returns all paths, sorted.
std::vector<std::string> all_keys();

// Returns up to three of `known` that are spelt most like `name`, or whose table it is.
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> known);
// Returns "a, b, c".
std::string comma_list(std::span<const std::string> names);

}  // namespace bitspan
