// SPDX-License-Identifier: Apache-2.0
#include "study/search/texts.hpp"

#include <fmt/format.h>

namespace bitspan::searching {

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

std::string key_text(const Axis& axis) { return joined(axis.keys, ", "); }

std::string value_text(const Axis& axis, std::size_t i) {
  std::vector<std::string> parts;
  for (const KeyValue& v : axis.values[i]) parts.push_back(to_string(v));
  return joined(parts, ", ");
}

}  // namespace bitspan::searching
