// SPDX-License-Identifier: Apache-2.0
// The families of FPGAs, and what a netlist has in them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace bitspan {

enum class Family : std::uint8_t {
  ice40,  // LUT4s, no multipliers; placed in the largest: HX8K
  ecp5,   // LUT4s, 18x18 multipliers, block memory; placed in the LFE5U-85F, speed 6
};
inline constexpr std::array families{Family::ice40, Family::ecp5};
inline constexpr auto family_names = std::to_array<std::string_view>({"ice40", "ecp5"});  // in their order
std::string_view to_string(Family family);
Family family_named(std::string_view name);  // throws InputError, which names those that exist

// What the netlist has. The count of a kind of cell that the family lacks is 0.
struct AreaCounts {
  std::int64_t luts = 0;         // LUT4s, those inside carry cells and LUT memory included
  std::int64_t ffs = 0;          // flip-flops
  std::int64_t multipliers = 0;  // 18x18 blocks
  std::int64_t memory_bits = 0;  // capacity of the block memories taken
  bool operator==(const AreaCounts&) const = default;
};

}  // namespace bitspan
