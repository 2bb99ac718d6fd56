#include "model/numeric/slope.hpp"

#include "config/modes.hpp"

namespace bitspan::model {

LengthForm make_length_form(SlopeForm form, const ReciprocalUnit& unit, Size size) {
  return {form, unit, size, lanes_hold(size)};
}

Slope make_slope(const Register& r, Size n, const LengthForm& length) {
  Slope s;
  s.r = r;
  s.lanes = length.lanes && lanes_hold(n);
  if (!shares_reciprocal(length.form)) {
    s.ratio_scale = length.size.fraction - n.fraction;
    return s;
  }
  const Size m = size_of(length.unit.output());
  const Exponents e = exponents(length.unit.config(), length.size);
  s.product_fraction = n.fraction + m.fraction;
  const int low = s.product_fraction + e.low;
  const int high = s.product_fraction + e.high;
  // One bit below r's grid at least: what quantize() takes growth to.
  const int product_bits = m.bits + std::max(low, r.fraction + 1) - low;
  const int shift = high - r.fraction;
  if (shift <= term_bits) {
    s.n_bits = std::min(62, term_bits - product_bits);
  }
  s.down = low > r.fraction && shift <= term_bits;
  s.lanes = s.lanes && product_bits + n.bits <= 126 && shift <= 126;
  return s;
}

}  // namespace bitspan::model
