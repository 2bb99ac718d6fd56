// SPDX-License-Identifier: Apache-2.0
// Slope(n, d, form, R, name) of docs/numeric-spec.md: the one way an edge's or a row's slope is formed. What
// it needs of the formats; the arithmetic is in slope-inl.hpp.
#pragma once

#include "config/config.hpp"
#include "model/numeric/forms.hpp"
#include "model/numeric/reciprocal.hpp"

namespace bitspan::model {

// The length that slopes are divided by.
struct LengthForm {
  SlopeForm form = SlopeForm::divide;
  ReciprocalUnit unit;
  Grid magnitude;
  bool fits_lanes = false;
};
LengthForm make_length_form(SlopeForm form, const ReciprocalUnit& unit, Grid magnitude);

struct Slope {
  Register r;
  int ratio_scale = 0;       // divide: of n / d
  int product_fraction = 0;  // reciprocal: of n m
  int n_bits = -1;           // reciprocal: |n| < 2^n_bits: n m in 64 bits
  bool down = false;         // reciprocal: the product always has bits below r's, 60 at most
  bool fits_lanes = false;
};
Slope make_slope(const Register& r, Grid n, const LengthForm& length);

}  // namespace bitspan::model
