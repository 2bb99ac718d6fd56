// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/slope.hpp"

#include "config/modes.hpp"

namespace bitspan::model {

LengthForm make_length_form(SlopeForm form, const ReciprocalUnit& unit, Grid magnitude) {
  return {form, unit, magnitude, lanes_hold(magnitude)};
}

Slope make_slope(const Register& r, Grid n, const LengthForm& length) {
  Slope s;
  s.r = r;
  s.fits_lanes = length.fits_lanes && lanes_hold(n);
  if (!shares_reciprocal(length.form)) {
    s.ratio_scale = length.magnitude.fraction - n.fraction;
    return s;
  }
  const Grid m = magnitude_of(length.unit.output());
  // A length may be 2^integer itself.
  const Grid reached{length.magnitude.integer + 1, length.magnitude.fraction};
  const Exponents e = exponents_of(length.unit.config(), reached);
  s.product_fraction = n.fraction + m.fraction;
  const int low = s.product_fraction + e.low;
  const int high = s.product_fraction + e.high;
  // One bit below r's grid at least: what quantize() takes growth to.
  const int product_bits = m.bits() + std::max(low, r.fraction + 1) - low;
  const int shift = high - r.fraction;
  if (shift <= term_bits) {
    s.n_bits = std::min(62, term_bits - product_bits);
  }
  s.down = low > r.fraction && shift <= term_bits;
  s.fits_lanes = s.fits_lanes && product_bits + n.bits() <= 126 && shift <= 126;
  return s;
}

}  // namespace bitspan::model
