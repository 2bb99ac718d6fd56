// SPDX-License-Identifier: Apache-2.0
// edge_walk's arithmetic, one text for an edge or a row and for lanes of them. Value: what registers hold,
// std::int64_t or Lanes.
#include "model/numeric/forms-inl.hpp"
#include "model/stages/edge_walk.hpp"

#if defined(BITSPAN_MODEL_STAGES_EDGE_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_EDGE_WALK_INL
#undef BITSPAN_MODEL_STAGES_EDGE_WALK_INL
#else
#define BITSPAN_MODEL_STAGES_EDGE_WALK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// y + 1/2 - y1e of row y, on 2^-t_fraction; start_y: y1e, raw.
template <class Value>
HWY_INLINE Value rows_from(const EdgeWalkStage& stage, Value y, Value start_y) {
  return (((y << 1) + Value(1)) << (stage.t_fraction - 1)) -
         (start_y << (stage.t_fraction - stage.subpixel_bits));
}

// First row whose centre is at or below y.
template <class Value>
HWY_INLINE Value first_row(const EdgeWalkStage& stage, Value y) {
  const Value below_half((std::int64_t{1} << (stage.t_fraction - 1)) - 1);
  return ((y << (stage.t_fraction - stage.subpixel_bits)) + below_half) >> stage.t_fraction;
}
// Last row whose centre is at or above y.
template <class Value>
HWY_INLINE Value last_row(const EdgeWalkStage& stage, Value y) {
  const Value half(std::int64_t{1} << (stage.t_fraction - 1));
  return ((y << (stage.t_fraction - stage.subpixel_bits)) - half) >> stage.t_fraction;
}
// One past the last row of a triangle whose lowest vertex is at y.
template <class Value>
HWY_INLINE Value end_row(const EdgeWalkStage& stage, Value y) {
  return stage.owns_every_edge ? last_row(stage, y) + Value(1) : first_row(stage, y);
}

// EdgeX::quotient: X on row t as at / length, and one row's step over the same length; on 2^-x_fraction.
template <class Int>
struct ExactX {
  Int at, step, length;
};
template <class Int, class Value>
HWY_INLINE ExactX<Int> exact_x(const EdgeWalkStage& stage, const VertexOf<Value>& start,
                               const VertexOf<Value>& end, Value t) {
  const auto dx = difference(end.x, start.x);
  const auto dy = difference(end.y, start.y);
  // Numerators over dy, on t's grid: the vertices' and a half.
  const SumOf<Value> x1 = SumOf<Value>(start.x) << (stage.t_fraction - stage.subpixel_bits);
  const Int at = product_in<Int>(x1, dy) + product_in<Int>(dx, SumOf<Value>(t));
  const Int step = Int(dx) << stage.t_fraction;
  const int up = stage.x_up > 0 ? stage.x_up : 0;
  const int down = stage.x_up < 0 ? -stage.x_up : 0;
  return {at << up, step << up, Int(dy) << down};
}

template <class Value, class Watch>
HWY_INLINE EdgeAccumulators<Value> start_accumulators(const EdgeWalkStage& stage,
                                                      const VertexOf<Value>& start, Value h_step,
                                                      Value fu_step, Value fv_step,
                                                      const std::array<Value, 4>& shade_step, Value t,
                                                      Watch watch) {
  const Value none(0);
  const auto shade = [&](std::size_t c) HWY_ATTR __attribute__((always_inline)) {
    return line_at(stage.shade_start, start.c[c], shade_step[c], t, watch);
  };
  return {line_at(stage.h_start, start.h, h_step, t, watch),
          line_at(stage.f_start, stage.linear_edges ? start.u : none, fu_step, t, watch),
          line_at(stage.f_start, stage.linear_edges ? start.v : none, fv_step, t, watch),
          {shade(0), shade(1), shade(2), shade(3)}};
}

// X: at 2^-x_fraction, and more (1 where there is more, by less than one, else 0); x_fraction >= 1. Sum: what
// holds it, as SumOf.
template <class Sum>
struct Position {
  Sum at, more;
};
// ceil(X - 1/2), floor(X - 1/2): the first centre at or right of X, the last at or left of it.
template <class Sum>
HWY_INLINE Sum first_centre(const EdgeWalkStage& stage, const Position<Sum>& x) {
  const Sum half = Sum(1) << (stage.x_fraction - 1);
  return (x.at + (half - Sum(1)) + x.more) >> stage.x_fraction;
}
template <class Sum>
HWY_INLINE Sum last_centre(const EdgeWalkStage& stage, const Position<Sum>& x) {
  return (x.at - (Sum(1) << (stage.x_fraction - 1))) >> stage.x_fraction;
}

// The pixels of a row between its ends; none where first > last.
template <class Value>
struct PixelsOf {
  Value first, last;
};
template <class Value>
HWY_INLINE PixelsOf<Value> pixels_between(const EdgeWalkStage& stage, const Position<SumOf<Value>>& left,
                                          const Position<SumOf<Value>>& right) {
  const auto end =
      stage.owns_every_edge ? last_centre(stage, right) : first_centre(stage, right) - SumOf<Value>(1);
  return {max(Value(0), static_cast<Value>(first_centre(stage, left))),
          min(Value(stage.width - 1), static_cast<Value>(end))};
}

// EdgeX::quotient: Q[edge.x](X). Its lowest bit is a guard bit at most, so `more` is a sticky bit below it.
template <class Value, class Watch>
HWY_INLINE Value exact_row_x(const EdgeWalkStage& stage, const Position<SumOf<Value>>& x, Watch watch) {
  return narrowed<Value>(stage.x, (x.at << 1) | x.more, watch);
}

// What a row's end keeps beside its accumulators.
template <class Value>
struct EndOf {
  Value h, recip_m, recip_e, u, v;
  std::array<Value, 4> shade;
};
// u1, v1: of the edge's start vertex.
template <class Value, class Watch>
HWY_INLINE EndOf<Value> end_values(const EdgeWalkStage& stage, const EdgeAccumulators<Value>& acc, Value u1,
                                   Value v1, Watch watch) {
  EndOf<Value> out;
  out.h = narrowed<Value>(stage.h, acc.h, watch);
  if (stage.linear_edges) {
    out.recip_m = out.recip_e = Value(0);
    out.u = narrowed<Value>(stage.linear_uv, acc.fu, watch);
    out.v = narrowed<Value>(stage.linear_uv, acc.fv, watch);
  } else {
    const InverseOf<Value> inverse =
        HWY_NAMESPACE::reciprocal(stage.reciprocal.formats(), stage.reciprocal.table().data(),
                                  depth_sum(stage.depth, out.h), stage.depth.fraction, watch);
    out.recip_m = inverse.m;
    out.recip_e = inverse.e;
    out.u = perspective_point(stage.uv, u1, acc.fu, inverse, watch);
    out.v = perspective_point(stage.uv, v1, acc.fv, inverse, watch);
  }
  for (std::size_t c = 0; c < out.shade.size(); ++c) {
    out.shade[c] = narrowed<Value>(stage.shade, acc.shade[c], watch);
  }
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
