// SPDX-License-Identifier: Apache-2.0
// The widths of exact numbers: on which grid and in which range a register, a sum or a product lies.
//
// One algebra for everything that asks how many bits an expression takes: the table of exact widths, the
// costs, the area estimate, the RTL's operands, and the model's choice between integers of 32, 64 and 128
// bits.
#pragma once

#include <algorithm>

#include "config/config.hpp"

namespace bitspan {

// The multiples x of 2^-fraction with -2^integer <= x < 2^integer where signed, 0 <= x < 2^integer where not.
// Both counts of places may be negative. Each operation below holds every result that its operands allow.
struct Grid {
  int integer = 0;   // places left of the point, the sign not among them
  int fraction = 0;  // places right of the point
  bool is_signed = false;

  constexpr int bits() const { return integer + fraction + (is_signed ? 1 : 0); }
  constexpr bool operator==(const Grid&) const = default;
};

constexpr Grid grid_of(const Format& f) {
  return {f.is_signed ? f.integer - 1 : f.integer, f.fraction(), f.is_signed};
}
// The same values in a signed word.
constexpr Grid as_signed(Grid a) { return {a.integer, a.fraction, true}; }
constexpr Grid signed_grid(const Format& f) { return as_signed(grid_of(f)); }
// The values that are not negative.
constexpr Grid positive(Grid a) { return {a.integer, a.fraction, false}; }
// The same values with at least this many places right of the point.
constexpr Grid aligned(Grid a, int fraction) {
  return {a.integer, std::max(a.fraction, fraction), a.is_signed};
}
// x 2^-exponent.
constexpr Grid scaled(Grid a, int exponent) {
  return {a.integer - exponent, a.fraction + exponent, a.is_signed};
}

constexpr Grid operator+(Grid a, Grid b) {
  return {std::max(a.integer, b.integer) + 1, std::max(a.fraction, b.fraction), a.is_signed || b.is_signed};
}
// Two numbers that are never negative differ by no more than the larger.
constexpr Grid operator-(Grid a, Grid b) {
  const int growth = a.is_signed || b.is_signed ? 1 : 0;
  return {std::max(a.integer, b.integer) + growth, std::max(a.fraction, b.fraction), true};
}
// As many bits as both operands have together. Two least values make 2^(a.integer + b.integer), for which the
// product of two signed numbers has a place more.
constexpr Grid operator*(Grid a, Grid b) {
  const int growth = a.is_signed && b.is_signed ? 1 : 0;
  return {a.integer + b.integer + growth, a.fraction + b.fraction, a.is_signed || b.is_signed};
}

// The exponents e that a reciprocal unit delivers beside its mantissa, 2^e <= d < 2^(e+1), for the operands
// d > 0 of a grid; 0 where the unit does not normalise.
struct Exponents {
  int low = 0, high = 0;
};
constexpr Exponents exponents_on(Grid operand) { return {-operand.fraction, operand.integer - 1}; }
constexpr Exponents exponents_of(const Reciprocal& unit, Grid operand) {
  return unit.normalize ? exponents_on(operand) : Exponents{};
}

}  // namespace bitspan
