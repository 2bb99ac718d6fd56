// SPDX-License-Identifier: Apache-2.0
#include "io/json_depth.hpp"

#include <string>

#include "config/config.hpp"

namespace bitspan {

void check_json_depth(std::string_view text) {
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
      if (++depth <= json_depth_limit) continue;
      throw InputError("line " + std::to_string(line) +
                       ": arrays and objects are nested too deep; expected at most " +
                       std::to_string(json_depth_limit) + " in each other");
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

}  // namespace bitspan
