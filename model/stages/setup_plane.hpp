// SPDX-License-Identifier: Apache-2.0
// setup, where rows start from the triangle's plane (slope.row = plane): its numerators at the vertices and
// its gradients. docs/numeric-spec.md, "setup_plane".
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/setup.hpp"

namespace bitspan::model {

struct SetupPlaneStage {
  Perspective perspective = Perspective::delta_f;
  SlopeForm form = SlopeForm::divide;
  ReciprocalUnit reciprocal;  // R_edge, of the area
  int subpixel_bits = 0;
  Exact b;
  Register vertex_h, vertex_uv, vertex_shade;  // formats of the setup record
  Register uv, g, h_grad, g_grad, shade_grad;
  int divides_per_plane = 0;
};
SetupPlaneStage prepare_setup_plane(const Config& config, const Constants& constants);

// A triangle's plane as span_setup takes it.
struct TrianglePlane {
  SetupPlaneRecord record;
  SetupVertex origin;  // vertex 0
};

// setup: of a triangle that has an area. Each costs stage.divides_per_plane divides.
template <class Watch = NoObserve>
TrianglePlane setup_plane(const SetupPlaneStage& stage, const SetupRecord& setup, Watch watch = {});

}  // namespace bitspan::model
