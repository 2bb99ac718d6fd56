// SPDX-License-Identifier: Apache-2.0
// The canonical text of a configuration, and the hash over it.
#include <array>
#include <cstdio>

#include "config/fnv.hpp"
#include "config/keys.hpp"

namespace bitspan {
namespace {

std::string in_quotes(std::string_view text) { return std::string("\"").append(text).append("\""); }

// A value as TOML; a format's fields are given as a table of their own.
std::string toml_value(const Config& config, const Key& key) {
  const Place at = place(config, key);
  if (std::holds_alternative<Format*>(at)) {
    std::string out;
    for (const FieldRow& field : field_rows()) {
      const Key part{"", 0, key.row, key.i, &field};
      if (is_left_out(config, part)) continue;
      out.append(out.empty() ? "{ " : ", ").append(field.name).append(" = ").append(toml_value(config, part));
    }
    return out + " }";
  }
  const KeyValue value = value_of(config, key);
  const auto* text = std::get_if<std::string>(&value);
  const bool list =
      (std::holds_alternative<Color*>(at) || std::holds_alternative<Rgba*>(at)) && text->starts_with('[');
  return text == nullptr || list ? to_string(value) : in_quotes(*text);
}

}  // namespace

std::string to_toml(const Config& config) {
  std::string out;
  std::string_view table;
  for (const Key& key : entries()) {
    if (is_left_out(config, key)) continue;
    if (table != key.table()) {
      table = key.table();
      out.append(out.empty() ? "[" : "\n[").append(table).append("]\n");
    }
    const bool dotted = key.name().find('.') != std::string_view::npos;
    out.append(dotted ? in_quotes(key.name()) : std::string(key.name()));
    out.append(" = ").append(toml_value(config, key)).append("\n");
  }
  return out;
}

std::string config_hash(const Config& config) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx",
                static_cast<unsigned long long>(fnv64(to_toml(used_part(config)))));
  return text.data();
}

}  // namespace bitspan
