// SPDX-License-Identifier: Apache-2.0
// Stereo from a depth buffer against two cameras. docs/stereo.md.
#include "report/stereo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/engine.hpp"
#include "model/engine_model.hpp"
#include "scene/demo.hpp"
#include "scene/mesh.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Frame drawn(const Config& config, const Scene& scene) {
  const auto engine = make_model(config);
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  return engine->frame();
}
std::array<std::uint8_t, 3> at(const EyePicture& p, int x, int y) {
  const std::uint8_t* const c = p.rgba.data() + 4 * (static_cast<std::ptrdiff_t>(y) * p.width + x);
  return {c[0], c[1], c[2]};
}

// Upright rectangles of one colour each, whose parallax is a whole number of pixels: s = 2, 3, 6 of 2 .. 6
// with parallax 16 are 16, 8 and 0 pixels.
Scene cards() {
  Scene scene;
  scene.width = 96;
  scene.height = 32;
  scene.s_min = 2;
  scene.s_max = 12;
  scene.focal = 80;
  scene.background = {1, 2, 3};
  const auto card = [&](double x, double width, double s, std::array<double, 4> color) {
    const auto corner = [&](double u, double v) {
      Vertex out;
      out.x = x + u * width;
      out.y = 4 + 24 * v;
      out.s = s;
      out.c = color;
      return out;
    };
    scene.triangles.push_back({{corner(0, 0), corner(1, 0), corner(0, 1)}, -1});
    scene.triangles.push_back({{corner(1, 0), corner(1, 1), corner(0, 1)}, -1});
  };
  card(20, 60, 16.0 / 3, {1, 0, 0, 1});
  card(30, 30, 24.0 / 7, {0, 1, 0, 1});
  card(44, 8, 2, {0, 0, 1, 1});
  return scene;
}

TEST(Stereo, CardsMoveByWholePixels) {
  const Config config = shipped_config("depth20");
  const Scene scene = cards();
  const StereoOptions options{.parallax = 16};
  const Frame middle = drawn(config, scene);
  for (const Eye eye : {Eye::left, Eye::right}) {
    const Warped by_depth = warped(config, scene, middle, options, eye);
    const Frame by_camera = drawn(config, seen_by(scene, options, eye));
    const EyePicture camera{by_camera.width, by_camera.height, by_camera.color};
    // All but what a card uncovered: 8 columns beside each of two cards on 24 rows, of which the middle
    // picture knows nothing. They are filled with what is behind, which has one colour here.
    EXPECT_EQ(by_depth.picture.rgba, camera.rgba);
    EXPECT_EQ(by_depth.holes, 2U * 8 * 24);
    const int sign = eye == Eye::left ? 1 : -1;
    EXPECT_EQ(at(camera, 48 + sign * 16, 10), (std::array<std::uint8_t, 3>{0, 0, 255}));
    EXPECT_EQ(at(camera, 45 + sign * 8 - sign * 12, 10), (std::array<std::uint8_t, 3>{0, 255, 0}));
    EXPECT_EQ(at(camera, 50 - sign * 25 + sign * 4, 10), (std::array<std::uint8_t, 3>{255, 0, 0}));
  }
}

TEST(Stereo, TheZeroMovesBothPictures) {
  const Config config = shipped_config("depth20");
  const Scene scene = cards();
  for (const Eye eye : {Eye::left, Eye::right}) {
    const Scene far = seen_by(scene, {.parallax = 16}, eye);
    const Scene near = seen_by(scene, {.parallax = 16, .zero = StereoZero::near}, eye);
    for (std::size_t i = 0; i < far.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(near.triangles[i].v[k].x - far.triangles[i].v[k].x, eye == Eye::left ? -16 : 16);
      }
    }
    EXPECT_EQ(near.triangles[4].v[0].x, 44) << "the nearest stays";
  }
}

// Two cameras at a distance from each other see the same: X - b / 2, and the plane shifted by the parallax of
// s_max.
TEST(Stereo, IsThatOfTwoCameras) {
  const Scene scene = cards();
  const double parallax = 16;
  const double base = 2 * parallax * scene.s_max * scene.s_min / (scene.focal * (scene.s_max - scene.s_min));
  const Scene left = seen_by(scene, {.parallax = parallax}, Eye::left);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& v = scene.triangles[i].v[k];
      const double across = (v.x - 48) * v.s / scene.focal;
      const double seen = 48 + scene.focal * (across + base / 2) / v.s - scene.focal * base / 2 / scene.s_max;
      EXPECT_NEAR(left.triangles[i].v[k].x, seen, 1e-12);
    }
  }
}

// What both know is one pixel apart at most, by the rounding of x: each pixel of a camera's picture shows the
// triangle of its place in the other one, or of a neighbour.
TEST(Stereo, SpotFromItsDepthIsSpotFromTwoPlaces) {
  const Config config = shipped_config("depth20");
  ProjectReport report;
  MeshOptions options;
  options.width = 160;
  options.height = 120;
  options.project = {.cull = true, .clip_sides = false};
  const Scene scene = mesh_scene(read_mesh(source_path("tests/data/spot.obj")), options, report);
  const StereoOptions stereo{.parallax = 6};
  const Frame middle = drawn(config, scene);
  for (const Eye eye : {Eye::left, Eye::right}) {
    const Warped by_depth = warped(config, scene, middle, stereo, eye);
    const Frame camera = drawn(config, seen_by(scene, stereo, eye));
    EXPECT_GT(by_depth.holes, 50U);
    EXPECT_LT(by_depth.holes, 1500U);
    std::size_t alike = 0, apart = 0;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 1; x + 1 < camera.width; ++x) {
        const auto near = [&](int dx) {
          const auto a = at(by_depth.picture, x + dx, y);
          const auto b = at({camera.width, camera.height, camera.color}, x, y);
          int most = 0;
          for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
          return most <= 4;
        };
        (near(0) || near(-1) || near(1) ? alike : apart) += 1;
      }
    }
    EXPECT_LT(apart, by_depth.holes) << alike;
  }
}

TEST(Stereo, TwoPicturesBecomeOne) {
  const EyePicture left{2, 1, {1, 2, 3, 4, 5, 6, 7, 8}}, right{2, 1, {11, 12, 13, 14, 15, 16, 17, 18}};
  const EyePicture pair = joined(left, right, StereoLayout::pair);
  EXPECT_EQ(pair.width, 4);
  EXPECT_EQ(pair.rgba, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 15, 16, 17, 18}));
  const EyePicture anaglyph = joined(left, right, StereoLayout::anaglyph);
  EXPECT_EQ(anaglyph.width, 2);
  EXPECT_EQ(anaglyph.rgba, (std::vector<std::uint8_t>{1, 12, 13, 14, 5, 16, 17, 18}));
}

TEST(Stereo, PassesHaveNoTwoCameras) {
  EXPECT_TRUE(names(input_error([] { seen_by(mirror_scene(64, 48), {.parallax = 3}, Eye::left); }),
                    "--stereo: a scene in passes"));
}

}  // namespace
}  // namespace bitspan
