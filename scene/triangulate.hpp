// SPDX-License-Identifier: Apache-2.0
// Polygons in space, cut into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/geometry.hpp"

namespace bitspan {

// A reader refuses a face with more corners: the time grows with their square in the worst case, to seconds.
inline constexpr std::size_t polygon_corners_max = 32768;

// Cuts a polygon of n >= 3 finite corners into n - 2 triangles, whose corners are appended as indices into
// `polygon`; each runs the way that the polygon runs. The polygon is seen along the axis from which its
// area is largest, and decisions there are exact. Concave polygons are legal, and holes that bridges join to
// the outline: edges run there and back. Of a polygon that crosses itself, or has no area, come n - 2
// triangles, too, some of which may be turned or have no area; signed areas sum to the polygon's always.
// A convex polygon becomes a fan around its first corner.
void triangulate(std::span<const Vec3> polygon, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace bitspan
