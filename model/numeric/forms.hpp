// The shapes of expression that setup, edge_walk and span_setup quantise, prepared for their formats: the
// common grid, and how large an operand may be for all of it to fit 64 bits. Larger ones are computed in 128
// (forms-inl.hpp), whose room a legal configuration never exceeds.
#pragma once

#include <algorithm>

#include "config/config.hpp"
#include "model/numeric/reciprocal.hpp"

namespace bitspan::model {

// |raw| <= 2^bits, on a grid of 2^-fraction.
struct Size {
  int bits = 0, fraction = 0;
};
constexpr Size size_of(const Register& r) { return {r.is_signed ? r.word - 1 : r.word, r.fraction}; }
constexpr Size size_of(Exact x) {
  return {bit_length(static_cast<uint128>(x.raw < 0 ? -x.raw : x.raw)), x.fraction};
}
constexpr int bits_on(Size a, int fraction) { return a.bits + fraction - a.fraction; }
constexpr Size operator+(Size a, Size b) {
  const int fraction = std::max(a.fraction, b.fraction);
  return {std::max(bits_on(a, fraction), bits_on(b, fraction)) + 1, fraction};
}
constexpr Size operator*(Size a, Size b) { return {a.bits + b.bits, a.fraction + b.fraction}; }

// Terms of up to 2^term_bits: three of them and what rounding adds stay within 63 bits.
inline constexpr int term_bits = 60;
// Sums of two registers that lanes hold in 64 bits.
constexpr bool lanes_hold(Size a) { return a.bits <= 61; }

// The smallest and the largest e a unit delivers for an operand, 1 <= raw <= 2^bits.
struct Exponents {
  int low = 0, high = 0;
};
constexpr Exponents exponents(const Reciprocal& unit, Size operand) {
  return unit.normalize ? Exponents{-operand.fraction, operand.bits - operand.fraction} : Exponents{};
}

// h + B: (h << up) + b, on 2^-fraction.
struct DepthSum {
  int up = 0, fraction = 0;
  int128 b = 0;
  Size size;
  Exponents e;  // of R_pixel(h + B)
};
DepthSum make_depth_sum(const Register& h, Exact b, const Reciprocal& unit);

// Q[r](base + step t + offset)
struct Line {
  Register r;
  int base_up = 0, product_up = 0, fraction = 0;
  int128 offset = 0;
  int t_bits = -1;  // |t| < 2^t_bits: in 64 bits
  bool fits_lanes = false;
};
// base: a register, or null for none.
Line make_line(const Register& r, const Register* base, const Register& step, Size t, Exact offset);

// Q[r](a b)
struct Product {
  Register r;
  int fraction = 0;
  int a_bits = -1;  // |a| < 2^a_bits: in 64 bits
  bool fits_lanes = false;
};
Product make_product(const Register& r, Size a, Size b);

// Q[r](x)
struct Narrowing {
  Register r;
  int fraction = 0;
  bool fits = false;  // 64 bits, on r's grid too
  bool fits_lanes = false;
};
Narrowing make_narrowing(const Register& r, Size from);

// Q[r](base + f m 2^-e), (m, e) = R_pixel(h + B)
struct PerspectivePoint {
  Register r;
  int base_fraction = 0, product_fraction = 0;
  int f_bits = -1;       // |f| < 2^f_bits: in 64 bits
  bool aligned = false;  // f m 2^-e always has more fraction bits than base and r, by 60 at most
  bool fits_lanes = false;
};
PerspectivePoint make_perspective_point(const Register& r, const Register& base, const Register& f,
                                        const Register& m, Exponents e);

}  // namespace bitspan::model
