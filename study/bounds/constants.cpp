// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "study/bounds/error_analysis.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

using F = FormatId;

void ErrorAnalysis::constants() {
  int e = 0;
  if (std::frexp(in_.s_max, &e) == 0.5) --e;
  exponent_ = e;
  const Format& s = format(F::setup_s);
  const double near = std::ldexp(in_.s_min, -e);
  const double far = std::ldexp(in_.s_max, -e);
  if (!saturates(s) && far > values(s).hi) {
    throw InputError("formats.setup.s: too narrow for s_max; no bound is known for what wraps there");
  }
  s_near_ = quantised(near, s);
  const double s_far = quantised(far, s);
  if (!(s_near_ > 0 && s_near_ < s_far)) {
    throw InputError("formats.setup.s: too coarse for s_min and s_max; legal: 0 < s_min' < s_max'");
  }
  hmax_ = std::ldexp(1.0, c_.depth_bits) - 1;
  const Interval b = Interval(hmax_) * s_near_ / (Interval(s_far) - s_near_);
  const Format& b_format = format(F::setup_b);
  if (!saturates(b_format) && (b + rounding(b_format)).hi > values(b_format).hi) {
    throw InputError("formats.setup.b: too narrow for B; no bound is known for what wraps there");
  }
  b_ = quantised(b, b_format);
  if (!(b_.lo > 0)) throw InputError("formats.setup.b: too coarse for the s range; legal: B > 0");
  const Interval ideal_b = Interval(hmax_) * in_.s_min / (Interval(in_.s_max) - in_.s_min);
  scale_ = b_ / ideal_b * (Interval(s_far) / far);
  const Interval nearness = Interval(in_.s_max) / in_.s;  // q = ideal_b nearness
  ideal_q_ = ideal_b * nearness;
  q_ = scale_ * ideal_q_;
  h_ = Interval(b_ * (Interval(s_far) / far) * nearness) - b_;
  ideal_b_ = ideal_b;
  far_scale_ = Interval(s_far) / far;
  drift_ = drift_over(0);
  ErrorSum error;
  error.add("setup.b", b_ - ideal_b);
  deliver(setup_b, error, ideal_b.hi);
  gradients();
}

Interval ErrorAnalysis::drift_over(double beyond) const {
  const auto at = [this](Interval nearness) {
    return (b_ - ideal_b_) * (nearness - 1) + b_ * nearness * (far_scale_ - 1);
  };
  const Interval out = Interval(beyond) / (b_ * far_scale_);
  return hull(at(Interval(in_.s_max) / in_.s.hi - out), at(Interval(in_.s_max) / in_.s.lo + out));
}

void ErrorAnalysis::gradients() {
  const Interval inverse = Interval(1) / in_.s;
  // The gradient is the sum of three values times heights, divided by the doubled area. The positive heights
  // sum up to at most the triangle's, and the area is a multiple of 2^-2k.
  const Interval tallest = Interval(in_.y.hi) - in_.y.lo;
  const Interval per_area = std::ldexp(1.0, 2 * c_.subpixel_bits);
  const Interval steepest = (inverse.hi - Interval(inverse.lo)) * tallest * per_area;
  const double gradient = std::min(in_.inverse_s_gradient, steepest.hi);
  h_gradient_ = (hull(scale_, 1) * ideal_b_ * in_.s_max * gradient).hi;
  const auto coordinate = [&](Interval range, double known) {
    const Interval worst = Interval(2) * tallest * per_area * (Interval(range.hi) - range.lo) *
                           square(Interval(inverse.hi)) / square(Interval(inverse.lo));
    return Coordinate{range, std::min(known, worst.hi)};
  };
  uv_ = {coordinate(in_.u, in_.u_gradient), coordinate(in_.v, in_.v_gradient)};
  out_.worst.h_gradient = h_gradient_;
  out_.worst.uv_gradient = {uv_[0].gradient, uv_[1].gradient};
  out_.worst.q_least = q_.lo;
}

}  // namespace bitspan::bounds
