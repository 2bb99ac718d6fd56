// SPDX-License-Identifier: Apache-2.0
// What a file holds may stand in a message, which is one line whatever it is.
#pragma once

#include <algorithm>
#include <string>

namespace bitspan {

inline std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

}  // namespace bitspan
