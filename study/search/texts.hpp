// SPDX-License-Identifier: Apache-2.0
// Writes the keys and values of a search as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/search/search.hpp"

namespace bitspan::searching {

std::string joined(const std::vector<std::string>& parts, std::string_view separator);
std::string value_text(const Axis& axis, std::size_t i);

}  // namespace bitspan::searching
