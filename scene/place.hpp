// SPDX-License-Identifier: Apache-2.0
// Where a message about a file points.
#pragma once

#include <string>

#include "config/config.hpp"
#include "config/one_line.hpp"

namespace bitspan {

// A line of a text, from 1, or a byte of a binary file, from 0. The key comes with the message.
struct Place {
  std::string file;
  long at = 0;
  bool is_byte = false;

  // Throws InputError "file:line: what" or "file: byte N: what".
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(one_line(file + (is_byte ? ": byte " : ":") + std::to_string(at) + ": " + what));
  }
};

}  // namespace bitspan
