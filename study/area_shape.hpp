// SPDX-License-Identifier: Apache-2.0
// The structure of the RTL that a configuration asks for, as rtl/ builds it: registers, operands of
// multipliers, adders, choices, divider steps, memories.
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "study/family.hpp"

namespace bitspan {

constexpr int ceil_div(int n, int d) { return (n + d - 1) / d; }

// A memory or a table, as it may become blocks, memories of LUTs or flip-flops.
struct Memory {
  enum class Kind : std::uint8_t {
    table,      // constants, read into registers
    clocked,    // read into registers
    unclocked,  // read in the same clock, which no block does
    line,       // read into registers, and asked for as a memory of LUTs (rtl/ring_line.sv)
  };
  int words = 0, width = 0;
  Kind kind = Kind::clocked;
  int reads = 1;  // ports
};
// Returns the blocks that it takes, 0 where it is in LUTs or flip-flops.
int memory_blocks(const Memory& memory, Family family);

// The counts that the estimate is linear in, taken from the configuration. All but `blocks` are bits.
struct AreaShape {
  double registers = 0;  // flip-flops
  double products = 0;   // products of the operands' widths, over all multipliers
  double blocks = 0;     // 18x18 multipliers that these products are cut into
  double joins = 0;      // adders that join the blocks' results
  double sums = 0;       // other adders: differences, roundings, accumulators
  double selects = 0;    // two-way choices: shifters, operands of span_setup's multipliers, saturation
  double steps = 0;      // restoring division: a bit subtracted and chosen
  double chained = 0;    // steps behind another one of the same clock; doubled where the numerator varies
  std::vector<Memory> memories;
};
// Throws InputError where the configuration has no such RTL. The family says which memories keep bits that
// nobody reads.
AreaShape area_shape(const Config& config, AreaTarget target = {});

// The same of rtl/span_interpolator.sv, and of rtl/pixel_pipe.sv.
AreaShape span_shape(const Config& config);
AreaShape pixel_shape(const Config& config, AreaTarget target);

}  // namespace bitspan
