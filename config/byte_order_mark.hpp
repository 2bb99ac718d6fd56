// SPDX-License-Identifier: Apache-2.0
// Some programs write a mark in front of UTF-8.
#pragma once

#include <string_view>

namespace bitspan {

// Returns the text behind a UTF-8 byte order mark, if there is one.
inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
}

}  // namespace bitspan
