// SPDX-License-Identifier: Apache-2.0
#include "scene/lines.hpp"

#include "scene/mesh_text.hpp"

namespace bitspan {

std::string_view StatementLines::take_line() {
  std::size_t end = 0;
  while (end < rest_.size() && rest_[end] != '\n' && rest_[end] != '\r') ++end;
  const std::string_view line = rest_.substr(0, end);
  const bool is_pair = rest_.substr(end).starts_with("\r\n");
  rest_.remove_prefix(end + (end == rest_.size() ? 0 : is_pair ? 2 : 1));
  ++lines_;
  return line;
}

bool StatementLines::next(std::string_view& statement) {
  while (!rest_.empty()) {
    std::string_view line = take_line();
    number_ = lines_;
    while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    if (line.empty() || line.front() == '#') continue;
    if (line.ends_with('\\') && !rest_.empty()) {
      joined_ = line;
      while (joined_.ends_with('\\') && !rest_.empty()) {
        joined_.back() = ' ';
        joined_ += take_line();
      }
      line = joined_;
    }
    statement = line;
    return true;
  }
  return false;
}

}  // namespace bitspan
