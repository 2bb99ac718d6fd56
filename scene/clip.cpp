// SPDX-License-Identifier: Apache-2.0
#include "scene/clip.hpp"

#include <algorithm>
#include <array>

namespace bitspan {
namespace {

constexpr std::array<ClipBit, 6> all_planes{clip_near,  clip_far, clip_left,
                                            clip_right, clip_top, clip_bottom};

// Returns how far the vertex is inside the plane: positive inside, zero on the plane, negative beyond.
double distance(const ClipVertex& p, const ClipVolume& volume, ClipBit plane) {
  switch (plane) {
    case clip_left:
      return p.x + volume.limit_x * bound(p, volume);
    case clip_right:
      return volume.limit_x * bound(p, volume) - p.x;
    case clip_top:
      return p.y + volume.limit_y * bound(p, volume);
    case clip_bottom:
      return volume.limit_y * bound(p, volume) - p.y;
    case clip_near:
      return p.s - volume.s_min;
    case clip_far:
      return volume.s_max - p.s;
  }
  return 0;
}

// Returns the point of the edge on the plane. t runs from the inner vertex, whichever way the edge is walked.
ClipVertex cut(const ClipVertex& inner, const ClipVertex& outer, const ClipVolume& volume, ClipBit plane) {
  const double inside = distance(inner, volume, plane);
  const double t = inside / (inside - distance(outer, volume, plane));
  ClipVertex p{{mix(inner.x, outer.x, t), mix(inner.y, outer.y, t), mix(inner.s, outer.s, t)},
               mix(inner, outer, t)};
  // Onto the plane exactly, so that rounding leaves no vertex beyond it.
  switch (plane) {
    case clip_left:
      p.x = -volume.limit_x * bound(p, volume);
      break;
    case clip_right:
      p.x = volume.limit_x * bound(p, volume);
      break;
    case clip_top:
      p.y = -volume.limit_y * bound(p, volume);
      break;
    case clip_bottom:
      p.y = volume.limit_y * bound(p, volume);
      break;
    case clip_near:
      p.s = volume.s_min;
      break;
    case clip_far:
      p.s = volume.s_max;
      break;
  }
  return p;
}

}  // namespace

std::uint8_t outcode(const ClipVertex& vertex, const ClipVolume& volume) {
  unsigned code = 0;
  for (const ClipBit plane : all_planes) {
    if (distance(vertex, volume, plane) < 0) code |= plane;
  }
  return static_cast<std::uint8_t>(code);
}

void clip_polygon(std::vector<ClipVertex>& polygon, const ClipVolume& volume, std::uint8_t planes) {
  std::vector<ClipVertex> result;
  // Near first: beyond it s <= 0 is possible, where the side planes mean nothing.
  for (const ClipBit plane : all_planes) {
    if ((planes & plane) == 0) continue;
    result.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const ClipVertex& a = polygon[i];
      const ClipVertex& b = polygon[(i + 1) % polygon.size()];
      const double da = distance(a, volume, plane);
      const double db = distance(b, volume, plane);
      if (da >= 0) result.push_back(a);
      if (da > 0 && db < 0) result.push_back(cut(a, b, volume, plane));
      if (da < 0 && db > 0) result.push_back(cut(b, a, volume, plane));
    }
    std::swap(polygon, result);
  }
}

}  // namespace bitspan
