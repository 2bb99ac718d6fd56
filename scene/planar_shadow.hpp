// SPDX-License-Identifier: Apache-2.0
// Planar shadows [SH3]: the casters, flattened onto a plane away from a light, darken what lies in the plane.
// A pass plan; docs/shadow.md.
#pragma once

#include <span>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// A light at `place`; with w = 0 it is infinitely far, in that direction.
struct PlanarLight {
  Vec3 place;
  double w = 1;
};

// The point of the plane that a point's shadow falls on. [SH3, (6) and (11), for any plane]
Vec3 shadow_of(const Vec3& p, const PlanarLight& light, const Plane& plane);

// What of the faces lies between the plane and the light, which is on its normal's side, projected from the
// light onto the plane. Each face becomes a fan of at most 3 triangles, without texture. What lies no more
// than `thickness` above the plane is the plane's, and throws no shadow.
std::vector<Face> flattened(std::span<const Face> faces, const PlanarLight& light, const Plane& plane,
                            double thickness = 0);

inline constexpr int planar_light_limit = 7;  // one bit of the stencil plane is the surface's

// The scene with the shadows that its lights throw onto a plane: a pass that draws it and marks, by the
// stencil, where it shows the plane; and one per light that darkens each such pixel at most once, to the
// share `dark` of its colour. All is in the viewer's space. Triangles whose corners lie in the plane but for
// `thickness` are its surface. Throws InputError for a scene with commands, and for 0 or more than
// planar_light_limit lights.
Scene with_planar_shadows(Scene scene, std::span<const Face> casters, std::span<const PlanarLight> lights,
                          const Plane& plane, double dark, double thickness);

}  // namespace bitspan
