// SPDX-License-Identifier: Apache-2.0
#include "scene/demo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "config/config.hpp"
#include "scene/exact.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

std::map<std::string, Scene> extremes() {
  std::map<std::string, Scene> scenes;
  for (Scene& scene : extreme_scenes()) scenes[scene.name] = std::move(scene);
  return scenes;
}

TEST(Demo, HasAllItsParts) {
  const Scene scene = demo_scene(640, 480);
  ASSERT_NO_THROW(check_scene(scene, "demo"));
  ASSERT_TRUE(scene.fog);
  EXPECT_EQ(scene.fog->color, scene.background) << "the horizon melts into the sky";
  ASSERT_EQ(scene.textures.size(), 6U);
  std::map<std::string, int> triangles_of;
  bool gouraud = false;
  for (const Triangle& t : scene.triangles) {
    triangles_of[t.texture < 0 ? "none" : scene.textures[static_cast<std::size_t>(t.texture)].name]++;
    gouraud = gouraud || (t.texture < 0 && t.v[0].c != t.v[1].c);
    for (const Vertex& v : t.v) {
      EXPECT_LT(std::fabs(v.u), 4096);
      EXPECT_LT(std::fabs(v.v), 4096);
    }
  }
  for (const char* part :
       {"floor.png", "brick.png", "wood.png", "globe.png", "grille.png", "glass.png", "none"}) {
    EXPECT_GT(triangles_of[part], 0) << part;
  }
  EXPECT_TRUE(gouraud);

  // The floor runs from the viewer's feet to the horizon.
  double nearest = 1e9, farthest = 0;
  for (const Triangle& t : scene.triangles) {
    if (t.texture != 0) continue;
    for (const Vertex& v : t.v) {
      nearest = std::min(nearest, v.s);
      farthest = std::max(farthest, v.s);
    }
  }
  EXPECT_GT(farthest / nearest, 50);
  EXPECT_EQ(farthest, scene.s_max);

  const auto has = [](const Texture& t, auto&& test) {
    for (std::size_t i = 0; i < t.rgba.size(); i += 4) {
      if (test(&t.rgba[i])) return true;
    }
    return false;
  };
  EXPECT_TRUE(
      has(scene.textures[4], [](const std::uint8_t* p) { return p[0] == 255 && p[1] == 0 && p[2] == 255; }));
  EXPECT_TRUE(has(scene.textures[5], [](const std::uint8_t* p) { return p[3] > 0 && p[3] < 255; }));
  EXPECT_TRUE(std::any_of(scene.textures.begin(), scene.textures.end(), [](const Texture& t) {
    return (t.width & (t.width - 1)) != 0;
  })) << "a size that is no power of two";
  // The translucent pane is drawn last.
  EXPECT_EQ(scene.triangles.back().texture, 5);
  const auto first_glass = std::find_if(scene.triangles.begin(), scene.triangles.end(),
                                        [](const Triangle& t) { return t.texture == 5; });
  EXPECT_TRUE(
      std::all_of(first_glass, scene.triangles.end(), [](const Triangle& t) { return t.texture == 5; }));
}

TEST(Demo, IsTheSameEachTimeAndFitsAnySize) {
  std::ostringstream a, b;
  write_tri(a, demo_scene(320, 240));
  write_tri(b, demo_scene(320, 240));
  EXPECT_EQ(a.str(), b.str());
  for (const auto& [width, height] :
       {std::pair{1, 1}, {16, 9}, {160, 120}, {480, 640}, {2400, 1000}, {3, 900}}) {
    const Scene scene = demo_scene(width, height);
    EXPECT_NO_THROW(check_scene(scene, "demo"));
    EXPECT_GT(scene.triangles.size(), 1U);
    for (const Triangle& t : scene.triangles) {
      for (const Vertex& v : t.v) ASSERT_LT(std::max(std::fabs(v.u), std::fabs(v.v)), 4096);
    }
  }
  EXPECT_THROW(demo_scene(0, 10), InputError);
  EXPECT_THROW(demo_scene(1000, 100), InputError);
}

TEST(Extreme, ScenesAreLegalStreams) {
  const auto scenes = extreme_scenes();
  EXPECT_EQ(scenes.size(), 9U);
  for (const Scene& scene : scenes) {
    EXPECT_FALSE(scene.triangles.empty()) << scene.name;
    EXPECT_NO_THROW(check_scene(scene, scene.name));
  }
}

TEST(Extreme, EachSceneHasItsTheme) {
  auto scenes = extremes();
  int ends[3] = {};
  for (const Triangle& t : scenes["depth-ends"].triangles) {
    for (const Vertex& v : t.v) {
      ends[0] += v.s == scenes["depth-ends"].s_min;
      ends[2] += v.s == scenes["depth-ends"].s_max;
    }
  }
  EXPECT_GT(ends[0], 20);
  EXPECT_GT(ends[2], 20);

  EXPECT_EQ(scenes["wide"].width, 16384);
  EXPECT_TRUE(
      std::any_of(scenes["wide"].triangles.begin(), scenes["wide"].triangles.end(), [](const Triangle& t) {
        const auto [low, high] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
        return high - low >= 16384;
      }));

  int turns[3] = {};
  for (const Triangle& t : scenes["both-windings"].triangles) ++turns[orientation(t) + 1];
  EXPECT_EQ(turns[0], 3);
  EXPECT_EQ(turns[2], 3);

  for (const Triangle& t : scenes["pixel-centres"].triangles) {
    for (const Vertex& v : t.v) {
      EXPECT_EQ(v.x - std::floor(v.x), 0.5);
      EXPECT_EQ(v.y - std::floor(v.y), 0.5);
    }
  }
  for (const Triangle& t : scenes["one-pixel"].triangles) {
    const auto [low, high] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
    EXPECT_LT(high - low, 2);
  }
  bool off = false;
  for (const Triangle& t : scenes["outside"].triangles) {
    off = off || std::max({t.v[0].x, t.v[1].x, t.v[2].x}) < 0;
  }
  EXPECT_TRUE(off);
}

// In a closed fan every spoke belongs to exactly two triangles, once in each direction.
TEST(Extreme, FansAreClosed) {
  using Edge = std::array<double, 4>;
  std::map<Edge, int> edges;
  const Scene scene = extremes()["shared-edges"];
  for (const Triangle& t : scene.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex &p = t.v[k], &q = t.v[(k + 1) % 3];
      ++edges[{p.x, p.y, q.x, q.y}];
    }
  }
  std::size_t shared = 0;
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    shared += edges.count({edge[2], edge[3], edge[0], edge[1]});
  }
  EXPECT_EQ(shared, 2 * scene.triangles.size()) << "each triangle has two inner edges";
}

}  // namespace
}  // namespace bitspan
