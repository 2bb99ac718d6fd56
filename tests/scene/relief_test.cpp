// SPDX-License-Identifier: Apache-2.0
// Where a light stands in the field of a map of normals [T15].
#include "scene/relief.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "scene/geometry.hpp"

namespace bitspan {
namespace {

// A face in any position, whose texels are `scale` to a unit of length, turned by `turn` and perhaps
// mirrored.
struct Placed {
  Face face;
  Vec3 u_axis, v_axis, normal;
};
Placed placed(std::mt19937_64& random, double scale, bool is_mirrored) {
  std::uniform_real_distribution<double> any(-3, 3);
  Placed out;
  out.u_axis = of_length_1({any(random), any(random), any(random)});
  out.normal = of_length_1(cross(out.u_axis, {any(random), any(random), any(random)}));
  out.v_axis = cross(out.normal, out.u_axis) * (is_mirrored ? -1 : 1);
  for (Corner& corner : out.face.corner) corner.position = {any(random), any(random), any(random)};
  // Into the plane through the first corner, and counterclockwise seen from the normal's side.
  for (Corner& corner : out.face.corner) {
    const Vec3 from = corner.position - out.face.corner[0].position;
    corner.position = corner.position - out.normal * dot(out.normal, from);
    corner.u2 = 100 + scale * dot(out.u_axis, from);
    corner.v2 = -30 + scale * dot(out.v_axis, from);
  }
  if (dot(area_vector(out.face), out.normal) < 0) std::swap(out.face.corner[1], out.face.corner[2]);
  return out;
}
Vec3 in_field(const Corner& c, double height_scale = 1) {
  return of_length_1({c.lx - c.u2, c.ly - c.v2, c.lz * height_scale});
}

TEST(Relief, TheFieldSeesTheLightAsTheFaceDoes) {
  std::mt19937_64 random(7);
  for (int n = 0; n < 200; ++n) {
    const double scale = std::ldexp(1, n % 9);
    Placed at = placed(random, scale, n % 2 == 1);
    if (length(area_vector(at.face)) < 0.5) continue;
    const Vec3 light = at.face.corner[0].position + at.normal * 2 + at.u_axis * 1.5 - at.v_axis;
    give_relief({&at.face, 1}, light);
    for (const Corner& c : at.face.corner) {
      const Vec3 to = of_length_1(light - c.position);
      const Vec3 expected{dot(at.u_axis, to), dot(at.v_axis, to), dot(at.normal, to)};
      EXPECT_LT(length(in_field(c) - expected), 1e-9) << n;
      // One place for the whole face.
      EXPECT_NEAR(c.lx, at.face.corner[0].lx, 1e-8 * scale);
      EXPECT_NEAR(c.lz, 2 * scale, 1e-8 * scale);
      // The source leaves the height in units of length, beside columns in texels: the light is then too low.
      if (scale >= 4) {
        EXPECT_GT(length(in_field(c, 1 / scale) - expected), 0.05) << n;
      }
    }
  }
}

TEST(Relief, ASmoothBodyHasTheTangentPlaneOfEachCorner) {
  std::mt19937_64 random(8);
  Placed at = placed(random, 16, false);
  const Vec3 tilted = of_length_1(at.normal + at.u_axis * 0.25);
  set_normal(at.face.corner[1], tilted);
  const Vec3 light = at.face.corner[1].position + tilted * 3;
  give_relief({&at.face, 1}, light);
  const Corner& c = at.face.corner[1];
  EXPECT_NEAR(c.lx, c.u2, 1e-9);  // straight above that corner
  EXPECT_NEAR(c.ly, c.v2, 1e-9);
  EXPECT_NEAR(c.lz, 48, 1e-9);
}

TEST(Relief, AFaceWithoutCoordinatesHasNoDirection) {
  Face face;
  face.corner[1].position = {1, 0, 0};
  face.corner[2].position = {0, 1, 0};
  give_relief({&face, 1}, {0, 0, 1});
  for (const Corner& c : face.corner) EXPECT_EQ(in_field(c), Vec3{});
  // And one without an area.
  face.corner[2].position = {2, 0, 0};
  face.corner[1].u2 = 1;
  give_relief({&face, 1}, {0, 0, 1});
  for (const Corner& c : face.corner) EXPECT_TRUE(std::isfinite(c.lx) && std::isfinite(c.lz));
}

}  // namespace
}  // namespace bitspan
