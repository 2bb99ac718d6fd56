// SPDX-License-Identifier: Apache-2.0
// Clipping by 6-bit codes in the normalised view volume (B2, B6).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/transform.hpp"

namespace bitspan {

// The volume -limit_x s <= x <= limit_x s, -limit_y s <= y <= limit_y s, s_min <= s <= s_max. Limits above 1
// are a guard band around the picture.
struct ClipVolume {
  double limit_x = 1, limit_y = 1;
  double s_min = 1, s_max = 1000;
  std::optional<double> across{};  // of a parallel projection: in the place of s at the sides
};
// What bounds x and y of a vertex.
inline double bound(const ClipVertex& vertex, const ClipVolume& volume) {
  return volume.across.value_or(vertex.s);
}

enum ClipBit : std::uint8_t {
  clip_left = 1,
  clip_right = 2,
  clip_top = 4,
  clip_bottom = 8,
  clip_near = 16,
  clip_far = 32,
};

// Returns one bit per plane that the vertex lies beyond; 0 says that it is inside or on the boundary.
std::uint8_t outcode(const ClipVertex& vertex, const ClipVolume& volume);

// Replaces the polygon by its part inside the planes named in `planes` (Sutherland-Hodgman); it may become
// empty. New vertices interpolate attributes linearly in space. An edge is cut at the same point, bit
// for bit, from whichever side it is walked, so that neighbours stay neighbours.
void clip_polygon(std::vector<ClipVertex>& polygon, const ClipVolume& volume, std::uint8_t planes);

}  // namespace bitspan
