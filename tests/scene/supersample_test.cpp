// SPDX-License-Identifier: Apache-2.0
#include "scene/supersample.hpp"

#include <gtest/gtest.h>

#include "config/config.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

constexpr const char* stream =
    "{\"bitspan\": 2, \"width\": 32, \"height\": 24, \"s_min\": 1.0, \"s_max\": 100.0, \"focal\": 30.0, "
    "\"background\": [1, 2, 3]}\n"
    "{\"state\": {\"scissor.left\": 5, \"scissor.right\": 20, \"depth.bias\": 7, \"stipple\": 255}}\n"
    "{\"v\": [[2, 2.25, 2, 0, 0], [30, 4, 50, 20, 0], [-5, 22, 9, 0, 20]]}\n"
    "{\"clear\": {\"depth\": true}}\n";

TEST(Supersample, WhatIsMeasuredInPixelsGrows) {
  const Scene one = parse_tri(stream, "s.tri");
  const Scene three = supersampled(one, 3);
  EXPECT_EQ(three.width, 96);
  EXPECT_EQ(three.height, 72);
  EXPECT_EQ(three.focal, 90);
  EXPECT_EQ(three.triangles[0].v[0].x, 6);
  EXPECT_EQ(three.triangles[0].v[0].y, 6.75);
  EXPECT_EQ(three.triangles[0].v[2].x, -15);
  const std::vector<StateSetting> expected{{*find_state_register("scissor.left"), 15},
                                           {*find_state_register("scissor.right"), 60},
                                           {*find_state_register("depth.bias"), 7},
                                           {*find_state_register("stipple"), 255}};
  EXPECT_EQ(std::get<StateChange>(three.commands[0].what).settings, expected);
  EXPECT_EQ(three.commands[1], one.commands[1]);
  EXPECT_EQ(three.s_min, one.s_min);
  EXPECT_EQ(three.s_max, one.s_max);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(three.triangles[0].v[i].s, one.triangles[0].v[i].s);
    EXPECT_EQ(three.triangles[0].v[i].u, one.triangles[0].v[i].u);
    EXPECT_EQ(three.triangles[0].v[i].c, one.triangles[0].v[i].c);
  }
  check_scene(three, "three");
}

TEST(Supersample, OfOneSampleIsTheScene) {
  const Scene scene = random_scene(1);
  const Scene same = supersampled(scene, 1);
  ASSERT_EQ(same.triangles.size(), scene.triangles.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (std::size_t v = 0; v < 3; ++v) {
      EXPECT_EQ(same.triangles[i].v[v].x, scene.triangles[i].v[v].x);
      EXPECT_EQ(same.triangles[i].v[v].y, scene.triangles[i].v[v].y);
    }
  }
  EXPECT_EQ(same.focal, scene.focal);
}

TEST(Supersample, AScissorEndsAtItsLargestValue) {
  Scene scene = parse_tri(stream, "s.tri");
  std::get<StateChange>(scene.commands[0].what).settings = {
      {*find_state_register("scissor.bottom"), scissor_limit}};
  EXPECT_EQ(std::get<StateChange>(supersampled(scene, 16).commands[0].what).settings[0].value, scissor_limit);
}

TEST(Supersample, WhatAStreamCannotHoldIsRefused) {
  Scene large = demo_scene(4000, 3000);
  EXPECT_NE(input_error([&] { supersampled(large, 16); }).find("are too large a picture"), std::string::npos);
  Scene far = parse_tri(stream, "s.tri");
  far.triangles[0].v[1].x = 20000;
  EXPECT_NE(input_error([&] { supersampled(far, 2); }).find("triangle 0: a position times 2"),
            std::string::npos);
}

}  // namespace
}  // namespace bitspan
