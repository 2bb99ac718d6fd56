// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

// rest / d in 2^-32 ulp, rounded down; 0 <= rest < d.
std::int64_t part_of(int128 rest, int128 d) {
  std::int64_t part = 0;
  for (int i = 0; i < bias_fraction; ++i) {
    const bool one = rest >= d - rest;
    rest = one ? rest - (d - rest) : rest + rest;
    part = part << 1 | (one ? 1 : 0);
  }
  return part;
}

// Floor and rest of n 2^shift / d, bit by bit, where n 2^shift has no room in 128 bits; shift > 0. The floor
// is right modulo 2^128, and fits says whether it is right altogether.
struct LongQuotient {
  uint128 floor;
  int128 rest;
  bool fits;
};
LongQuotient long_divide(int128 n, int128 d, int shift) {
  const auto first = floor_divide(n, d);
  auto floor = static_cast<uint128>(first.floor);
  int128 rest = first.rest;
  bool fits = true;
  for (int i = 0; i < shift; ++i) {
    const bool one = rest >= d - rest;
    rest = one ? rest - (d - rest) : rest + rest;
    const bool same_sign = (floor >> 127) == ((floor >> 126) & 1);
    fits = fits && same_sign;
    floor = floor << 1 | (one ? 1U : 0U);
  }
  return {floor, rest, fits};
}

template <class Int, class Watch>
std::int64_t narrow_rest(Int floor, Int rest, Int d, const Register& r, Watch watch) {
  const Int up = d - rest;  // rest against up: the dropped part against a half, without doubling
  const bool guard = rest >= up;
  const bool sticky = guard ? rest != up : rest != 0;
  return narrow(floor, guard, sticky, r, watch, [&] { return part_of(rest, d); });
}

}  // namespace

template <class Watch>
std::int64_t quantize_ratio(int128 n, int128 d, int scale, const Register& r, Watch watch) {
  const int shift = r.fraction + scale;
  const auto magnitude = static_cast<uint128>(n < 0 ? -n : n);
  if (shift >= 0) {
    const int bits = bit_length(magnitude) + shift;
    if (bits <= 63 && d <= INT64_MAX) {
      const auto wide = static_cast<std::int64_t>(n) << shift;
      const auto narrow_d = static_cast<std::int64_t>(d);
      std::int64_t floor = wide / narrow_d;
      std::int64_t rest = wide % narrow_d;
      if (rest < 0) {
        rest += narrow_d;
        --floor;
      }
      return narrow_rest(floor, rest, narrow_d, r, watch);
    }
    if (bits <= 127) {
      const auto q = floor_divide(n << shift, d);
      return narrow_rest(q.floor, q.rest, d, r, watch);
    }
    const auto q = long_divide(n, d, shift);
    if (q.fits) {
      return narrow_rest(static_cast<int128>(q.floor), q.rest, d, r, watch);
    }
    // Out of any register's range: round on the low bits, keep the sign.
    const int128 up = d - q.rest;
    const bool guard = q.rest >= up;
    const bool sticky = guard ? q.rest != up : q.rest != 0;
    const unsigned row = (n < 0 ? 8U : 0U) | (static_cast<unsigned>(q.floor) & 1U) << 2 | (guard ? 2U : 0U) |
                         (sticky ? 1U : 0U);
    if constexpr (Watch::enabled) {
      constexpr int128 far_up = int128{1} << 100;
      watch.note(r, n < 0 ? -far_up : far_up, false, 0);
    }
    return overflow(q.floor + ((static_cast<unsigned>(r.rounding) >> row) & 1U), n < 0, r);
  }
  // Fewer bits are kept than n / d has: floor(n / d), with the rest as a further sticky bit.
  const auto q = floor_divide(n, d);
  const int drop = -shift;
  const bool more = q.rest != 0;
  if (drop > 127) {
    return quantize((q.floor << 1) | (more ? 1 : 0), r.fraction + drop + 1, r, watch);
  }
  const bool guard = ((q.floor >> (drop - 1)) & 1) != 0;
  const int128 below = q.floor & ((int128{1} << (drop - 1)) - 1);
  return narrow(q.floor >> drop, guard, below != 0 || more, r, watch, [&] {
    const auto part = (static_cast<uint128>(guard ? 1U : 0U) << (drop - 1)) | static_cast<uint128>(below);
    return drop >= bias_fraction
               ? static_cast<std::int64_t>(part >> (drop - bias_fraction))
               : static_cast<std::int64_t>(part << (bias_fraction - drop)) + (part_of(q.rest, d) >> drop);
  });
}

template std::int64_t quantize_ratio(int128, int128, int, const Register&, NoObserve);
template std::int64_t quantize_ratio(int128, int128, int, const Register&, Observe);

}  // namespace bitspan::model
