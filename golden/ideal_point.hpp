// SPDX-License-Identifier: Apache-2.0
// A surface without quantisation, at a point of the picture; docs/numeric-spec.md, "ideal".
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "config/config.hpp"
#include "golden/surface.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// The surface's values at a point of the picture.
struct IdealPoint {
  double x = 0, y = 0;              // pixels
  double h = 0;                     // depth code D1, of hmax = 2^depth.bits - 1
  double s = 0;                     // distance, in the scene's unit
  double u = 0, v = 0;              // texels
  std::array<double, 4> shade{};    // red, green, blue, alpha, 0..1; linear as perspective.shades says
  Attributes given;                 // of given_attributes, linear on the screen
  std::array<double, 3> project{};  // X, Y and W of given_attributes, linear in space
  double u2 = 0, v2 = 0;            // the same
  double line = 0;                  // what the depth code is of: h, or the line z
  double brightness = 1;            // at vertices, and linear between them; where light.at is face or vertex
};

// Where a point lies in the texture of the scene's projector, and its depth code from there.
struct IdealProjection {
  double s = 0, t = 0;  // texels
  double w = 0;         // the distance along the projector's axis, in the scene's unit
  double h = 0;         // depth code D1
  double z = 0;         // the configured depth code, in front of the bias
};
// None behind the projector, and in a scene without one.
std::optional<IdealProjection> ideal_projection(const Config& config, const Scene& scene,
                                                const IdealPoint& point);

// Returns the values anywhere on the triangle's plane in front of the eye.
IdealPoint ideal_point(const Config& config, const Scene& scene, const IdealTriangle& triangle, double x,
                       double y);
// Returns the values where edge (0: vertex 0 to 2, 1: 0 to 1, 2: 1 to 2) crosses the centre of row y; the
// edge has height.
IdealPoint ideal_on_edge(const Config& config, const Scene& scene, const IdealTriangle& triangle, int edge,
                         std::int64_t y);
// Returns the values at vertex 0, 1 or 2.
IdealPoint ideal_at_vertex(const Config& config, const Scene& scene, const IdealTriangle& triangle,
                           int vertex);

}  // namespace bitspan
