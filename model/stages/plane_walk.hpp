// SPDX-License-Identifier: Apache-2.0
// plane_walk: takes the place of edge_walk in const_depth_rows. From a triangle to its rows of constant
// depth, one row per call. docs/numeric-spec.md, "plane_walk" (N1, N2).
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/coverage.hpp"
#include "model/numeric/quantize.hpp"
#include "model/stages/constants.hpp"

namespace bitspan::model {

// Divisions per plane: two gradients of h, gu, gv and the four shades, and k.
inline constexpr std::uint64_t divides_per_plane = 15;
// Divisions of setup_gradients: two each of h, gu and gv.
inline constexpr std::uint64_t divides_per_gradients = 6;

struct PlaneWalkStage {
  std::int64_t width = 0, height = 0;  // of the viewport, pixels
  FillRule fill_rule = FillRule::top_left;
  bool ideal_line = false;
  int subpixel_bits = 0;
  Exact b, shade_offset;
  Register vertex_h, vertex_uv, vertex_shade;  // formats of the setup record
  Register g, h_grad, g_grad, shade_grad, k;
  Register h, f, f_step, shade_acc, shade_step;  // of the span
};
PlaneWalkStage prepare_plane_walk(const Config& config, const Constants& constants, int width, int height);

// What the span stage must know of a triangle whose rows are digital lines, or of a line.
struct PlaneGeometry {
  std::int64_t k = 0;    // raw, plane.k; of a line as in its record
  std::int64_t one = 1;  // 1 on the grid of plane.k; of a line as in its record
  bool along_y = false;  // major
  Coverage coverage;     // of a triangle
  bool is_line = false;
  std::int64_t phase = 0;  // of a line, on the first pixel of its span
};

// The walk over one triangle. Reused for the next one, so that its buffers are not allocated anew.
struct PlaneWalkState {
  PlaneRecord record;
  SetupRecord setup;
  PlaneGeometry geometry;
  std::int64_t row = 0, row_end = 0;  // next row, row after the last one: finished where row >= row_end
  std::int64_t row_begin = 0;
  std::int64_t row_step = 0;  // -1, 1: direction of the digital line
  struct Run {
    std::int64_t first, last;  // major coordinates; first > last: no covered pixel
  };
  std::vector<Run> runs;  // by row - row_begin
};
inline bool finished(const PlaneWalkState& state) { return state.row >= state.row_end; }

// The gradients that the level of detail takes, in every mode; docs/numeric-spec.md, "Gradients".
template <class Watch = NoObserve>
GradientRecord setup_gradients(const PlaneWalkStage& stage, const SetupRecord& setup, Watch watch = {});

// Gradients, and the rows' extents. The record is always delivered, also where no pixel is covered.
template <class Watch = NoObserve>
void start_plane_walk(const PlaneWalkStage& stage, const SetupRecord& setup, PlaneWalkState& state,
                      Watch watch = {});

// One row, state.row, and goes to the next; not to be called when finished. False where the row has no
// covered pixel: then there is no record.
template <class Watch = NoObserve>
bool plane_walk(const PlaneWalkStage& stage, PlaneWalkState& state, PlaneRowRecord& out, Watch watch = {});

}  // namespace bitspan::model
