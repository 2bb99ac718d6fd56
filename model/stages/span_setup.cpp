// SPDX-License-Identifier: Apache-2.0
#include "model/stages/span_setup.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/stages/edge_walk.hpp"
#include "model/stages/span_setup-inl.hpp"

namespace bitspan::model {

SpanSetupStage prepare_span_setup(const Config& config, const Constants& constants) {
  SpanSetupStage s;
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  const bool linear = has_linear_texture(config.perspective);
  s.perspective = config.perspective;
  s.form = config.row_slope;
  s.b = b_of(config, constants.record);
  s.reciprocal = ReciprocalUnit(config.row_reciprocal, RegisterId::row_reciprocal);
  const Exact h_offset = offset_value(config.start_offset.span_h, config.depth_format());
  s.f_offset =
      offset_value(config.start_offset.span_f, config.format(linear ? FormatId::span_uv : FormatId::span_f));
  const Exact shade_offset =
      offset_value(config.start_offset.span_shade, config.format(FormatId::span_shade));
  s.plane_h = reg(FormatId::span_h);
  s.plane_f = reg(FormatId::span_f);
  s.plane_f_step = reg(FormatId::span_f_step);
  s.f = reg(linear ? FormatId::span_uv_acc : FormatId::span_f);
  s.uv_step = reg(linear ? FormatId::span_uv_step : FormatId::span_f_step);

  const Register x = reg(FormatId::edge_x);
  const Register h = reg(FormatId::edge_h);
  const Register uv = reg(FormatId::edge_uv);
  const Register shade = reg(FormatId::edge_shade);
  s.p_fraction = std::max(1, x.fraction);
  s.x_up = s.p_fraction - x.fraction;
  const Grid p = magnitude_of(x) + Grid{20, 1};  // a picture is 2^20 pixels wide at most
  s.length = make_length_form(config.row_slope, s.reciprocal, magnitude_of(x) + magnitude_of(x));
  s.depth = make_depth_sum(h, s.b, config.pixel_reciprocal);
  s.h_step = make_slope(reg(FormatId::span_h_step), magnitude_of(h) + magnitude_of(h), s.length);
  s.h_start = make_line(reg(FormatId::span_h), &h, s.h_step.r, p, h_offset);
  const bool hyperbolic = has_pixel_quotients(config.perspective);
  const Grid uv_difference = magnitude_of(uv) + magnitude_of(uv);
  s.f_diff = make_product(reg(FormatId::span_f_diff), hyperbolic ? magnitude_of(uv) : uv_difference,
                          s.depth.magnitude);
  const Register& diff = s.f_diff.r;
  s.f_step = make_slope(s.uv_step,
                        linear       ? uv_difference
                        : hyperbolic ? magnitude_of(diff) + magnitude_of(diff)
                                     : magnitude_of(diff),
                        s.length);
  s.f_start = make_line(s.f, linear ? &uv : hyperbolic ? &diff : nullptr, s.uv_step, p, s.f_offset);
  s.shade_step =
      make_slope(reg(FormatId::span_shade_step), magnitude_of(shade) + magnitude_of(shade), s.length);
  s.shade_start = make_line(reg(FormatId::span_shade_acc), &shade, s.shade_step.r, p, shade_offset);
  s.fits_lanes = lanes_hold(p) && s.length.fits_lanes && s.h_step.fits_lanes && s.h_start.fits_lanes &&
                 s.f_step.fits_lanes && s.f_start.fits_lanes && s.shade_step.fits_lanes &&
                 s.shade_start.fits_lanes &&
                 (linear || (lanes_hold(s.depth.magnitude) && s.f_diff.fits_lanes));
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
  const auto values = [](const RowEnd& e) {
    return HWY_NAMESPACE::SpanEnd<std::int64_t>{e.x, e.h, e.u, e.v, e.shade};
  };
  const auto span = HWY_NAMESPACE::start_span_at(stage, values(l), values(r), row.x_first, watch);
  out.recip_m = span.recip_m;
  out.recip_e = span.recip_e;
  out.h = span.h;
  out.h_step = span.h_step;
  out.fu_diff = span.u.diff;
  out.u1 = span.u.base;
  out.fu = span.u.start;
  out.fu_step0 = out.fu_step1 = span.u.step;
  out.fv_diff = span.v.diff;
  out.v1 = span.v.base;
  out.fv = span.v.start;
  out.fv_step0 = out.fv_step1 = span.v.step;
  for (std::size_t c = 0; c < channel_count; ++c) {
    out.*span_steps0[c] = span.shade_step[c];
    out.*span_steps1[c] = span.shade_step[c];
    out.*span_starts[c] = span.shade[c];
  }
  return span.has_length ? divides_of(stage) : 0;
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
    return quantize(value_of(g, stage.plane_f_step) * r, stage.uv_step, watch);
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
