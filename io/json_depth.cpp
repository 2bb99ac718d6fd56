// SPDX-License-Identifier: Apache-2.0
#include "io/json_depth.hpp"

#include <string>

#include "config/config.hpp"

namespace bitspan {

std::optional<int> line_nested_too_deep(std::string_view text) {
  int depth = 0, line = 1;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (c == '"') {
      in_string = !in_string;
    } else if (in_string) {
      i += c == '\\' ? 1 : 0;
    } else if (c == '[' || c == '{') {
      if (++depth > json_depth_limit) return line;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::nullopt;
}

void check_json_depth(std::string_view text) {
  const std::optional<int> line = line_nested_too_deep(text);
  if (!line) return;
  throw InputError("line " + std::to_string(*line) +
                   ": arrays and objects are nested too deep; expected at most " +
                   std::to_string(json_depth_limit) + " in each other");
}

}  // namespace bitspan
