// SPDX-License-Identifier: Apache-2.0
// Where a node of a mesh file places its children and its meshes.
#pragma once

#include <array>

#include "scene/geometry.hpp"

namespace bitspan {

// x' = linear x + offset; `linear` column by column.
struct Affine {
  std::array<Vec3, 3> linear{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 offset{};

  Vec3 direction(const Vec3& p) const { return linear[0] * p.x + linear[1] * p.y + linear[2] * p.z; }
  Vec3 point(const Vec3& p) const { return direction(p) + offset; }
  // Whether a triangle's front becomes its back.
  bool mirrors() const { return dot(linear[0], cross(linear[1], linear[2])) < 0; }
  // Of a surface; its length is not kept. The front stays in front.
  Vec3 normal(const Vec3& n) const {
    const Vec3 turned = cross(linear[1], linear[2]) * n.x + cross(linear[2], linear[0]) * n.y +
                        cross(linear[0], linear[1]) * n.z;
    return mirrors() ? turned * -1 : turned;
  }
};

// b first.
inline Affine operator*(const Affine& a, const Affine& b) {
  return {{a.direction(b.linear[0]), a.direction(b.linear[1]), a.direction(b.linear[2])}, a.point(b.offset)};
}

}  // namespace bitspan
