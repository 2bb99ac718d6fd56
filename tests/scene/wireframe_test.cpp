// SPDX-License-Identifier: Apache-2.0
// The edges of a scene as lines.
#include "scene/wireframe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "scene/camera_views.hpp"
#include "scene/plan.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

Vertex at(double x, double y) {
  Vertex out;
  out.x = x;
  out.y = y;
  return out;
}

// A square of two triangles.
Scene square() {
  Scene scene;
  scene.name = "square";
  const Vertex a = at(0, 0), b = at(10, 0), c = at(10, 10), d = at(0, 10);
  scene.triangles = {{.v = {a, b, c}}, {.v = {c, d, a}}};
  return scene;
}

TEST(Wireframe, EachEdgeIsDrawnOnce) {
  const Scene lines = wireframe(square(), {Wireframe::all});
  ASSERT_EQ(lines.triangles.size(), 5U);  // four sides, and the diagonal that both triangles have
  EXPECT_TRUE(std::ranges::all_of(lines.triangles, &Triangle::is_line));
  EXPECT_TRUE(lines.commands.empty());
  for (const Triangle& line : lines.triangles) EXPECT_EQ(line.v[2].x, line.v[1].x);
  // Another distance at a corner is another edge.
  Scene apart = square();
  apart.triangles[1].v[0].s = 3;
  EXPECT_EQ(wireframe(apart, {Wireframe::all}).triangles.size(), 6U);
}

TEST(Wireframe, HiddenLinesComeBehindTheTrianglesDepth) {
  const Scene scene = wireframe(square(), {Wireframe::hidden, -7});
  ASSERT_EQ(scene.triangles.size(), 7U);
  EXPECT_FALSE(scene.triangles[1].is_line);
  EXPECT_TRUE(scene.triangles[2].is_line);
  const std::vector<DrawState> states = states_of({}, scene.commands);
  ASSERT_EQ(states.size(), 2U);
  EXPECT_EQ(scene.commands[0].before, 0U);
  EXPECT_FALSE(states[0].color_write);
  EXPECT_TRUE(states[0].depth_write);
  EXPECT_EQ(scene.commands[1].before, 2U);
  EXPECT_TRUE(states[1].color_write);
  EXPECT_EQ(states[1].depth_bias, -7);
}

TEST(Wireframe, QuadricsWithoutTrianglesGo) {
  Scene scene = square();
  scene.quadrics.push_back({.first = 0, .count = 2});
  EXPECT_TRUE(wireframe(scene, {Wireframe::all}).quadrics.empty());
  EXPECT_EQ(wireframe(scene, {Wireframe::hidden}).quadrics, scene.quadrics);
}

TEST(Wireframe, AnotherCameraSeesNoLines) {
  EXPECT_EQ(input_error([] { seen_from(wireframe(square(), {Wireframe::all}), 3); }),
            "square: another camera's view is of a scene without lines; leave @3 out");
}

TEST(Wireframe, OtherCommandsAreRefused) {
  Scene scene = square();
  Clear clear;
  clear.depth = true;
  scene.commands.push_back({.before = 1, .what = clear});
  EXPECT_EQ(input_error([&] { wireframe(scene, {Wireframe::all}); }),
            "square: a wire frame is of one draw state and one target; expected no commands but changes of "
            "state in "
            "front of the first triangle");
}

}  // namespace
}  // namespace bitspan
