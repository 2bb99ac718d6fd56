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

ErrorSum ErrorAnalysis::with_drift(ErrorSum e) const {
  e.add("setup.b", drift_);
  return e;
}

void ErrorAnalysis::setup() {
  const Format& s = format(F::setup_s);
  const Interval near = std::ldexp(in_.s.lo, -view_.exponent);
  const Interval step = rounding(s);
  // s / s' is furthest from 1 at the nearest vertex. s' >= s_min' > 0, because rounding is monotone.
  const Interval least = near + step.lo;
  const Interval most_ratio =
      least.lo >= view_.s_near ? near / least : (Interval(view_.s_near) - step.lo) / view_.s_near;
  Interval ratio(std::min(1.0, (near / (near + step.hi)).lo), std::max(1.0, most_ratio.hi));
  const Interval farthest = std::ldexp(in_.s.hi, -view_.exponent);
  if (farthest.hi > values(s).hi) {  // saturation takes off at most this
    ratio.hi = std::max(ratio.hi, (farthest / values(s).hi).hi);
  }
  s_error_ = ratio - 1;
  vertex_h_ = {};
  vertex_h_.add("setup.s", q_ * s_error_);
  vertex_h_.add("setup.h", rounding(format(F::setup_h)));
  settle(vertex_h_, format(F::setup_h), h_);
  deliver(setup_h, with_drift(vertex_h_), hmax_);
  for (std::size_t i = 0; i < 2; ++i) {
    ErrorSum e;
    e.add("setup.uv", rounding(format(F::setup_uv)));
    settle(e, format(F::setup_uv), uv_[i].range);
    vertex_uv_[i] = e;
    deliver(i == 0 ? setup_u : setup_v, e, uv_[i].range.mag());
  }
}

}  // namespace bitspan::bounds
