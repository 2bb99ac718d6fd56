// edge_walk: from a triangle's edges to its rows of pixels, a row a call.
// docs/numeric-spec.md, "edge_walk": x by an integer error term (exact) or a slope register (dda); h, texture
// numerators and shades by accumulators; u and v of the row's ends by T1.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {

struct EdgeWalkStage {
  std::int64_t width = 0, height = 0;  // of the viewport, pixels
  FillRule fill_rule = FillRule::top_left;
  EdgeWalk walk = EdgeWalk::exact;
  DdaUpdate update = DdaUpdate::accumulate;
  bool affine = false;
  int subpixel_bits = 0;
  int x_fraction = 1;  // of the walked x in `exact`: edge.x's and a guard bit at least
  Exact b;
  ReciprocalUnit reciprocal;  // R_pixel
  Exact x_offset, h_offset, f_offset, shade_offset;
  Register vertex_h, vertex_uv, vertex_shade;  // formats of the setup record
  Register x_step, x_acc, x, h_step, h_acc, h, f_step, f, uv, shade_step, shade_acc, shade;
  int divides_per_row = 0;
};
EdgeWalkStage prepare_edge_walk(const Config& config, const Constants& constants, int width, int height);

// An edge's registers on one row. In `exact`, x = (x_floor + x_rest / x_length) 2^-x_fraction.
struct EdgeState {
  EdgeRecord edge;
  SetupVertex start, end;
  bool present = false;  // has height
  bool started = false;
  int128 x_floor = 0, x_rest = 0, x_length = 1, x_step_floor = 0, x_step_rest = 0;
  std::int64_t x_acc = 0, h_acc = 0, fu = 0, fv = 0;
  std::array<std::int64_t, 4> shade_acc{};
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

// One end of a row record.
struct RowEnd {
  std::int64_t edge, x_acc, x, h_acc, h, fu, fv, recip_m, recip_e, u, v;
  std::array<std::int64_t, 4> shade_acc, shade;
};
enum class Side { left, right };
RowEnd row_end(const RowRecord& row, Side side);

}  // namespace bitspan::model
