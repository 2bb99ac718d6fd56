// SPDX-License-Identifier: Apache-2.0
// The factors and operations of merge, for the quantised golden and for ideal; docs/numeric-spec.md, "merge".
#pragma once

#include "config/modes.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::golden {

// What the factors stand for, of one channel: all in 0..1.
template <class Real>
struct BlendShares {
  Real a, src_color, dst_color, dst_alpha, constant_color, constant_alpha;

  Real of(BlendFactor factor, bool is_alpha) const {
    switch (factor) {
      case BlendFactor::zero:
        return 0;
      case BlendFactor::one:
        return 1;
      case BlendFactor::src_color:
        return src_color;
      case BlendFactor::one_minus_src_color:
        return 1 - src_color;
      case BlendFactor::dst_color:
        return dst_color;
      case BlendFactor::one_minus_dst_color:
        return 1 - dst_color;
      case BlendFactor::src_alpha:
        return a;
      case BlendFactor::one_minus_src_alpha:
        return 1 - a;
      case BlendFactor::dst_alpha:
        return dst_alpha;
      case BlendFactor::one_minus_dst_alpha:
        return 1 - dst_alpha;
      case BlendFactor::constant_color:
        return constant_color;
      case BlendFactor::one_minus_constant_color:
        return 1 - constant_color;
      case BlendFactor::constant_alpha:
        return constant_alpha;
      case BlendFactor::one_minus_constant_alpha:
        return 1 - constant_alpha;
      case BlendFactor::src_alpha_saturate:
        if (is_alpha) return 1;
        return a < 1 - dst_alpha ? a : 1 - dst_alpha;
      case BlendFactor::half:
        return Real(0.5);
    }
    unreachable();
  }
};

template <class Real>
Real combine(BlendOp op, Real src, Real dst, Real by_src, Real by_dst) {
  switch (op) {
    case BlendOp::add:
      return src * by_src + dst * by_dst;
    case BlendOp::subtract:
      return src * by_src - dst * by_dst;
    case BlendOp::reverse_subtract:
      return dst * by_dst - src * by_src;
    case BlendOp::min:
      return src < dst ? src : dst;
    case BlendOp::max:
      return src > dst ? src : dst;
  }
  unreachable();
}

}  // namespace bitspan::golden
