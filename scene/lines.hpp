// SPDX-License-Identifier: Apache-2.0
// The lines of OBJ and MTL files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace bitspan {

// Hands out the statements of a text: lines that end with \n, \r\n or \r, joined where a backslash ends a
// line that is no comment. Blank lines and comments are skipped.
class StatementLines {
 public:
  explicit StatementLines(std::string_view text) : rest_(text) {}

  // Returns false at the end. `statement` is valid until the next call.
  bool next(std::string_view& statement);

  // The number of the statement's first line, from 1.
  std::size_t number() const { return number_; }

 private:
  std::string_view take_line();

  std::string_view rest_;
  std::string joined_;
  std::size_t number_ = 0;
  std::size_t lines_ = 0;
};

}  // namespace bitspan
