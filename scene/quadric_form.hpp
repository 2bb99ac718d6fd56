// SPDX-License-Identifier: Apache-2.0
// The form of a quadric at points of space, and as a viewer sees it. [V2]
#pragma once

#include "scene/geometry.hpp"
#include "scene/quadric.hpp"
#include "scene/transform.hpp"

namespace bitspan {

// f of a point, and its gradient there.
double value_at(const Quadric& quadric, const Vec3& p);
Vec3 gradient_at(const Quadric& quadric, const Vec3& p);

// A quadric of a mesh. Its forms are of p - origin, so that a body far from 0 keeps its digits.
struct MeshQuadric : Quadric {
  Vec3 origin{};
};
// The same in the space of a viewer, as a scene has it: x to the right, y downward, z along the view axis.
Quadric seen_by(const MeshQuadric& quadric, const Viewpoint& view);

}  // namespace bitspan
