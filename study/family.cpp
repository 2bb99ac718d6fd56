// SPDX-License-Identifier: Apache-2.0
#include "study/family.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "config/config.hpp"

namespace bitspan {

std::string_view to_string(Family family) { return family_names[static_cast<std::size_t>(family)]; }

Family family_named(std::string_view name) {
  const auto found = std::ranges::find(family_names, name);
  if (found == family_names.end())
    throw InputError(fmt::format("'{}' is no family; legal: {}", name, fmt::join(family_names, ", ")));
  return families[static_cast<std::size_t>(found - family_names.begin())];
}

}  // namespace bitspan
