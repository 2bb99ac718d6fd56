// SPDX-License-Identifier: Apache-2.0
// Planar shadows: the points that shadows fall on, the errors of the source's matrices, and pictures.
#include "scene/planar_shadow.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "scene/demo.hpp"
#include "scene/shadow.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using Matrix = std::array<std::array<double, 4>, 4>;

Vec3 applied(const Matrix& m, const Vec3& p) {
  const std::array<double, 4> v{p.x, p.y, p.z, 1};
  std::array<double, 4> out{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 4; ++k) out[i] += m[i][k] * v[k];
  }
  return {out[0] / out[3], out[1] / out[3], out[2] / out[3]};
}
void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

constexpr Plane ground{{0, 0, 0}, {0, 0, 1}};
constexpr Vec3 light{3, -2, 8}, point{1, 2, 2};

// (11): x5 = (xs zp - xp zs) / (zp - zs), y5 alike. The point lies on the line from the light, and on the
// plane.
TEST(PlanarShadow, FallsWhereTheLineMeetsThePlane) {
  const Vec3 s = shadow_of(point, {light}, ground);
  expect_near(s, {(3.0 * 2 - 1 * 8) / (2 - 8), (-2.0 * 2 - 2 * 8) / (2 - 8), 0});
  // (6): x5 = xp - zp xs / zs.
  expect_near(shadow_of(point, {light, 0}, ground), {1 - 2 * 3.0 / 8, 2 + 2 * 2.0 / 8, 0});
  // Any plane.
  const Plane slope{{1, 1, 1}, {1, 2, 3}};
  const Vec3 there = shadow_of(point, {light}, slope);
  EXPECT_NEAR(height(slope, there), 0, 1e-12);
  EXPECT_NEAR(length(cross(there - light, point - light)), 0, 1e-12);
}

// The matrix (7) as printed leaves z as it was; (12) has the light's y in the row of z. Corrected, both agree
// with shadow_of.
TEST(PlanarShadow, TheMatricesOfTheSourceAreNotCopied) {
  const double xs = light.x, ys = light.y, zs = light.z;
  const Matrix printed7{{{1, 0, -xs / zs, 0}, {0, 1, -ys / zs, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  Matrix corrected7 = printed7;
  corrected7[2] = {0, 0, 0, 0};
  EXPECT_EQ(applied(printed7, point).z, point.z);
  expect_near(applied(corrected7, point), shadow_of(point, {light, 0}, ground));
  const Matrix printed12{{{-zs, 0, xs, 0}, {0, -zs, 0, 0}, {0, 0, -ys, 0}, {0, 0, 1, -zs}}};
  const Matrix corrected12{{{-zs, 0, xs, 0}, {0, -zs, ys, 0}, {0, 0, 0, 0}, {0, 0, 1, -zs}}};
  EXPECT_NE(applied(printed12, point).z, 0);
  EXPECT_NE(applied(printed12, point).y, shadow_of(point, {light}, ground).y);
  expect_near(applied(corrected12, point), shadow_of(point, {light}, ground));
}

// Only what lies between the plane and the light throws a shadow.
TEST(PlanarShadow, CutsWhatLiesBelowThePlaneOrAboveTheLight) {
  Face face;
  face.corner[0].position = {0, 0, -2};
  face.corner[1].position = {1, 0, 2};
  face.corner[2].position = {0, 1, 2};
  const std::vector<Face> half = flattened({&face, 1}, {{0, 0, 8}}, ground);
  EXPECT_EQ(half.size(), 2U);
  for (const Face& part : half) {
    for (const Corner& corner : part.corner) EXPECT_NEAR(corner.position.z, 0, 1e-12);
  }
  // What lies in the plane is what shadows fall on.
  Face floor = face;
  for (Corner& corner : floor.corner) corner.position.z = 1e-9;
  EXPECT_TRUE(flattened({&floor, 1}, {{0, 0, 8}}, ground, 1e-6).empty());
  for (Corner& corner : face.corner) corner.position.z = 9;
  EXPECT_TRUE(flattened({&face, 1}, {{0, 0, 8}}, ground).empty());
  EXPECT_FALSE(flattened({&face, 1}, {{0, 0, 8}, 0}, ground).empty());
  EXPECT_TRUE(flattened({&face, 1}, {{0, 0, -8}}, ground).empty());
}

TEST(PlanarShadow, RefusesWhatItCannotDraw) {
  Scene scene = floor_scene(64, 48);
  const PlanarLight one{{0, -10, 20}};
  const std::vector<PlanarLight> many(planar_light_limit + 1, one);
  const Plane plane{{0, 7, 0}, {0, -1, 0}};
  EXPECT_THROW(with_planar_shadows(scene, {}, {}, plane, 0.5, 0.1), InputError);
  EXPECT_THROW(with_planar_shadows(scene, {}, many, plane, 0.5, 0.1), InputError);
  EXPECT_THROW(with_planar_shadows(scene, {}, {&one, 1}, {{}, {}}, 0.5, 0.1), InputError);
  EXPECT_THROW(with_planar_shadows(scene, {}, {&one, 1}, plane, 1.5, 0.1), InputError);
  scene.commands.push_back({0, Target{1}});
  EXPECT_THROW(with_planar_shadows(scene, {}, {&one, 1}, plane, 0.5, 0.1), InputError);
}

// On the floor, and away from the shadow's edge, the flattened casters darken the pixels that the shadow map
// does. Each is darkened once, although two sides of the box lie over it.
TEST(PlanarShadow, EqualsTheShadowMapOnThePlane) {
  Config config = shipped_config("depth20");
  config.project = ProjectUnit::reciprocal;
  const std::vector<Face> faces = box_above_floor();
  const Scene scene = seen_scene(faces);
  // The light grazes the far end of the floor.
  const ShadowOptions lamp{.light = {-6, -8, 8}, .size = 2048, .bias = 8};
  ShadowOptions flat = lamp;
  flat.plane = Plane{{0, 4, 0}, {0, -1, 0}};
  const Frame plain = drawn(config, scene, "model");
  const Frame mapped = drawn(config, shadowed(scene, faces, lamp), "model");
  const Scene planar_scene = shadowed(scene, faces, flat);
  const Frame planar = drawn(config, planar_scene, "model");
  EXPECT_EQ(drawn(config, planar_scene, "golden").color, planar.color);
  const auto is_floor = [&](std::size_t at) {
    return plain.triangle[at] >= 0 && plain.triangle[at] < floor_triangles;
  };
  const auto is_dark = [&](const Frame& frame, std::size_t at) {
    return frame.color[4 * at + 1] + 2 < plain.color[4 * at + 1];
  };
  std::size_t darkened = 0, wrong = 0, lit = 0;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const auto at = static_cast<std::size_t>(y * scene.width + x);
      if (!is_floor(at) || !is_inner(scene, x, y, is_floor)) continue;
      if (!is_inner(scene, x, y, [&](std::size_t near) { return is_dark(planar, near); })) continue;
      ++(is_dark(planar, at) ? darkened : lit);
      wrong += is_dark(planar, at) != is_dark(mapped, at) ? 1U : 0U;
      // What is left is 0.35 of the colour, once.
      if (!is_dark(planar, at)) continue;
      EXPECT_NEAR(planar.color[4 * at], 0.35 * plain.color[4 * at], 1.5);
    }
  }
  EXPECT_GT(darkened, 100U);
  EXPECT_GT(lit, 2000U);
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace bitspan
