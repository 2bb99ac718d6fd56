// SPDX-License-Identifier: Apache-2.0
// SystemC's seven quantisation modes as one truth table each: whether to add one to the floor.
#pragma once

#include <array>
#include <cstdint>

#include "config/format.hpp"

namespace bitspan::model {

// guard: the highest dropped bit (weight 1/2 of the kept unit); sticky: any dropped bit below it is set;
// odd: lowest bit of the floor; negative: the exact value is below zero.
constexpr bool rounds_up(Rounding mode, bool negative, bool odd, bool guard, bool sticky) {
  switch (mode) {
    case Rounding::rnd:
      return guard;
    case Rounding::rnd_zero:
      return guard && (sticky || negative);
    case Rounding::rnd_min_inf:
      return guard && sticky;
    case Rounding::rnd_inf:
      return guard && (sticky || !negative);
    case Rounding::rnd_conv:
      return guard && (sticky || odd);
    case Rounding::trn:
      return false;
    case Rounding::trn_zero:
      return negative && (guard || sticky);
  }
  return false;
}

// Bit (8 negative + 4 odd + 2 guard + sticky) is rounds_up of these.
constexpr std::uint16_t rounding_table(Rounding mode) {
  unsigned table = 0;
  for (unsigned i = 0; i < 16; ++i) {
    if (rounds_up(mode, (i & 8) != 0, (i & 4) != 0, (i & 2) != 0, (i & 1) != 0)) {
      table |= 1U << i;
    }
  }
  return static_cast<std::uint16_t>(table);
}

}  // namespace bitspan::model
