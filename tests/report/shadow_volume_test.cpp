// SPDX-License-Identifier: Apache-2.0
// Shadow volumes: what the stencil counts against segments from the light, and pictures against the other
// ways to a shadow.
#include "scene/shadow_volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/random.hpp"
#include "scene/shadow.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr int surface = 128;
constexpr double dark = 0.5;

struct Tally {
  std::size_t lit = 0, dark = 0, wrong = 0;
};
// Where a pixel and its neighbours show the same face and have as many faces between them and the light, the
// stencil has counted those. The faces are small enough that no clipping tells scene triangles from them.
Tally counted(const Config& config, const std::vector<Face>& faces, const Vec3& light) {
  const Scene scene = seen_scene(faces);
  const Frame plain = drawn(config, scene, "model");
  const Scene plan = with_shadow_volumes(scene, faces, light, dark);
  const Frame frame = drawn(config, plan, "model");
  EXPECT_EQ(drawn(config, plan, "golden").stencil, frame.stencil);
  // Per scene triangle its face.
  std::vector<std::int32_t> face_of;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<Triangle> made;
    ProjectReport report;
    project({&faces[f], 1}, viewer_of(scene), {.cull = false}, made, report);
    face_of.insert(face_of.end(), made.size(), static_cast<std::int32_t>(f));
  }
  const auto seen = [&](std::size_t at) {
    return plain.triangle[at] < 0 ? -1 : face_of[static_cast<std::size_t>(plain.triangle[at])];
  };
  // Of the pixel's middle; -2 where a corner of the pixel has another number.
  const auto expected = [&](std::size_t at) {
    const std::int32_t face = seen(at);
    if (face < 0) return -1;
    const double x = static_cast<double>(at % static_cast<std::size_t>(scene.width)) + 0.5;
    const double y = static_cast<double>(at / static_cast<std::size_t>(scene.width)) + 0.5;
    const auto between = [&](double right, double down) {
      const Face& shown = faces[static_cast<std::size_t>(face)];
      return faces_between(faces, light, point_at(scene, shown, x + right, y + down), face);
    };
    const int middle = between(0, 0);
    for (const double right : {-0.5, 0.5}) {
      for (const double down : {-0.5, 0.5}) {
        if (between(right, down) != middle) return -2;
      }
    }
    return middle;
  };
  std::vector<int> wanted;
  for (std::size_t at = 0; at < plain.triangle.size(); ++at) wanted.push_back(expected(at));
  Tally out;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const auto at = static_cast<std::size_t>(y * scene.width + x);
      if (!is_inner(scene, x, y, seen)) continue;
      if (!is_inner(scene, x, y, [&](std::size_t near) { return wanted[near]; })) continue;
      if (wanted[at] == -2) continue;
      if (wanted[at] == -1) {
        out.wrong += frame.stencil[at] >= surface ? 1U : 0U;
        EXPECT_EQ(frame.color[4 * at], plain.color[4 * at]);
        continue;
      }
      // The face's own body has it at its end, where it does not count, or does where the light is behind.
      const int count = frame.stencil[at] - surface;
      const bool is_dark = wanted[at] > 0;
      ++(is_dark ? out.dark : out.lit);
      const int own = is_lit_from_behind(faces[static_cast<std::size_t>(seen(at))], light) ? 1 : 0;
      if (count != wanted[at] + own) ++out.wrong;
    }
  }
  return out;
}

