// SPDX-License-Identifier: Apache-2.0
// Widths and shifts of the multipliers of the RTL's span_setup, as a pure function of the configuration.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/grid.hpp"
#include "config/rtl_timing.hpp"

namespace bitspan {

// A start offset as raw 2^-fraction, exactly: at most the 53 bits of a double's significand.
struct ExactOffset {
  std::int64_t raw = 0;
  int fraction = 0;
};
// What is added where a line starts along a row.
ExactOffset start_offset(const Config& config, const Line& line);

// p = x_first + 1/2 - x_l.
Grid pre_step(const Config& config);

// All multipliers are equal: each forms a b 2^-shift + c for whichever product has its slot.
struct RowMultipliers {
  int count = 0;  // multipliers that the schedule uses
  int products =
      0;  // places up to the last product that there is; the Newton unit's products stand behind them
  int a = 1, b = 1;  // bits of the factors, signed; a is the wider one
  int c = 1;         // bits of what is added
  int below = 1;     // bits of a sum below its output's last place
  int sum = 0;       // bits of a sum
  int shift_base = 0;
  int shift_max = 0;                            // largest shift, shift_base not counted
  std::array<int, row_product_count> shifts{};  // of each product, without its exponent and shift_base
};
RowMultipliers row_multipliers(const Config& config, const RowSchedule& schedule);

}  // namespace bitspan
