// SPDX-License-Identifier: Apache-2.0
// Relief textures [T15]: where a light stands in the field of a map of normals. docs/light.md.
#pragma once

#include <span>

#include "scene/light.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Gives corners lx, ly and lz of a light at that place, both in the coordinates of the mesh; u2 and v2 of the
// corners are texels of the map. The foot of the light on the tangent plane of a corner is its column and
// row, and its height there is scaled by texels per unit of length, as the columns are. So a flat face has
// one place for all corners. A map that is stretched more along one side than along the other has the mean of
// both.
void give_relief(std::span<Face> faces, const Vec3& light);

// How the second texture unit takes the map.
StateChange relief_state();

}  // namespace bitspan
