// Any key of a configuration by its path, as in the TOML file: "formats.span.h.word", "depth.bits",
// "reciprocal.pixel.kind", "start_offset.span_h". Each format has one key more, "fraction" (word - int):
// where it is set, the word follows from it and from int.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "config/config.hpp"

namespace bitspan {

// "texture.transparent" is the string "none" or "[255, 0, 255]".
using KeyValue = std::variant<bool, std::int64_t, double, std::string>;

struct KeySetting {
  std::string path;
  KeyValue value;
  bool operator==(const KeySetting&) const = default;
};

// The configuration with the keys set, read again by the strict reader, so that every rule holds. Its name is
// the base's. Throws InputError naming the key: where it is unknown (with the nearest that exist), of another
// type, or where the result is illegal.
Config with_keys(const Config& base, const std::vector<KeySetting>& settings);
KeyValue value_of_key(const Config& config, std::string_view path);
std::vector<std::string> all_keys(const Config& config);
std::string to_string(const KeyValue& value);

// Up to three of `known` that are spelt most like `name`, or that begin with it as a table of theirs.
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> known);
// "a, b, c"
std::string comma_list(std::span<const std::string> names);

}  // namespace bitspan
