#include "model/stages/span_setup.hpp"

#include "model/channels.hpp"
#include "model/numeric/slope.hpp"
#include "model/stages/edge_walk.hpp"

namespace bitspan::model {

SpanSetupStage prepare_span_setup(const Config& config, const Constants& constants) {
  SpanSetupStage s;
  s.perspective = config.perspective;
  s.form = config.row_slope;
  s.b = b_of(config, constants.record);
  s.reciprocal = ReciprocalUnit(config.row_reciprocal, RegisterId::row_reciprocal);
  const bool linear =
      config.perspective == Perspective::affine || config.perspective == Perspective::const_depth_rows;
  s.h_offset = offset_value(config.start_offset.span_h, config.depth_format());
  s.f_offset =
      offset_value(config.start_offset.span_f, config.format(linear ? FormatId::span_uv : FormatId::span_f));
  s.shade_offset = offset_value(config.start_offset.span_shade, config.format(FormatId::span_shade));
  s.row_x = make_register(config, FormatId::edge_x);
  s.row_h = make_register(config, FormatId::edge_h);
  s.row_uv = make_register(config, FormatId::edge_uv);
  s.row_shade = make_register(config, FormatId::edge_shade);
  s.plane_h = make_register(config, FormatId::span_h);
  s.plane_f = make_register(config, FormatId::span_f);
  s.plane_f_step = make_register(config, FormatId::span_f_step);
  s.h = make_register(config, FormatId::span_h);
  s.h_step = make_register(config, FormatId::span_h_step);
  s.f_diff = make_register(config, FormatId::span_f_diff);
  s.f = make_register(config, linear ? FormatId::span_uv_acc : FormatId::span_f);
  s.f_step = make_register(config, linear ? FormatId::span_uv_step : FormatId::span_f_step);
  s.shade_acc = make_register(config, FormatId::span_shade_acc);
  s.shade_step = make_register(config, FormatId::span_shade_step);
  return s;
}

template <class Watch>
int span_setup(const SpanSetupStage& stage, const RowRecord& row, SpanRecord& out, Watch watch) {
  const RowEnd l = row_end(row, Side::left);
  const RowEnd r = row_end(row, Side::right);
  out = {};
  out.triangle = row.triangle;
  out.x = row.x_first;
  out.y = row.y;
  out.count = row.x_last - row.x_first + 1;

  const Exact x_l = value_of(l.x, stage.row_x);
  const Exact distance = value_of(r.x, stage.row_x) - x_l;
  const Exact pre_step = Exact{2 * int128{row.x_first} + 1, 1} - x_l;
  const bool has_length = distance.raw > 0;
  Length length;
  if (has_length) {
    length = make_length(distance, stage.form, stage.reciprocal, watch);
    out.recip_m = length.inverse.m;
    out.recip_e = length.inverse.e;
  }
  const auto step_of = [&](Exact n, const Register& step) {
    return has_length ? slope(n, length, step, watch) : 0;
  };

  const Exact h_l = value_of(l.h, stage.row_h);
  const Exact h_r = value_of(r.h, stage.row_h);
  out.h_step = step_of(h_r - h_l, stage.h_step);
  out.h = quantize(h_l + value_of(out.h_step, stage.h_step) * pre_step + stage.h_offset, stage.h, watch);

  const auto texture = [&](std::int64_t t_l, std::int64_t t_r, std::int64_t& diff, std::int64_t& base,
                           std::int64_t& start, std::int64_t& step) {
    const Exact left = value_of(t_l, stage.row_uv);
    const Exact right = value_of(t_r, stage.row_uv);
    Exact from;  // of the accumulator at the left end
    if (stage.perspective == Perspective::delta_f) {
      diff = quantize((right - left) * (h_r + stage.b), stage.f_diff, watch);
      base = t_l;
      step = step_of(value_of(diff, stage.f_diff), stage.f_step);
    } else if (stage.perspective == Perspective::hyperbolic) {
      from = value_of(quantize(left * (h_l + stage.b), stage.f_diff, watch), stage.f_diff);
      diff = quantize(right * (h_r + stage.b), stage.f_diff, watch);
      step = step_of(value_of(diff, stage.f_diff) - from, stage.f_step);
    } else {
      from = left;
      step = step_of(right - left, stage.f_step);
    }
    start = quantize(from + value_of(step, stage.f_step) * pre_step + stage.f_offset, stage.f, watch);
  };
  texture(l.u, r.u, out.fu_diff, out.u1, out.fu, out.fu_step0);
  texture(l.v, r.v, out.fv_diff, out.v1, out.fv, out.fv_step0);
  out.fu_step1 = out.fu_step0;
  out.fv_step1 = out.fv_step0;
  for (std::size_t c = 0; c < channel_count; ++c) {
    const Exact left = value_of(l.shade[c], stage.row_shade);
    const std::int64_t step = step_of(value_of(r.shade[c], stage.row_shade) - left, stage.shade_step);
    out.*span_steps0[c] = step;
    out.*span_steps1[c] = step;
    out.*span_starts[c] = quantize(left + value_of(step, stage.shade_step) * pre_step + stage.shade_offset,
                                   stage.shade_acc, watch);
  }
  if (!has_length) {
    return 0;
  }
  return stage.form == SlopeForm::reciprocal ? 1 : 7;
}

template <class Watch>
int span_setup(const SpanSetupStage& stage, const PlaneRowRecord& row, const PlaneGeometry& geometry,
               SpanRecord& out, Watch watch) {
  out = {};
  out.triangle = row.triangle;
  out.x = geometry.along_y ? row.minor_first : row.major_first;
  out.y = geometry.along_y ? row.major_first : row.minor_first;
  out.count = row.count;
  out.phase = row.phase;
  out.h = row.h;
  const Inverse inverse = stage.reciprocal(value_of(row.h, stage.plane_h) + stage.b, watch);
  const Exact r = stage.reciprocal.value(inverse);
  out.recip_m = inverse.m;
  out.recip_e = inverse.e;
  const auto start = [&](std::int64_t g) {
    return quantize(value_of(g, stage.plane_f) * r + stage.f_offset, stage.f, watch);
  };
  const auto step = [&](std::int64_t g) {
    return quantize(value_of(g, stage.plane_f_step) * r, stage.f_step, watch);
  };
  out.fu = start(row.gu);
  out.fv = start(row.gv);
  out.fu_step0 = step(row.gu_step0);
  out.fu_step1 = step(row.gu_step1);
  out.fv_step0 = step(row.gv_step0);
  out.fv_step1 = step(row.gv_step1);
  for (std::size_t c = 0; c < channel_count; ++c) {
    out.*span_starts[c] = row.*plane_row_starts[c];
    out.*span_steps0[c] = row.*plane_row_steps0[c];
    out.*span_steps1[c] = row.*plane_row_steps1[c];
  }
  return 1;
}

template int span_setup(const SpanSetupStage&, const RowRecord&, SpanRecord&, NoObserve);
template int span_setup(const SpanSetupStage&, const RowRecord&, SpanRecord&, Observe);
template int span_setup(const SpanSetupStage&, const PlaneRowRecord&, const PlaneGeometry&, SpanRecord&,
                        NoObserve);
template int span_setup(const SpanSetupStage&, const PlaneRowRecord&, const PlaneGeometry&, SpanRecord&,
                        Observe);

}  // namespace bitspan::model
