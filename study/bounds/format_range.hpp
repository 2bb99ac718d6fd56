// SPDX-License-Identifier: Apache-2.0
// Computes what a format does to a number, as intervals and exactly, for proofs. It is apart from the
// arithmetic of model and golden.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "config/format.hpp"
#include "study/bounds/interval.hpp"

namespace bitspan::bounds {

inline double ulp(const Format& f) { return std::ldexp(1.0, -f.fraction()); }
inline bool saturates(const Format& f) {
  return f.overflow == Overflow::sat || f.overflow == Overflow::sat_sym;
}

// Returns the range of the values that a format has.
inline Interval values(const Format& f) {
  const double unit = ulp(f);
  const Interval whole = std::ldexp(1.0, f.is_signed ? f.word - 1 : f.word);
  const Interval most = whole - 1;
  const Interval least = !f.is_signed ? Interval(0) : f.overflow == Overflow::sat_sym ? -most : -whole;
  return {least.lo * unit, most.hi * unit};  // times a power of two: exact
}

// Returns what rounding to the format adds to a value on the grid of 2^-grid. Without a grid the value is any
// real number.
inline Interval rounding(const Format& f, std::optional<int> grid = std::nullopt) {
  if (grid && *grid <= f.fraction()) return 0;
  if (grid && *grid > f.fraction() + 5) grid.reset();  // it takes off under 2 % of an ulp
  const double unit = ulp(f);
  const Interval rest = grid ? Interval(unit) - std::ldexp(1.0, -*grid) : Interval(unit);
  if (f.rounding == Rounding::trn) return {-rest.hi, 0};
  if (f.rounding == Rounding::trn_zero) return {-rest.hi, rest.hi};
  return Interval::plus_minus(unit / 2);
}

// Returns x in the format, exactly. Scaling by a power of two, floor and the rest are exact in a double.
// Values beyond the range stop at its ends.
inline double quantised(double x, const Format& f) {
  const double scaled = std::ldexp(x, f.fraction());
  const double down = std::floor(scaled);
  const double rest = scaled - down;
  bool up = rest > 0.5;
  switch (f.rounding) {
    case Rounding::trn:
      up = false;
      break;
    case Rounding::trn_zero:
      up = scaled < 0 && rest > 0;
      break;
    case Rounding::rnd:
      up = up || rest == 0.5;
      break;
    case Rounding::rnd_zero:
      up = up || (rest == 0.5 && scaled < 0);
      break;
    case Rounding::rnd_inf:
      up = up || (rest == 0.5 && scaled > 0);
      break;
    case Rounding::rnd_conv:
      up = up || (rest == 0.5 && std::fmod(down, 2.0) != 0);
      break;
    case Rounding::rnd_min_inf:
      break;
  }
  const Interval range = values(f);
  return std::clamp(std::ldexp(down + (up ? 1 : 0), -f.fraction()), range.lo, range.hi);
}
// Rounding is monotone, so the ends bound what is between.
inline Interval quantised(Interval x, const Format& f) { return {quantised(x.lo, f), quantised(x.hi, f)}; }

}  // namespace bitspan::bounds
