// SPDX-License-Identifier: Apache-2.0
// Lg of docs/numeric-spec.md: the binary logarithm, linear between powers of two.
#pragma once

#include "model/numeric/exact.hpp"

namespace bitspan::model {

// Lg(raw 2^-fraction), raw > 0: the exponent, and the rest of it taken as linear.
constexpr Exact linear_log2(uint128 raw, int fraction) {
  const int top = bit_length(raw) - 1;
  const int128 rest = static_cast<int128>(raw) - (int128{1} << top);
  return Exact{top - fraction, 0} + Exact{rest, top};
}

}  // namespace bitspan::model
