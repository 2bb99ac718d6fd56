// SPDX-License-Identifier: Apache-2.0
// Which integers hold an exact value, by its grid. Stages ask once, when they are prepared.
#pragma once

#include "config/grid.hpp"
#include "model/numeric/exact.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

// Integers of up to this many bits, and their negatives.
constexpr Grid integer_grid(int bits) { return {bits, 0, true}; }

// One bit is kept back.
constexpr bool fits_int64(Grid a) { return as_signed(a).bits() <= 63 && a.fraction <= 62 && a.integer <= 62; }

// Bounds of magnitudes, as unsigned grids: |x| <= 2^integer, with equality at a signed register's least
// value. Sums and products of such grids bound the magnitudes of sums and products in the same way.
constexpr Grid magnitude_of(const Register& r) {
  return {(r.is_signed ? r.word - 1 : r.word) - r.fraction, r.fraction, false};
}
constexpr Grid magnitude_of(Exact x) {
  return {bit_length(static_cast<uint128>(x.raw < 0 ? -x.raw : x.raw)) - x.fraction, x.fraction, false};
}

// Terms of up to 2^term_bits: three of them and what rounding adds stay within 63 bits.
inline constexpr int term_bits = 60;
// Sums of two registers that lanes hold in 64 bits, by their magnitudes.
constexpr bool lanes_hold(Grid magnitude) { return magnitude.bits() <= 61; }

}  // namespace bitspan::model
