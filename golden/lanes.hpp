// SPDX-License-Identifier: Apache-2.0
// Q over columns of values, in double: the quick form of what Quantizer<double> does to one value at a time.
//
// Each function is one loop without a branch, so that the compiler makes vectors of it. It computes what
// Quantizer would, by the same error-free sums and products. It counts the lanes where that does not hold: a
// lost bit, a value beyond the quick floor, an overflow that is not a saturation. Where it counts any, the
// caller takes the batch through Quantizer. So a column is exact or not used, and nothing here decides what a
// configuration may be.
#pragma once

#include <cstddef>
#include <cstdint>

#include "config/format.hpp"

namespace bitspan::golden {

inline constexpr std::size_t lanes = 256;  // values per column

struct alignas(64) Column {
  double at[lanes];
};

// What rounding and overflow do to whole + fraction.
struct LaneFormat {
  bool usable = false;            // SC_RND_CONV and SC_TRN_ZERO have no quick form
  double above = 0;               // added where the fraction is above 1/2
  double tie_below = 0, tie = 0;  // where it is 1/2: whole < 0, whole >= 0
  double min = 0, max = 0;
  std::int64_t strict = 0;  // 1: what lies outside min..max is counted, 0: it saturates
  LaneFormat() = default;
  explicit LaneFormat(const Format& format);
};

// The functions below write out[0..n), n <= lanes, and return the number of lanes that do not hold. The
// results are integers, in ulps. Scales are powers of two that bring the operand to ulps.

// Q(x scale)
std::int64_t lanes_narrow(const Column& x, double scale, const LaneFormat& q, std::size_t n, Column& out);
// Q(constant - x scale), the constant in ulps
std::int64_t lanes_narrow_less(double constant, const Column& x, double scale, const LaneFormat& q,
                               std::size_t n, Column& out);
// Q(a b scales[i] scale + c[i] c_scale)
std::int64_t lanes_narrow_product(const Column& a, const Column& b, const Column& scales, double scale,
                                  const Column& c, double c_scale, const LaneFormat& q, std::size_t n,
                                  Column& out);
// Q(a b scale), where one double holds a b
std::int64_t lanes_narrow_short(const Column& a, const Column& b, double scale, const LaneFormat& q,
                                std::size_t n, Column& out);
// Q((from (1 - share) + to share) scale), where one double holds each product
std::int64_t lanes_narrow_mix(const Column& from, const Column& to, const Column& share, double scale,
                              const LaneFormat& q, std::size_t n, Column& out);
// Q((base + (x - base) share) scale), where one double holds the product; Q(x scale) where share >= whole
std::int64_t lanes_narrow_toward(const Column& base, const Column& x, const Column& share, double share_ulp,
                                 double whole, double scale, const LaneFormat& q, std::size_t n, Column& out);
// Q(a scale / d), d > 0
std::int64_t lanes_narrow_quotient(const Column& a, const Column& d, double scale, const LaneFormat& q,
                                   std::size_t n, Column& out);

// x = x slope + constant, exactly; what is not above 0 becomes least.
void lanes_operand(const Column& x, double slope, double constant, double least, std::size_t n, Column& out);
// Splits normal d > 0 as d = m 2^e, 1 <= m < 2, into m, 2^-e and e.
void lanes_split(const Column& d, std::size_t n, Column& m, Column& inverse_power, std::int64_t* e);
// floor(x scale) ulp
void lanes_cut(const Column& x, double scale, double ulp, std::size_t n, Column& out);
// (x - 1) scale, a table's position
void lanes_position(const Column& x, double scale, std::size_t n, Column& out);
// One step of Newton: y = cut(y (2 - cut(nq y))).
void lanes_newton(const Column& nq, double scale, double ulp, std::size_t n, Column& y);

}  // namespace bitspan::golden