TEST(ShadowVolume, CountsTheFacesBetweenTheLightAndAPoint) {
  const Config config = shipped_config("depth20");
  Random random(20261127);
  Tally all;
  for (int turn = 0; turn < 12; ++turn) {
    std::vector<Face> faces = box_above_floor();
    faces.resize(floor_triangles);
    const int more = static_cast<int>(random.integer(1, 12));
    for (int i = 0; i < more; ++i) {
      Face& face = faces.emplace_back();
      const Vec3 middle{random.uniform(-4, 4), random.uniform(-3, 3), random.uniform(8, 24)};
      for (Corner& corner : face.corner) {
        corner.position = middle + Vec3{random.uniform(-2, 2), random.uniform(-1, 1), random.uniform(-2, 2)};
        corner.c = {0.5, 0.5, 0.5, 1};
      }
    }
    // Now and then behind the viewer, or far beside what is seen.
    const Vec3 light{random.uniform(-12, 12), random.uniform(-20, -3), random.uniform(-10, 40)};
    const Tally one = counted(config, faces, light);
    all.lit += one.lit;
    all.dark += one.dark;
    all.wrong += one.wrong;
    EXPECT_EQ(one.wrong, 0U) << "turn " << turn;
  }
  EXPECT_GT(all.lit, 40000U);
  EXPECT_GT(all.dark, 250U);
}

// The eye may be in the shadow, or in a body.
TEST(ShadowVolume, TheEyeMayLieInAShadow) {
  std::vector<Face> faces = box_above_floor();
  Face& roof = faces.emplace_back();
  roof.corner[0].position = {-30, -3, -20};
  roof.corner[1].position = {30, -3, -20};
  roof.corner[2].position = {0, -3, 15};
  for (Corner& corner : roof.corner) corner.c = {1, 1, 1, 1};
  const Tally one = counted(shipped_config("depth20"), faces, {1, -9, 3});
  EXPECT_EQ(one.wrong, 0U);
  EXPECT_GT(one.dark, 4000U);
}

TEST(ShadowVolume, EqualsThePlanarShadowOnThePlane) {
  const Config config = shipped_config("depth16");
  const std::vector<Face> faces = box_above_floor();
  const Scene scene = seen_scene(faces);
  ShadowOptions options{.light = {-6, -8, 8}, .dark = dark};
  options.plane = Plane{{0, 4, 0}, {0, -1, 0}};
  const Frame planar = drawn(config, shadowed(scene, faces, options), "model");
  options.plane.reset();
  options.volumes = true;
  const Frame frame = drawn(config, shadowed(scene, faces, options), "model");
  const Frame plain = drawn(config, scene, "model");
  const auto is_floor = [&](std::size_t at) {
    return plain.triangle[at] >= 0 && plain.triangle[at] < floor_triangles;
  };
  const auto is_dark = [&](std::size_t at) { return planar.color[4 * at] + 2 < plain.color[4 * at]; };
  std::size_t darkened = 0, wrong = 0;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const auto at = static_cast<std::size_t>(y * scene.width + x);
      if (!is_floor(at) || !is_inner(scene, x, y, is_floor) || !is_inner(scene, x, y, is_dark)) continue;
      darkened += is_dark(at) ? 1U : 0U;
      for (std::size_t c = 0; c < 4; ++c)
        wrong += planar.color[4 * at + c] != frame.color[4 * at + c] ? 1U : 0U;
    }
  }
  EXPECT_GT(darkened, 100U);
  EXPECT_EQ(wrong, 0U);
}

TEST(ShadowVolume, RefusesWhatItCannotDraw) {
  const std::vector<Face> faces = box_above_floor();
  Scene scene = seen_scene(faces);
  ShadowOptions both{.light = {1, 2, 3}};
  both.plane = Plane{{0, 4, 0}, {0, -1, 0}};
  both.volumes = true;
  EXPECT_THROW(shadowed(scene, faces, both), InputError);
  // A light in the plane of the only face sees it edge on.
  const std::vector<Face> floor(faces.begin(), faces.begin() + 1);
  EXPECT_TRUE(shadow_volumes(floor, {3, 4, 50}, scene).empty());
  EXPECT_TRUE(with_shadow_volumes(scene, floor, {3, 4, 50}, dark).commands.empty());
  EXPECT_TRUE(with_shadow_volumes(Scene{}, faces, {}, dark).commands.empty());
  scene.commands.push_back({0, Target{1}});
  EXPECT_THROW(with_shadow_volumes(scene, faces, {1, 2, 3}, dark), InputError);
}

}  // namespace
}  // namespace bitspan
