// span_setup: from a row to the start values and increments of its span. docs/numeric-spec.md, "span_setup"
// (T1, T2; N3; N1 with its one reciprocal a row).
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/plane_walk.hpp"

namespace bitspan::model {

struct SpanSetupStage {
  Perspective perspective = Perspective::delta_f;
  SlopeForm form = SlopeForm::reciprocal;
  Exact b;
  ReciprocalUnit reciprocal;  // R_row
  Exact h_offset, f_offset, shade_offset;
  Register row_x, row_h, row_uv, row_shade;  // formats of the row record
  Register plane_h, plane_f, plane_f_step;   // formats of the plane row record
  Register h, h_step, f_diff;
  Register f,
      f_step;  // texture accumulator and step: span.f and span.f_step, or span.uv_acc and span.uv_step
  Register shade_acc, shade_step;
};
SpanSetupStage prepare_span_setup(const Config& config, const Constants& constants);

// Both return the divides it took (for divides_row).
// All modes but const_depth_rows.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const RowRecord& row, SpanRecord& out, Watch watch = {});
// const_depth_rows.
template <class Watch = NoObserve>
int span_setup(const SpanSetupStage& stage, const PlaneRowRecord& row, const PlaneGeometry& geometry,
               SpanRecord& out, Watch watch = {});

}  // namespace bitspan::model
