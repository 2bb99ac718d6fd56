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

DepthRange ErrorAnalysis::depth_range(double s_min, double s_max) const {
  DepthRange out;
  if (std::frexp(s_max, &out.exponent) == 0.5) --out.exponent;
  const Format& s = format(F::setup_s);
  const double near = std::ldexp(s_min, -out.exponent);
  const double far = std::ldexp(s_max, -out.exponent);
  if (!saturates(s) && far > values(s).hi) {
    throw InputError("formats.setup.s: too narrow for s_max; no bound is known for what wraps there");
  }
  out.s_near = quantised(near, s);
  const double s_far = quantised(far, s);
  if (!(out.s_near > 0 && out.s_near < s_far)) {
    throw InputError("formats.setup.s: too coarse for s_min and s_max; legal: 0 < s_min' < s_max'");
  }
  out.far = s_far;
  const Interval b = Interval(hmax_) * out.s_near / (Interval(s_far) - out.s_near);
  const Format& b_format = format(F::setup_b);
  if (!saturates(b_format) && (b + rounding(b_format)).hi > values(b_format).hi) {
    throw InputError("formats.setup.b: too narrow for B; no bound is known for what wraps there");
  }
  out.b = quantised(b, b_format);
  if (!(out.b.lo > 0)) throw InputError("formats.setup.b: too coarse for the s range; legal: B > 0");
  out.ideal_b = Interval(hmax_) * s_min / (Interval(s_max) - s_min);
  out.far_scale = Interval(s_far) / far;
  return out;
}

void ErrorAnalysis::constants() {
  hmax_ = std::ldexp(1.0, c_.depth_bits) - 1;
  view_ = depth_range(in_.s_min, in_.s_max);
  scale_ = view_.b / view_.ideal_b * view_.far_scale;
  const Interval nearness = Interval(in_.s_max) / in_.s;  // q = ideal_b nearness
  ideal_q_ = view_.ideal_b * nearness;
  q_ = scale_ * ideal_q_;
  h_ = Interval(view_.b * view_.far_scale * nearness) - view_.b;
  drift_ = drift_over(0);
  ErrorSum error;
  error.add("setup.b", view_.b - view_.ideal_b);
  deliver(setup_b, error, view_.ideal_b.hi);
  gradients();
}

Interval ErrorAnalysis::drift_over(double beyond) const {
  const auto at = [this](Interval nearness) {
    return (view_.b - view_.ideal_b) * (nearness - 1) + view_.b * nearness * (view_.far_scale - 1);
  };
  const Interval out = Interval(beyond) / (view_.b * view_.far_scale);
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
  h_gradient_ = (hull(scale_, 1) * view_.ideal_b * in_.s_max * gradient).hi;
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
