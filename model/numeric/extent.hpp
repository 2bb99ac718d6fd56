// Widths of exact intermediates: how many bits a sum or product of registers can take at most. Stages ask
// once, when they are prepared, whether everything they form fits int64, and then compute in it.
#pragma once

#include <algorithm>

#include "config/format.hpp"

namespace bitspan::model {

// Values in [-2^(integer-1), 2^(integer-1)) on a grid of 2^-fraction.
struct Extent {
  int integer = 1;
  int fraction = 0;
};

constexpr Extent extent(const Format& f) { return {f.integer + (f.is_signed ? 0 : 1), f.fraction()}; }
// 2^integer bits of magnitude, both signs.
constexpr Extent extent_of_integer(int magnitude_bits) { return {magnitude_bits + 1, 0}; }
constexpr Extent sum(Extent a, Extent b) {
  return {std::max(a.integer, b.integer) + 1, std::max(a.fraction, b.fraction)};
}
constexpr Extent product(Extent a, Extent b) { return {a.integer + b.integer, a.fraction + b.fraction}; }
// x 2^-exponent
constexpr Extent scaled(Extent a, int exponent) { return {a.integer - exponent, a.fraction + exponent}; }
constexpr int width(Extent a) { return a.integer + a.fraction; }
// One bit is kept back.
constexpr bool fits_int64(Extent a) { return width(a) <= 63 && a.fraction <= 62 && a.integer <= 63; }

}  // namespace bitspan::model
