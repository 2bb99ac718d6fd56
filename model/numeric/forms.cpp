// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/forms.hpp"

namespace bitspan::model {
namespace {

constexpr int lane_shift = 126;  // what WideLanes shift by at most
constexpr int wide_bits = 126;

}  // namespace

DepthSum make_depth_sum(const Register& h, Exact b, const Reciprocal& unit) {
  DepthSum s;
  s.fraction = std::max(h.fraction, b.fraction);
  s.up = s.fraction - h.fraction;
  s.b = on_grid(b, s.fraction);
  s.magnitude = magnitude_of(h) + magnitude_of(b);
  if (unit.normalize) {
    // From its least ulp, or from B where h is never negative, to the highest bit of both together.
    const auto least = h.is_signed ? uint128{1} : std::max<uint128>(1, static_cast<uint128>(s.b));
    const auto most = (static_cast<uint128>(h.max) << s.up) + static_cast<uint128>(s.b);
    s.e = {bit_length(least) - 1 - s.fraction, bit_length(most) - 1 - s.fraction};
  }
  return s;
}

Line make_line(const Register& r, const Register* base, const Register& step, Grid t, Exact offset) {
  Line line;
  line.r = r;
  const Grid product = magnitude_of(step) * Grid{-t.fraction, t.fraction};  // of one ulp of t
  const bool has_offset = offset.raw != 0;
  line.fraction = std::max({product.fraction, base == nullptr ? product.fraction : base->fraction,
                            has_offset ? offset.fraction : product.fraction});
  line.base_up = base == nullptr ? 0 : line.fraction - base->fraction;
  line.product_up = line.fraction - product.fraction;
  line.offset = has_offset ? on_grid(offset, line.fraction) : 0;
  // Also on r's grid, where that one is finer.
  const int grid = std::max(line.fraction, r.fraction);
  const int base_bits = base == nullptr ? 0 : aligned(magnitude_of(*base), grid).bits();
  const int offset_bits = has_offset ? aligned(magnitude_of(offset), grid).bits() : 0;
  const int product_bits = aligned(product, grid).bits();
  const int shift = line.fraction - r.fraction;
  if (base_bits <= term_bits && offset_bits <= term_bits && shift <= term_bits &&
      grid - line.fraction <= term_bits) {
    line.t_bits = std::min(62, term_bits - product_bits);
  }
  line.fits_lanes = std::max({base_bits, offset_bits, product_bits + t.bits()}) + 2 <= wide_bits &&
                    shift <= lane_shift && lanes_hold(t);
  return line;
}

Product make_product(const Register& r, Grid a, Grid b) {
  Product p;
  p.r = r;
  p.fraction = a.fraction + b.fraction;
  const int grid = std::max(p.fraction, r.fraction);
  const int shift = p.fraction - r.fraction;
  if (shift <= term_bits) {
    p.a_bits = std::min(62, term_bits - b.bits() - (grid - p.fraction));
  }
  p.fits_lanes =
      lanes_hold(a) && lanes_hold(b) && aligned(a * b, grid).bits() <= wide_bits && shift <= lane_shift;
  return p;
}

Narrowing make_narrowing(const Register& r, Grid from) {
  Narrowing n;
  n.r = r;
  n.fraction = from.fraction;
  const int shift = n.fraction - r.fraction;
  const int bits = aligned(from, r.fraction).bits();
  n.fits = bits <= term_bits && shift <= term_bits;
  n.fits_lanes = bits <= wide_bits && shift <= lane_shift;
  return n;
}

PerspectivePoint make_perspective_point(const Register& r, const Register& base, const Register& f,
                                        const Register& m, Exponents e) {
  PerspectivePoint p;
  p.r = r;
  p.base_fraction = base.fraction;
  p.product_fraction = f.fraction + m.fraction;
  // One bit below r's grid at least: what quantize() takes growth to.
  const auto grid_at = [&](int exponent) {
    return std::max({p.product_fraction + exponent, p.base_fraction, r.fraction + 1});
  };
  const int low = p.product_fraction + e.low;
  const int high = p.product_fraction + e.high;
  const int base_bits = aligned(magnitude_of(base), grid_at(e.high)).bits();
  const int shift = std::max(high, p.base_fraction) - r.fraction;
  const int product_bits = magnitude_of(m).bits() + grid_at(e.low) - low;
  if (base_bits <= term_bits && shift <= term_bits) {
    p.f_bits = std::min(62, term_bits - product_bits);
  }
  p.aligned = low >= base.fraction && low > r.fraction && shift <= term_bits;
  p.fits_lanes = base_bits + 2 <= wide_bits && product_bits + magnitude_of(f).bits() + 2 <= wide_bits &&
                 shift <= lane_shift;
  return p;
}

}  // namespace bitspan::model
