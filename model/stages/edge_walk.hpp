// SPDX-License-Identifier: Apache-2.0
// edge_walk: from a triangle's edges to its rows of pixels, one row per call.
// docs/numeric-spec.md, "edge_walk": x by an integer error term (exact) or a slope register (dda); h, texture
// numerators and shades by accumulators; u and v of the row's ends by T1.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/numeric/adder.hpp"
#include "model/numeric/forms.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {

struct EdgeWalkStage {
  std::int64_t width = 0, height = 0;  // of the viewport, pixels
  bool owns_every_edge = false;
  EdgeX edge_x = EdgeX::quotient;
  bool linear_edges = false;  // edges carry u and v themselves
  bool by_plane = false;      // edges have a position alone
  int subpixel_bits = 0;
  int t_fraction = 1;  // of t = y + 1/2 - y1e
  // Fraction bits of the walked x. quotient: edge.x's and a guard bit at least; elsewhere edge.x_acc's.
  int x_fraction = 1;
  int x_up = 0;  // quotient: from t's grid to the walked x's; elsewhere from edge.x_acc's fraction
  bool x_fits_int64 = false;  // quotient: numerators fit 64 bits
  Narrowing x, h, shade;
  Line x_start, h_start, f_start, shade_start;
  Adder x_acc, h_acc, f, shade_acc;
  DepthSum depth;             // h + B
  ReciprocalUnit reciprocal;  // R_pixel
  PerspectivePoint uv;
  Narrowing linear_uv;
  int divides_per_row = 0;
  bool fits_lanes = false;  // no intermediate is wider than lanes hold
};
EdgeWalkStage prepare_edge_walk(const Config& config, const Constants& constants, int width, int height);

// An edge's accumulators, of one edge or of lanes of them.
template <class Value>
struct EdgeAccumulators {
  Value h{}, fu{}, fv{};
  std::array<Value, 4> shade{};
};

// An edge's registers on one row. In `exact`, x = (x_floor + x_rest / x_length) 2^-x_fraction.
struct EdgeState {
  EdgeRecord edge;
  SetupVertex start, end;
  bool present = false;  // has height
  bool started = false;
  int128 x_floor = 0, x_rest = 0, x_length = 1, x_step_floor = 0, x_step_rest = 0;
  std::int64_t x_acc = 0;
  EdgeAccumulators<std::int64_t> acc;
};

struct EdgeWalkState {
  std::int64_t triangle = 0;
  bool mid_right = false;
  std::int64_t y = 0, y_end = 0;  // next row, row after the last one: finished where y >= y_end
  std::int64_t y_second = 0;      // first row of edge 2
  std::array<EdgeState, 3> edges;
};
inline bool finished(const EdgeWalkState& state) { return state.y >= state.y_end; }

EdgeWalkState start_edge_walk(const EdgeWalkStage& stage, const SetupRecord& setup, const Edges& edges);

// Walks one row, state.y, and goes to the next; not to be called when finished. False where the row has no
// pixel: then there is no record. Each true result costs stage.divides_per_row divides.
template <class Watch = NoObserve>
bool edge_walk(const EdgeWalkStage& stage, EdgeWalkState& state, RowRecord& out, Watch watch = {});

// Walks the edges over the rows above `to`, which make nothing; returns how many these are. At most to the
// walk's end.
template <class Watch = NoObserve>
std::uint64_t pass_rows(const EdgeWalkStage& stage, EdgeWalkState& state, std::int64_t to, Watch watch = {});

// One end of a row record.
struct RowEnd {
  std::int64_t edge, x_acc, x, h_acc, h, fu, fv, recip_m, recip_e, u, v;
  std::array<std::int64_t, 4> shade_acc, shade;
};
enum class Side { left, right };
RowEnd row_end(const RowRecord& row, Side side);

}  // namespace bitspan::model
