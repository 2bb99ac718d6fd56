// SPDX-License-Identifier: Apache-2.0
// The one narrowing routine: Q[name](x) of docs/numeric-spec.md.
//
// Everything that drops bits ends in narrow(): a binary fraction (quantize), a quotient (quantize_ratio in
// ratio.hpp), a double (quantize of exact_of(double)). Any of 7 x 5 modes; the source's fraction may be
// above, at or below the target's, by any amount.
#pragma once

#include <cstdint>

#include "model/numeric/exact.hpp"
#include "model/numeric/observe.hpp"
#include "model/numeric/overflow.hpp"
#include "model/numeric/register.hpp"

namespace bitspan::model {

//  exact value, on the register's grid:   floor . guard (sticky ...)
//                                    kept bits ^ 1/2   below it
//
// dropped() is the dropped part in 2^-32 ulp, rounded down; it is called only where an observer listens.
template <class Int, class Watch, class Dropped>
inline std::int64_t narrow(Int floor, bool guard, bool sticky, const Register& r, Watch watch,
                           Dropped dropped) {
  const unsigned row = (floor < 0 ? 8U : 0U) | (static_cast<unsigned>(floor) & 1U) << 2 | (guard ? 2U : 0U) |
                       (sticky ? 1U : 0U);
  const auto up = static_cast<Int>((static_cast<unsigned>(r.rounding) >> row) & 1U);
  const Int rounded = floor + up;
  const bool in_range = rounded >= r.min && rounded <= r.max;
  if constexpr (Watch::enabled) {
    watch.note(r, rounded, in_range, (static_cast<std::int64_t>(up) << bias_fraction) - dropped());
  }
  if (in_range) [[likely]] {
    return static_cast<std::int64_t>(rounded);
  }
  return overflow(static_cast<uint128>(static_cast<int128>(rounded)), rounded < 0, r);
}

// The cases off the common path: growth, and shifts of 127 bits and more.
template <class Watch>
std::int64_t quantize_far(int128 raw, int fraction, const Register& r, Watch watch);

// raw 2^-fraction into register r. Int: std::int64_t or int128.
template <class Int, class Watch>
inline std::int64_t quantize(Int raw, int fraction, const Register& r, Watch watch) {
  constexpr int bits = sizeof(Int) * 8;
  const int shift = fraction - r.fraction;
  if (shift == 0) {
    return narrow(raw, false, false, r, watch, [] { return std::int64_t{0}; });
  }
  if (shift > 0 && shift < bits) [[likely]] {
    const Int rest = raw & ((Int{1} << (shift - 1)) - 1);
    const bool guard = ((raw >> (shift - 1)) & 1) != 0;
    return narrow(raw >> shift, guard, rest != 0, r, watch, [&] {
      const auto part = (static_cast<uint128>(guard ? 1U : 0U) << (shift - 1)) | static_cast<uint128>(rest);
      return static_cast<std::int64_t>(shift >= bias_fraction ? part >> (shift - bias_fraction)
                                                              : part << (bias_fraction - shift));
    });
  }
  return quantize_far(static_cast<int128>(raw), fraction, r, watch);
}

template <class Watch>
inline std::int64_t quantize(Exact x, const Register& r, Watch watch) {
  return quantize(x.raw, x.fraction, r, watch);
}

// raw 2^-fraction into a format, unobserved.
std::int64_t quantize(int128 raw, int fraction, const Format& format);

}  // namespace bitspan::model
