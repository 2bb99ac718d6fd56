// SPDX-License-Identifier: Apache-2.0
#include "study/family.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "config/config.hpp"

namespace bitspan {
namespace {

// Returns the value whose name it is.
template <class Values, class Names>
auto named(std::string_view name, const Values& values, const Names& names, std::string_view what) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw InputError(fmt::format("'{}' is no {}; legal: {}", name, what, fmt::join(names, ", ")));
  return values[static_cast<std::size_t>(found - names.begin())];
}

}  // namespace

std::string_view to_string(Family family) { return family_names[static_cast<std::size_t>(family)]; }
Family family_named(std::string_view name) { return named(name, families, family_names, "family"); }

std::string_view to_string(AreaPart part) { return area_part_names[static_cast<std::size_t>(part)]; }
AreaPart area_part_named(std::string_view name) {
  return named(name, area_parts, area_part_names, "part of the RTL");
}

std::string_view prefix_of(AreaPart part) {
  constexpr auto prefixes = std::to_array<std::string_view>({"", "pixel_", "late_pixel_"});
  return prefixes[static_cast<std::size_t>(part)];
}

std::string metric_prefix(std::string_view kind, AreaTarget target) {
  return fmt::format("{}.{}.{}", kind, to_string(target.family), prefix_of(target.part));
}

std::optional<AreaTarget> target_of(std::string_view kind, std::string_view metric) {
  for (const Family family : families) {
    // The spans' prefix begins those of the others.
    for (const AreaPart part : {AreaPart::late_pixels, AreaPart::pixels, AreaPart::spans}) {
      if (metric.starts_with(metric_prefix(kind, {family, part}))) return AreaTarget{family, part};
    }
  }
  return std::nullopt;
}

}  // namespace bitspan
