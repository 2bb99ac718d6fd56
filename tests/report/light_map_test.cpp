// SPDX-License-Identifier: Apache-2.0
// Light as a texture [L7] beside the light of the pixel [L1, B9]. docs/light.md.
#include "scene/light_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "engine/drawn_scene.hpp"
#include "model/engine_model.hpp"
#include "scene/mesh.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr const char* cube_obj =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

Scene seen(const std::string& path, const MeshOptions& options) {
  ProjectReport report;
  return mesh_scene(read_mesh(path), options, report);
}

Config config_of(bool by_unit) {
  Config c = shipped_config("depth20");
  if (by_unit) {
    c.light = LightAt::pixel;
    c.light_source = LightSource::point;
    c.light_fall = LightFall::second;
  } else {
    c.second_coordinates = SecondCoordinates::own;
  }
  return c;
}

// How many pixels of a plane differ by more than so many codes, lit by the unit and by a texture. [L7, L1,
// B9]
struct Apart {
  int worst = 0, covered = 0;
};
Apart apart(const std::string& plane, const Vec3& light, double reach, int side) {
  MeshOptions options;
  options.width = 160;
  options.height = 120;
  options.camera.distance = 3;
  options.light = LightOptions{
      .light = {.is_point = true, .place = {light.x, light.y, light.z}, .ambient = 0, .reach = reach},
      .by_unit = true};
  const auto drawn = [&](bool by_unit) {
    const Scene scene = seen(plane, options);
    const auto engine = make_model(config_of(by_unit));
    engine->begin(scene);
    draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
    return engine->frame();
  };
  const Frame by_unit = drawn(true);
  options.light.reset();
  options.light_map = LightMapOptions{.place = light, .reach = reach, .side = side};
  const Frame by_texture = drawn(false);
  Apart out;
  for (std::size_t i = 0; i < by_unit.depth.size(); ++i) {
    if (by_unit.triangle[i] < 0) continue;
    ++out.covered;
    out.worst = std::max(out.worst, std::abs(by_unit.color[3 * i] - by_texture.color[3 * i]));
  }
  return out;
}

TEST(LightMap, IsTheLightOfThePixel) {
  const TemporaryFolder folder;
  // Normals of each of the source's three cases.
  const std::string planes[] = {folder.write("y.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3 4\n"),
                                folder.write("z.obj", "v 1 -1 0\nv -1 -1 0\nv -1 1 0\nv 1 1 0\nf 1 2 3 4\n"),
                                folder.write("x.obj", "v 0 -1 -1\nv 0 -1 1\nv 0 1 1\nv 0 1 -1\nf 4 3 2 1\n"),
                                folder.write("xyz.obj", "v 1 0 0\nv 0 1 0\nv 0 0 -1\nf 1 3 2\n")};
  const Vec3 above[] = {{0.25, 0.5, 0.125}, {0.25, 0.125, -0.5}, {0.5, 0.25, -0.125}, {0.75, 0.75, -0.75}};
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < std::size(planes); ++i) {
    for (const double reach : {0.5, 0.75}) {
      const Apart found = apart(planes[i], above[i], reach, 256);
      EXPECT_LE(found.worst, 2) << i << ", " << reach;
      drawn += found.covered > 500 ? 1U : 0U;
    }
  }
  EXPECT_EQ(drawn, 2 * std::size(planes));
}

TEST(LightMap, ALargerTextureIsCloser) {
  const TemporaryFolder folder;
  const std::string plane = folder.write("y.obj", "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3 4\n");
  const auto worst = [&](int side) { return apart(plane, {0.25, 0.3, 0.125}, 0.3, side).worst; };
  EXPECT_GT(worst(8), worst(32));
  EXPECT_GT(worst(32), worst(256));
}

TEST(LightMap, WhatTheLightDoesNotSeeIsBlack) {
  const TemporaryFolder folder;
  const std::string path = folder.write("cube.obj", cube_obj);
  MeshOptions options;
  options.light_map = LightMapOptions{.place = {0, 5, 0}};
  std::set<double> colors;
  for (const Triangle& t : seen(path, options).triangles) {
    for (const Vertex& v : t.v) colors.insert(v.c[0]);
  }
  EXPECT_EQ(colors.size(), 2U);
  EXPECT_EQ(*colors.begin(), 0);
}

TEST(LightMap, TheTextureIsEta) {
  const Texture t = light_texture(256);
  const auto code = [&](int i, int j) { return t.rgba[4 * static_cast<std::size_t>(256 * j + i)]; };
  EXPECT_EQ(code(127, 127), 255);
  EXPECT_EQ(code(128, 127), 255);
  EXPECT_EQ(code(0, 128), 1);
  EXPECT_EQ(code(255, 127), 1);
  // 0.01 at 4.53 G [L7], where G is 20.3.
  EXPECT_EQ(code(127 + 92, 127), 3);
  for (int i = 0; i < 256; ++i) {
    for (int j = 0; j < 256; ++j) ASSERT_EQ(code(i, j), code(255 - j, i));
  }
}

TEST(LightMap, RefusesWhatIsNoLight) {
  std::vector<Face> none;
  for (const LightMapOptions& options :
       {LightMapOptions{.place = {NAN, 0, 0}}, LightMapOptions{.place = {}, .reach = 0},
        LightMapOptions{.place = {}, .side = 1}}) {
    EXPECT_TRUE(names(input_error([&] { map_light(none, options); }), "light map: "));
  }
}

}  // namespace
}  // namespace bitspan
