// SPDX-License-Identifier: Apache-2.0
// The room: what each option adds to it.
#include "scene/room.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "scene/tri_stream.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// How many triangles there are, and how many give a normal, a place in a projector's view, or in a map.
struct Given {
  std::size_t all = 0, normal = 0, projected = 0, in_map = 0, commands = 0;
};
Given given(const Scene& scene) {
  Given out{.all = scene.triangles.size(), .commands = scene.commands.size()};
  for (const Triangle& t : scene.triangles) {
    const auto any = [&](auto... member) {
      return std::ranges::any_of(t.v, [&](const Vertex& v) { return ((v.*member != 0) || ...); });
    };
    out.normal += any(&Vertex::nx, &Vertex::ny, &Vertex::nz) ? 1 : 0;
    out.projected += any(&Vertex::project_w) ? 1 : 0;
    out.in_map += any(&Vertex::lz) ? 1 : 0;
  }
  return out;
}

TEST(Room, EachOptionAddsWhatItIsFor) {
  const Scene plain = room_scene({}, 160, 120);
  EXPECT_FALSE(plain.light);
  EXPECT_EQ(given(plain).normal + given(plain).projected + given(plain).in_map + given(plain).commands, 0U);
  EXPECT_GT(plain.triangles.size(), 1000U);
  const Scene lit = room_scene({.lamp = true}, 160, 120);
  ASSERT_TRUE(lit.light);
  EXPECT_TRUE(lit.light->is_point);
  EXPECT_EQ(given(lit).normal, lit.triangles.size());
  const Given shaded = given(room_scene({.lamp = true, .shadow = true}, 160, 120));
  EXPECT_GT(shaded.all, lit.triangles.size() + 1000) << "the map's pass";
  EXPECT_GT(shaded.projected, 1000U);
  const Given relief = given(room_scene({.lamp = true, .relief = true}, 160, 120));
  EXPECT_EQ(relief.all, lit.triangles.size());
  EXPECT_GE(relief.in_map, 2U);
  EXPECT_LT(relief.in_map, 10U) << "the wall";
  EXPECT_EQ(relief.commands, 2U);
  const Given both = given(room_scene({.lamp = true, .shadow = true, .relief = true}, 160, 120));
  EXPECT_EQ(both.in_map, relief.in_map);
  EXPECT_GT(both.projected, 1000U);
}

TEST(Room, IsTheSameInEveryCallAndComesBackAsAStream) {
  const RoomOptions all{.lamp = true, .shadow = true, .relief = true};
  const auto text = [&] {
    std::ostringstream out;
    write_tri(out, room_scene(all, 64, 48));
    return out.str();
  };
  EXPECT_EQ(text(), text());
}

TEST(Room, FollowsTheConfiguration) {
  Config c = shipped_config("depth20");
  EXPECT_FALSE(room_options(c).lamp || room_options(c).shadow || room_options(c).relief);
  EXPECT_EQ(room_options(c).depth_bits, 20);
  c.light = LightAt::pixel;
  c.light_normal = LightNormal::map;
  EXPECT_FALSE(room_options(c).lamp || room_options(c).relief) << "no light at a point";
  c.light_source = LightSource::point;
  c.project = ProjectUnit::reciprocal;
  EXPECT_TRUE(room_options(c).lamp && room_options(c).shadow && room_options(c).relief);
  EXPECT_FALSE(room_options(c).lamp_takes_shadow);
  c.light_shadow = LightShadow::map;
  EXPECT_TRUE(room_options(c).lamp_takes_shadow);
}

TEST(Room, RefusesASize) {
  for (const auto& [width, height] : {std::pair{0, 10}, {10, 0}, {16385, 16384}, {250, 100}}) {
    EXPECT_TRUE(names(input_error([&] { room_scene({}, width, height); }), "is not legal for the room"));
  }
}

}  // namespace
}  // namespace bitspan
