// setup: snaps, quantises and sorts a triangle's vertices, and forms the slopes of its edges.
// docs/numeric-spec.md, "setup" (D1 for h, T1 for the texture slopes).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "config/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct SetupStage {
  int exponent = 0;  // E
  Exact b, s_max;
  Perspective perspective = Perspective::delta_f;
  EdgeWalk walk = EdgeWalk::exact;
  SlopeForm form = SlopeForm::divide;
  ReciprocalUnit reciprocal;  // R_edge
  Register coordinate, s, h, uv, shade;
  Register x_step, h_step, f_diff, f_step, shade_step;
  int divides_per_edge = 0;
};
SetupStage prepare_setup(const Config& config, const Constants& constants);

// A vertex of a setup record, raw.
struct SetupVertex {
  std::int64_t x = 0, y = 0, h = 0, u = 0, v = 0;
  std::array<std::int64_t, 4> c{};
};
SetupVertex vertex_of(const SetupRecord& record, int i);

// False where the triangle has no area after snapping; then there is no record. Every number of the input is
// finite and s is within the scene's range (check_triangle in pipeline.hpp).
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
