// SPDX-License-Identifier: Apache-2.0
#include "model/stages/span_setup.hpp"

#include <algorithm>
#include <utility>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/stages/edge_walk.hpp"
#include "model/stages/span_setup-inl.hpp"

namespace bitspan::model {

namespace {

// x + 1/2 - x_l of a pixel; a picture is 2^20 pixels wide at most.
Grid way_of(const Register& x) { return magnitude_of(x) + Grid{20, 1}; }

}  // namespace

RowLine make_row_line(const Config& config, const bitspan::Line& line, const LengthForm& length) {
  const Register end = make_register(config, line.edge.kept);
  const Register step = make_register(config, line.row.step);
  return {make_slope(step, magnitude_of(end) + magnitude_of(end), length),
          make_line(make_register(config, line.row.acc), &end, step,
                    way_of(make_register(config, FormatId::edge_x)), offset_value(config, line.row))};
}

LengthForm make_row_length(const Config& config) {
  const Grid x = magnitude_of(make_register(config, FormatId::edge_x));
  return make_length_form(form_of(config.row_slope),
                          ReciprocalUnit(config.row_reciprocal, RegisterId::row_reciprocal), x + x);
}

SpanSetupStage prepare_span_setup(const Config& config, const Constants& constants) {
  SpanSetupStage s;
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  const bool linear = has_linear_texture(config.perspective);
  s.perspective = config.perspective;
  s.form = form_of(config.row_slope);
  s.has_line_slope = has_line_slope(config.line_walk);
  s.b = b_of(config, constants.record);
  s.reciprocal = ReciprocalUnit(config.row_reciprocal, RegisterId::row_reciprocal);
  const bitspan::Line h = line_of(LineId::h, config.perspective);
  const bitspan::Line f = line_of(LineId::fu, config.perspective);
  const bitspan::Line shade = line_of(LineId::r, config.perspective);
  s.h_offset = offset_value(config, h.row);
  s.f_offset = offset_value(config, f.row);
  s.shade_offset = offset_value(config, shade.row);
  s.plane_h = reg(h.row.acc);
  s.plane_f = reg(FormatId::span_f);
  s.plane_f_step = reg(FormatId::span_f_step);
  s.f = reg(f.row.acc);
  s.uv_step = reg(f.row.step);

  s.subpixel_bits = config.subpixel_bits;
  s.vertex_h = reg(h.vertex);
  s.vertex_shade = reg(shade.vertex);
  s.g = reg(f.product.value());
  s.h_grad = reg(h.gradient);
  s.g_grad = reg(f.gradient);
  s.shade_grad = reg(shade.gradient);

  const Register x = reg(FormatId::edge_x);
  const Register uv = reg(f.edge.kept);
  s.p_fraction = std::max(1, x.fraction);
  s.x_up = s.p_fraction - x.fraction;
  const Grid p = way_of(x);
  s.length = make_row_length(config);
  s.depth = make_depth_sum(reg(h.edge.kept), s.b, config.pixel_reciprocal);
  s.h_line = make_row_line(config, h, s.length);
  s.shade_line = make_row_line(config, shade, s.length);
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
  // The lanes have rows by their ends alone.
  s.fits_lanes = !has_setup_plane(config) && lanes_hold(p) && s.length.fits_lanes && s.h_line.fits_lanes() &&
                 s.shade_line.fits_lanes() && s.f_step.fits_lanes && s.f_start.fits_lanes &&
                 (linear || (lanes_hold(s.depth.magnitude) && s.f_diff.fits_lanes));
  return s;
}

namespace {

// Where the row's pixels lie; the rest is 0.
SpanRecord span_of(const RowRecord& row) {
  SpanRecord out{};
  out.triangle = row.triangle;
  out.x = row.x_first;
  out.y = row.y;
  out.count = row.x_last - row.x_first + 1;
  return out;
}

}  // namespace

template <class Watch>
int span_setup(const SpanSetupStage& stage, const RowRecord& row, SpanRecord& out, Watch watch) {
  const RowEnd l = row_end(row, Side::left);
  const RowEnd r = row_end(row, Side::right);
  out = span_of(row);
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
int span_setup(const SpanSetupStage& stage, const RowRecord& row, const TrianglePlane& plane, SpanRecord& out,
               Watch watch) {
  const SetupPlaneRecord& p = plane.record;
  out = span_of(row);
  out.u1 = p.u1;
  out.v1 = p.v1;
  const Exact half{1, 1};
  const Exact right = Exact{row.x_first, 0} + half - Exact{plane.origin.x, stage.subpixel_bits};
  const Exact down = Exact{row.y, 0} + half - Exact{plane.origin.y, stage.subpixel_bits};
  const auto at = [&](Exact from, Exact x, Exact y, Exact offset, const Register& r) {
    return quantize(from + x * right + y * down + offset, r, watch);
  };
  const Exact h_x = value_of(p.h_x, stage.h_grad);
  out.h = at(value_of(plane.origin.h, stage.vertex_h), h_x, value_of(p.h_y, stage.h_grad), stage.h_offset,
             stage.plane_h);
  out.h_step = quantize(h_x, stage.h_line.step.r, watch);
  const auto texture = [&](std::int64_t f0, std::int64_t x, std::int64_t y, std::int64_t& start,
                           std::int64_t& step0, std::int64_t& step1) {
    const Exact along = value_of(x, stage.g_grad);
    start = at(value_of(f0, stage.g), along, value_of(y, stage.g_grad), stage.f_offset, stage.f);
    step0 = step1 = quantize(along, stage.uv_step, watch);
  };
  texture(p.fu0, p.fu_x, p.fu_y, out.fu, out.fu_step0, out.fu_step1);
  texture(p.fv0, p.fv_x, p.fv_y, out.fv, out.fv_step0, out.fv_step1);
  for (std::size_t c = 0; c < channel_count; ++c) {
    const Exact along = value_of(p.*setup_plane_x[c], stage.shade_grad);
    out.*span_starts[c] =
        at(value_of(plane.origin.c[c], stage.vertex_shade), along,
           value_of(p.*setup_plane_y[c], stage.shade_grad), stage.shade_offset, stage.shade_line.start.r);
    out.*span_steps0[c] = out.*span_steps1[c] = quantize(along, stage.shade_line.step.r, watch);
  }
  return 0;
}

template <class Watch>
int span_setup(const SpanSetupStage& stage, const LineWalkRecord& line, SpanRecord& out, Watch watch) {
  const int divides = span_setup(stage, row_of(line), out, watch);
  if (line.major == 1) std::swap(out.x, out.y);
  if (stage.has_line_slope) out.phase = line.phase;
  return divides;
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
template int span_setup(const SpanSetupStage&, const RowRecord&, const TrianglePlane&, SpanRecord&,
                        NoObserve);
template int span_setup(const SpanSetupStage&, const RowRecord&, const TrianglePlane&, SpanRecord&, Observe);
template int span_setup(const SpanSetupStage&, const LineWalkRecord&, SpanRecord&, NoObserve);
template int span_setup(const SpanSetupStage&, const LineWalkRecord&, SpanRecord&, Observe);
template int span_setup(const SpanSetupStage&, const PlaneRowRecord&, const PlaneGeometry&, SpanRecord&,
                        NoObserve);
template int span_setup(const SpanSetupStage&, const PlaneRowRecord&, const PlaneGeometry&, SpanRecord&,
                        Observe);

}  // namespace bitspan::model
