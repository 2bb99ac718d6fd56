// SPDX-License-Identifier: Apache-2.0
// Geometry before projection: what meshes and the demo are made of.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/attributes.hpp"

namespace bitspan {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  bool operator==(const Vec3&) const = default;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(const Vec3& a, double k) { return {a.x * k, a.y * k, a.z * k}; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double radians(double degrees) { return degrees * std::numbers::pi / 180; }
inline double length(const Vec3& a) { return std::hypot(a.x, a.y, a.z); }

// All points p with dot(normal, p - point) = 0.
struct Plane {
  Vec3 point, normal;
};
inline double height(const Plane& plane, const Vec3& p) { return dot(plane.normal, p - plane.point); }

struct WorldPoint {
  Vec3 position;
};
// A corner of a face.
struct Corner : WorldPoint, Attributes {};

// Of length 1; of length 0 where x is, or where a part of it is not finite.
inline Vec3 of_length_1(const Vec3& x) {
  // In front of the squares, which may leave the doubles.
  const double largest = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  if (!(largest > 0) || !std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) return {};
  const Vec3 y{x.x / largest, x.y / largest, x.z / largest};
  return y * (1 / length(y));
}
inline Vec3 normal_of(const Attributes& a) { return {a.nx, a.ny, a.nz}; }
inline void set_normal(Attributes& a, const Vec3& n) {
  a.nx = n.x;
  a.ny = n.y;
  a.nz = n.z;
}

// Corners run counter-clockwise seen from outside.
struct Face {
  std::array<Corner, 3> corner;
  int texture = -1;        // index into the textures that come with the faces, -1 for none
  bool two_sided = false;  // never removed as a back face
};

}  // namespace bitspan
