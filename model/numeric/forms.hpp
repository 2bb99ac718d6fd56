// SPDX-License-Identifier: Apache-2.0
// The shapes of expression that setup, edge_walk and span_setup quantise, prepared for their formats: the
// common grid, and how large an operand may be for all of it to fit 64 bits. Larger ones are computed in 128
// (forms-inl.hpp), whose room a legal configuration never exceeds.
#pragma once

#include "config/config.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/reciprocal.hpp"

namespace bitspan::model {

// h + B: (h << up) + b, on 2^-fraction.
struct DepthSum {
  int up = 0, fraction = 0;
  int128 b = 0;
  Grid magnitude;
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
// base: a register, or null for none. t, and the operands below: bounds of magnitudes.
Line make_line(const Register& r, const Register* base, const Register& step, Grid t, Exact offset);

// Q[r](a b)
struct Product {
  Register r;
  int fraction = 0;
  int a_bits = -1;  // |a| < 2^a_bits: in 64 bits
  bool fits_lanes = false;
};
Product make_product(const Register& r, Grid a, Grid b);

// Q[r](x)
struct Narrowing {
  Register r;
  int fraction = 0;
  bool fits = false;  // 64 bits, on r's grid too
  bool fits_lanes = false;
};
Narrowing make_narrowing(const Register& r, Grid from);

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
