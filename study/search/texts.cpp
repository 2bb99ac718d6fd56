// SPDX-License-Identifier: Apache-2.0
#include "study/search/texts.hpp"

#include <fmt/format.h>

namespace bitspan::searching {

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

std::string value_text(const Axis& axis, std::size_t i) { return axis_text(axis, axis.values[i]); }

}  // namespace bitspan::searching
