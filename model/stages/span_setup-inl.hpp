// SPDX-License-Identifier: Apache-2.0
// span_setup's arithmetic for horizontal rows, one text for a row and for lanes of them. Value: what
// registers hold, std::int64_t or Lanes.
#include "config/modes.hpp"
#include "model/numeric/slope-inl.hpp"
#include "model/stages/span_setup.hpp"

#if defined(BITSPAN_MODEL_STAGES_SPAN_SETUP_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_SPAN_SETUP_INL
#undef BITSPAN_MODEL_STAGES_SPAN_SETUP_INL
#else
#define BITSPAN_MODEL_STAGES_SPAN_SETUP_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// What the stage reads of a row's end.
template <class Value>
struct SpanEnd {
  Value x, h, u, v;
  std::array<Value, 4> shade;
};

template <class Value>
struct SpanTexture {
  Value diff, base, start, step;
};
template <class Value>
struct SpanStart {
  decltype(Value() < Value()) has_length;
  LengthOf<Value> length;
  SumOf<Value> p;  // from the left end to the first pixel's centre
  Value recip_m, recip_e, h, h_step;
  SpanTexture<Value> u, v;
  std::array<Value, 4> shade, shade_step;
};

// A linear line from the left end of a row.
template <class Value>
struct LineStart {
  Value start, step;
};
template <class Value, class Watch>
HWY_INLINE LineStart<Value> start_line(const RowLine& line, const LengthForm& form,
                                       const SpanStart<Value>& row, Value left, Value right, Watch watch) {
  const Value step = where(
      row.has_length, watch, [&](auto seen) HWY_ATTR __attribute__((always_inline)) {
        return slope_or_none<Value>(line.step, form, difference(right, left), row.length, seen);
      });
  return {line_at(line.start, left, step, row.p, watch), step};
}

template <class Value, class Watch>
HWY_INLINE SpanStart<Value> start_span_at(const SpanSetupStage& stage, const SpanEnd<Value>& l,
                                          const SpanEnd<Value>& r, Value x_first, Watch watch) {
  SpanStart<Value> out;
  const Value none(0);
  const SumOf<Value> distance = difference(r.x, l.x);
  const auto has_length = distance > SumOf<Value>(0);
  out.has_length = has_length;
  const LengthOf<Value> length = out.length = length_where<Value>(has_length, stage.length, distance, watch);
  out.recip_m = length.inverse.m;
  out.recip_e = length.inverse.e;
  const SumOf<Value> p =
      (SumOf<Value>((x_first << 1) + Value(1)) << (stage.p_fraction - 1)) - (SumOf<Value>(l.x) << stage.x_up);
  out.p = p;
  const auto step_of = [&](const Slope& s, SumOf<Value> n) HWY_ATTR __attribute__((always_inline)) {
    return where(
        has_length, watch, [&](auto seen) HWY_ATTR __attribute__((always_inline)) {
          return slope<Value>(s, stage.length, n, length, seen);
        });
  };

  out.h_step = step_of(stage.h_line.step, difference(r.h, l.h));
  out.h = line_at(stage.h_line.start, l.h, out.h_step, p, watch);
  const auto texture = [&](Value left, Value right) HWY_ATTR __attribute__((always_inline)) {
    SpanTexture<Value> t;
    t.diff = t.base = none;
    Value from = none;  // of the accumulator at the left end
    switch (stage.perspective) {
      case Perspective::delta_f:
        t.diff = product<Value>(stage.f_diff, difference(right, left), depth_sum(stage.depth, r.h), watch);
        t.base = left;
        t.step = step_of(stage.f_step, t.diff);
        break;
      case Perspective::hyperbolic:
        from = product<Value>(stage.f_diff, left, depth_sum(stage.depth, l.h), watch);
        t.diff = product<Value>(stage.f_diff, right, depth_sum(stage.depth, r.h), watch);
        t.step = step_of(stage.f_step, difference(t.diff, from));
        break;
      case Perspective::affine:
        from = left;
        t.step = step_of(stage.f_step, difference(right, left));
        break;
      case Perspective::const_depth_rows:  // has no horizontal rows
        unreachable();
    }
    t.start = line_at(stage.f_start, from, t.step, p, watch);
    return t;
  };
  out.u = texture(l.u, r.u);
  out.v = texture(l.v, r.v);
  for (std::size_t c = 0; c < l.shade.size(); ++c) {
    const LineStart<Value> line =
        start_line(stage.shade_line, stage.length, out, l.shade[c], r.shade[c], watch);
    out.shade[c] = line.start;
    out.shade_step[c] = line.step;
  }
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
