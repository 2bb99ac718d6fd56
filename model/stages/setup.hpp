// SPDX-License-Identifier: Apache-2.0
// setup: snaps, quantises and sorts a triangle's vertices, and forms the slopes of its edges.
// docs/numeric-spec.md, "setup" (D1 for h, T1 for the texture slopes).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/slope.hpp"
#include "model/stages/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct SetupStage {
  int exponent = 0;  // E
  Exact s_max;
  std::int64_t b = 0;  // B raw, and how (B (s_max' - s')) / s' is scaled
  int h_scale = 0;
  bool h_fits_int64 = false, area_fits_int64 = false;  // in 64 bits
  DepthSum depth;                                      // h + B
  bool linear_edges = false;  // u and v are interpolated, not u (h + B) and v (h + B)
  bool has_x_step = false;
  Register coordinate, s, h, uv, shade;
  LengthForm dy;  // R_edge
  Slope x_step, h_step, f_step, shade_step;
  Product f_diff;
  bool by_plane = false;  // edges have a position alone
  int divides_per_edge = 0;
  bool fits_lanes = false;  // no intermediate is wider than lanes hold
};
SetupStage prepare_setup(const Config& config, const Constants& constants);

// A vertex, raw, as in the setup record; of one triangle or of lanes of them.
template <class Value>
struct VertexOf {
  Value x{}, y{}, h{}, u{}, v{};
  std::array<Value, 4> c{};
};
using SetupVertex = VertexOf<std::int64_t>;
SetupVertex vertex_of(const SetupRecord& record, int i);
void put_vertex(SetupRecord& record, int i, const SetupVertex& v);

// False where a triangle has no area after snapping; then there is no record. A line's ends are vertices 0
// and 2. Every number of the input is finite and s is within the scene's range (check_triangle in
// pipeline.hpp).
template <class Watch = NoObserve>
bool setup(const SetupStage& stage, const Triangle& triangle, std::int64_t index, SetupRecord& out,
           Watch watch = {});

// The edges that have height, in the order 0 (vertex 0 to 2), 1 (0 to 1), 2 (1 to 2).
struct Edges {
  std::array<EdgeRecord, 3> edge;
  int count = 0;
};
template <class Watch = NoObserve>
Edges setup_edges(const SetupStage& stage, const SetupRecord& record, Watch watch = {});

}  // namespace bitspan::model
