// SPDX-License-Identifier: Apache-2.0
// Numbered cameras: their names, how they spread, and that they see the scene that is there.
#include "scene/camera_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

TEST(CameraViews, ANameSplitsWhereItsEndIsANumber) {
  const auto is = [](const std::string& name, const std::string& scene, int camera) {
    const ViewName split = split_view(name);
    EXPECT_EQ(split.scene, scene) << name;
    EXPECT_EQ(split.camera, camera) << name;
  };
  is("spot.obj@3", "spot.obj", 3);
  is("a@b.obj@999999", "a@b.obj", 999'999);
  for (const std::string name : {"spot.obj", "@3", "a@", "a@0", "a@-1", "a@3x", "a@1000000", "a@b", ""}) {
    is(name, name, 0);
  }
  EXPECT_EQ(view_name("a", 7), "a@7");
  const TemporaryFolder folder;
  const std::string file = folder.write("real@3", "");
  is(file, file, 0);
}

// Each of n cameras has a cell of its own among n per angle, or nearly: no two are the same, and no side is
// left out.
TEST(CameraViews, CamerasSpreadOverAllSides) {
  std::array<int, 8> sides{};
  std::set<double> yaws;
  for (int number = 1; number <= 80; ++number) {
    Camera camera;
    set_camera(camera, number);
    yaws.insert(camera.yaw_degrees);
    ++sides[static_cast<std::size_t>(camera.yaw_degrees / 45)];
    EXPECT_GE(camera.pitch_degrees, -45);
    EXPECT_LE(camera.pitch_degrees, 65);
    EXPECT_GE(camera.closeness, 0.6);
    EXPECT_LE(camera.closeness, 1.1);
  }
  EXPECT_EQ(yaws.size(), 80U);
  for (const int side : sides) EXPECT_NEAR(side, 10, 2);
}

// The middle of what is seen stays where it was, whatever camera looks, and distances are as in space: a
// corner that both cameras see is as far from another in either.
TEST(CameraViews, AnotherCameraSeesTheSameBodies) {
  Scene scene = demo_scene(160, 120);
  scene.triangles.resize(1);
  Triangle& t = scene.triangles[0];
  t.texture = -1;
  const std::array<std::array<double, 3>, 3> corners{{{70, 50, 20}, {90, 55, 25}, {75, 70, 30}}};
  for (std::size_t i = 0; i < 3; ++i) {
    t.v[i].x = corners[i][0];
    t.v[i].y = corners[i][1];
    t.v[i].s = corners[i][2];
  }
  scene.s_min = 5;
  scene.s_max = 100;
  const auto sides = [](const Scene& s) {
    std::array<std::array<double, 3>, 3> p{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex& v = s.triangles.at(0).v[i];
      p[i] = {(v.x - s.width / 2.0) * v.s / s.focal, (v.y - s.height / 2.0) * v.s / s.focal, v.s};
    }
    std::array<double, 3> out{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& a = p[i];
      const auto& b = p[(i + 1) % 3];
      out[i] = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    }
    std::ranges::sort(out);
    return out;
  };
  const auto expected = sides(scene);
  for (int camera = 1; camera <= 20; ++camera) {
    const Scene seen = seen_from(scene, camera);
    EXPECT_EQ(seen.name, "demo@" + std::to_string(camera));
    ASSERT_EQ(seen.triangles.size(), 1U) << camera;
    const auto found = sides(seen);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-9 * expected[i]) << camera;
    EXPECT_NE(seen.triangles[0].v[0].x, t.v[0].x);
    for (const Vertex& v : seen.triangles[0].v) {
      EXPECT_GE(v.s, seen.s_min);
      EXPECT_LE(v.s, seen.s_max);
    }
  }
}

TEST(CameraViews, ASceneWithCommandsHasItsOwnCameraAlone) {
  Scene scene = demo_scene(32, 24);
  scene.commands.push_back({.before = 0, .what = Target{0}});
  expect_refusal([&] { seen_from(scene, 3); }, "without commands; leave @3 out");
}

}  // namespace
}  // namespace bitspan
