// SPDX-License-Identifier: Apache-2.0
// The families of FPGAs, the parts of the RTL that are synthesised, and what a netlist has.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace bitspan {

enum class Family : std::uint8_t {
  ice40,  // LUT4s, no multipliers; placed in the largest: HX8K
  ecp5,   // LUT4s, 18x18 multipliers, block memory; placed in the LFE5U-85F, speed 6
};
inline constexpr std::array families{Family::ice40, Family::ecp5};
inline constexpr auto family_names = std::to_array<std::string_view>({"ice40", "ecp5"});  // in their order
std::string_view to_string(Family family);
Family family_named(std::string_view name);  // throws InputError, which names those that exist

// What is synthesised by itself.
enum class AreaPart : std::uint8_t {
  spans,        // rtl/span_interpolator.sv, under rtl/area_top.sv
  pixels,       // rtl/pixel_pipe.sv with the depth test in front of texture
  late_pixels,  // the same with the depth test behind texture, and a stencil test
};
inline constexpr std::array area_parts{AreaPart::spans, AreaPart::pixels, AreaPart::late_pixels};
inline constexpr auto area_part_names =
    std::to_array<std::string_view>({"spans", "pixels", "late_pixels"});  // in their order
std::string_view to_string(AreaPart part);
AreaPart area_part_named(std::string_view name);  // throws InputError, which names those that exist
// Returns "", "pixel_" or "late_pixel_", which the names of a part's metrics and tables have in front.
std::string_view prefix_of(AreaPart part);

// A part in a family.
struct AreaTarget {
  Family family = Family::ice40;
  AreaPart part = AreaPart::spans;
  bool operator==(const AreaTarget&) const = default;
  bool operator<(const AreaTarget& other) const {
    return std::pair(family, part) < std::pair(other.family, other.part);
  }
};
// Returns what the names of its metrics of a kind begin with: "estimate.ice40.", "area.ecp5.late_pixel_".
std::string metric_prefix(std::string_view kind, AreaTarget target);
// Returns what a metric is of; nothing where it is none of that kind.
std::optional<AreaTarget> target_of(std::string_view kind, std::string_view metric);

// What the netlist has. The count of a kind of cell that the family lacks is 0.
struct AreaCounts {
  std::int64_t luts = 0;         // LUT4s, those inside carry cells and LUT memory included
  std::int64_t ffs = 0;          // flip-flops
  std::int64_t multipliers = 0;  // 18x18 blocks
  std::int64_t memory_bits = 0;  // capacity of the block memories taken
  bool operator==(const AreaCounts&) const = default;
};

}  // namespace bitspan
