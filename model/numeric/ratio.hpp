// SPDX-License-Identifier: Apache-2.0
// Quantising a quotient: the floor, a guard and a sticky bit of n / d go through the one narrowing routine.
#pragma once

#include <cstdint>

#include "model/numeric/quantize.hpp"

namespace bitspan::model {

// (n / d) 2^scale into register r, of the exact quotient; d > 0, any n and scale.
template <class Watch>
std::int64_t quantize_ratio(int128 n, int128 d, int scale, const Register& r, Watch watch);

// n / d; d not 0, of either sign.
template <class Watch>
inline std::int64_t quantize_ratio(Exact n, Exact d, const Register& r, Watch watch) {
  const int scale = d.fraction - n.fraction;
  return d.raw < 0 ? quantize_ratio(-n.raw, -d.raw, scale, r, watch)
                   : quantize_ratio(n.raw, d.raw, scale, r, watch);
}

}  // namespace bitspan::model
