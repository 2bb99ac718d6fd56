// SPDX-License-Identifier: Apache-2.0
#include "study/search/texts.hpp"

#include <fmt/format.h>

namespace bitspan::searching {

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

std::string value_text(const Axis& axis, std::size_t i) { return axis_text(axis, axis.values[i]); }

std::string limits_text(const Constraint& c) {
  std::vector<std::string> parts;
  if (c.at_least) parts.push_back(fmt::format("at least {}", *c.at_least));
  if (c.at_most) parts.push_back(fmt::format("at most {}", *c.at_most));
  return joined(parts, ", ");
}

}  // namespace bitspan::searching
