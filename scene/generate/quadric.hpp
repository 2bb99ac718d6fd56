// SPDX-License-Identifier: Apache-2.0
// Quadric bodies as triangles: parameters in, a mesh and the form that it comes from out. docs/geometry.md,
// "Quadrics". [V2]
//
// A body has an axis through its centre. At height y along it, its section is an ellipse with the radii
// a r(y) and c r(y), where r(y) is 1 of a cylinder, y / b of a cone, the square root of 1 - (y / b)^2 of an
// ellipsoid, of y / b of a paraboloid, of 1 + (y / b)^2 of a hyperboloid of one sheet, and of (y / b)^2 - 1
// of one of two sheets.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "config/names.hpp"
#include "scene/geometry.hpp"
#include "scene/mesh_file.hpp"
#include "scene/quadric_form.hpp"

namespace bitspan {

BITSPAN_ENUM(QuadricShape, sphere, ellipsoid, cylinder, cone, paraboloid, hyperboloid, hyperboloid_two);

struct QuadricBody {
  QuadricShape shape = QuadricShape::sphere;
  std::array<double, 3> radii{1, 1, 1};  // a, b, c; of a sphere all the same
  std::optional<double> from{}, to{};    // heights between which the body is; a whole ellipsoid needs none
  bool caps = true;                      // flat faces where it is cut
  Vec3 centre{}, axis{0, 1, 0};          // the axis of any length
  std::array<double, 4> color{1, 1, 1, 1};
  int steps = 32;  // around the axis
  std::optional<int>
      rows{};  // along it, per sheet; 1 where sections run straight, else half as many as steps
};
inline constexpr int quadric_steps_least = 3, quadric_steps_limit = 4096;
inline constexpr std::size_t quadric_triangles_limit = 20'000'000;  // of all bodies of a scene

// Why a body is not legal: "radii: ..."; empty where it is.
std::string body_fault(const QuadricBody& body);
// How many triangles a legal body has at most.
std::size_t most_triangles(const QuadricBody& body);

struct QuadricMesh {
  std::vector<MeshTriangle> triangles;
  MeshQuadric quadric;  // of these triangles
};
// All vertices lie on the body, and corners that are one have the same bits; so there is no crack. Corners
// have normals of length 1, and u, v: around the axis and along it. f of the quadric is r^2 of a point less
// r(y)^2, so that it has no unit. Throws InputError where the body is not legal.
QuadricMesh tessellated(const QuadricBody& body);

}  // namespace bitspan
