// SPDX-License-Identifier: Apache-2.0
// setup's arithmetic, one text for a triangle and for lanes of them. Value: what registers hold, std::int64_t
// or Lanes; Real: double or Doubles.
#include "model/numeric/ratio-inl.hpp"
#include "model/numeric/slope-inl.hpp"
#include "model/stages/setup.hpp"

#if defined(BITSPAN_MODEL_STAGES_SETUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_SETUP_INL
#undef BITSPAN_MODEL_STAGES_SETUP_INL
#else
#define BITSPAN_MODEL_STAGES_SETUP_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

template <class Real>
struct RealVertex {
  Real x, y, s, u, v;
  std::array<Real, 4> c;
};

template <class Value, class Real, class Watch>
HWY_INLINE VertexOf<Value> setup_vertex(const SetupStage& stage, const RealVertex<Real>& in, Watch watch) {
  using Widths = WidthsOf<Value>;
  const auto real = [&](Real x, int exponent, const Register& r) HWY_ATTR __attribute__((always_inline)) {
    return quantize_real(x, exponent, r, watch);
  };
  const Value x = real(in.x, 0, stage.coordinate);
  const Value y = real(in.y, 0, stage.coordinate);
  const Value s = real(in.s, stage.exponent, stage.s);
  const auto above = difference(Value(static_cast<std::int64_t>(stage.s_max.raw)), s);
  const SumOf<Value> b(stage.b);
  const Value h =
      stage.h_fits_int64
          ? quantize_ratio(product_in<typename Widths::Int64>(b, above), s, stage.h_scale, stage.h, watch)
          : quantize_ratio(product_in<typename Widths::Int128>(b, above), s, stage.h_scale, stage.h, watch);
  return {x,
          y,
          h,
          real(in.u, 0, stage.uv),
          real(in.v, 0, stage.uv),
          {real(in.c[0], 0, stage.shade), real(in.c[1], 0, stage.shade), real(in.c[2], 0, stage.shade),
           real(in.c[3], 0, stage.shade)}};
}

// Swaps where b stands before a in the order (y, x): neighbours only, so equal ones keep theirs.
template <class Value>
HWY_INLINE void order(VertexOf<Value>& a, VertexOf<Value>& b) {
  const auto swap = (b.y < a.y) | ((b.y == a.y) & (b.x < a.x));
  const auto exchange = [swap](Value& p, Value& q) HWY_ATTR {
    const Value lower = select(swap, q, p);
    q = select(swap, p, q);
    p = lower;
  };
  exchange(a.x, b.x);
  exchange(a.y, b.y);
  exchange(a.h, b.h);
  exchange(a.u, b.u);
  exchange(a.v, b.v);
  for (std::size_t c = 0; c < a.c.size(); ++c) {
    exchange(a.c[c], b.c[c]);
  }
}
template <class Value>
HWY_INLINE void sort_vertices(std::array<VertexOf<Value>, 3>& v) {
  order(v[0], v[1]);
  order(v[1], v[2]);
  order(v[0], v[1]);
}

// The area's sign.
template <class Value>
struct Turn {
  decltype(Value() < Value()) positive, none;
};
template <class Int, class Value>
HWY_INLINE Turn<Value> turn_in(const std::array<VertexOf<Value>, 3>& v) {
  const auto term = [](Value a, Value b, Value c, Value d)
                        HWY_ATTR { return product_in<Int>(difference(a, b), difference(c, d)); };
  const Int right = term(v[1].x, v[0].x, v[2].y, v[0].y);
  const Int left = term(v[2].x, v[0].x, v[1].y, v[0].y);
  if constexpr (std::is_same_v<Int, WideLanes>) {
    const WideLanes area = right - left;
    const auto none = (area.hi | area.lo) == Lanes(0);
    return {(area.hi >= Lanes(0)) & !none, none};
  } else {
    return {right > left, right == left};
  }
}
template <class Value>
HWY_INLINE Turn<Value> turn(const SetupStage& stage, const std::array<VertexOf<Value>, 3>& v) {
  using Widths = WidthsOf<Value>;
  return stage.area_fits_int64 ? turn_in<typename Widths::Int64>(v) : turn_in<typename Widths::Int128>(v);
}

template <class Value>
struct EdgeOf {
  Value recip_m, recip_e, x_step, h_step, fu_diff, fv_diff, fu_step, fv_step;
  std::array<Value, 4> shade_step;
};

// The edge from a to b; b.y > a.y.
template <class Value, class Watch>
HWY_INLINE EdgeOf<Value> setup_edge(const SetupStage& stage, const VertexOf<Value>& a,
                                    const VertexOf<Value>& b, SumOf<Value> height, Watch watch) {
  EdgeOf<Value> e;
  const LengthOf<Value> dy = make_length<Value>(stage.dy, height, watch);
  const auto step = [&](const Slope& s, SumOf<Value> n) HWY_ATTR __attribute__((always_inline)) {
    return slope<Value>(s, stage.dy, n, dy, watch);
  };
  e.recip_m = dy.inverse.m;
  e.recip_e = dy.inverse.e;
  e.x_step = stage.has_x_step ? step(stage.x_step, difference(b.x, a.x)) : Value(0);
  e.h_step = step(stage.h_step, difference(b.h, a.h));
  const SumOf<Value> q = stage.linear_edges ? SumOf<Value>(1) : depth_sum(stage.depth, b.h);
  e.fu_diff = product<Value>(stage.f_diff, difference(b.u, a.u), q, watch);
  e.fu_step = step(stage.f_step, e.fu_diff);
  e.fv_diff = product<Value>(stage.f_diff, difference(b.v, a.v), q, watch);
  e.fv_step = step(stage.f_step, e.fv_diff);
  for (std::size_t c = 0; c < e.shade_step.size(); ++c) {
    e.shade_step[c] = slope_or_none<Value>(stage.shade_step, stage.dy, difference(b.c[c], a.c[c]), dy, watch);
  }
  return e;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
