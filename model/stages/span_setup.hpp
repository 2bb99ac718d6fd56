// SPDX-License-Identifier: Apache-2.0
// span_setup: from a row to the start values and increments of its span. docs/numeric-spec.md, "span_setup"
// (T1, T2; N3; N1 with its one reciprocal per row).
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/numeric/slope.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/line_walk.hpp"
#include "model/stages/plane_walk.hpp"
#include "model/stages/setup_plane.hpp"

namespace bitspan::model {

// Of a linear line: its slope between the ends of a row, and its start on the row's first pixel.
struct RowLine {
  Slope step;
  Line start;
  bool fits_lanes() const { return step.fits_lanes && start.fits_lanes; }
};
RowLine make_row_line(const Config& config, const bitspan::Line& line, const LengthForm& length);
// The length of a row, x_r - x_l.
LengthForm make_row_length(const Config& config);

struct SpanSetupStage {
  Perspective perspective = Perspective::delta_f;
  SlopeForm form = SlopeForm::reciprocal;
  // All modes but const_depth_rows.
  int p_fraction = 1, x_up = 0;  // p = x_first + 1/2 - x_l, and edge.x's way onto its grid
  LengthForm length;             // R_row(x_r - x_l)
  DepthSum depth;                // h + B of a row's end
  RowLine h_line, shade_line;
  Slope f_step;
  Product f_diff;
  Line f_start;
  bool fits_lanes = false;      // no intermediate is wider than lanes hold
  bool has_line_slope = false;  // the phase of a line is on the grid of plane.k
  // slope.row = plane.
  int subpixel_bits = 0;
  Exact h_offset, shade_offset;
  Register vertex_h, vertex_shade;         // formats of the setup record
  Register g, h_grad, g_grad, shade_grad;  // of the setup.plane record
  // const_depth_rows.
  Exact b;
  ReciprocalUnit reciprocal;  // R_row
  Exact f_offset;
  Register plane_h, plane_f, plane_f_step;  // formats of the plane row record
  Register f, uv_step;                      // of the texture accumulator and its step
};
SpanSetupStage prepare_span_setup(const Config& config, const Constants& constants);

// Divides of a row that has a length: one reciprocal, or one per slope.
constexpr int divides_of(const SpanSetupStage& stage) { return shares_reciprocal(stage.form) ? 1 : 7; }

// All return the divides it took (for divides_row).
// All modes but const_depth_rows.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const RowRecord& row, SpanRecord& out, Watch watch = {});
// The same with slope.row = plane, which takes no divide.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const RowRecord& row, const TrianglePlane& plane, SpanRecord& out,
               Watch watch = {});
// Of a line.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const LineWalkRecord& line, SpanRecord& out, Watch watch = {});
// const_depth_rows.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const PlaneRowRecord& row, const PlaneGeometry& geometry,
               SpanRecord& out, Watch watch = {});

}  // namespace bitspan::model
