// SPDX-License-Identifier: Apache-2.0
#include "scene/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

// FNV-1a over the stream's text and the textures.
std::uint64_t hash(const Scene& scene) {
  std::ostringstream text;
  write_tri(text, scene);
  std::string bytes = text.str();
  for (const Texture& t : scene.textures) bytes.append(t.rgba.begin(), t.rgba.end());
  std::uint64_t h = 0xcbf29ce484222325;
  for (const char c : bytes) h = (h ^ static_cast<std::uint8_t>(c)) * 0x100000001b3;
  return h;
}

TEST(Random, KnownSequence) {
  // splitmix64 from 0 begins e220a8397b1dcdaf, 6e789e6aa1b965f4, ...; xoshiro256** of that state, by its
  // definition.
  Random random(0);
  EXPECT_EQ(random.bits(), 0x99ec5f36cb75f2b4U);
  EXPECT_EQ(random.bits(), 0xbf6e1f784956452aU);
}

TEST(Random, DrawsStayInRangeAndSpread) {
  Random random(9);
  std::map<std::int64_t, int> counts;
  for (int i = 0; i < 60000; ++i) ++counts[random.integer(-2, 3)];
  ASSERT_EQ(counts.size(), 6U);
  for (const auto& [value, count] : counts) EXPECT_NEAR(count, 10000, 500) << value;
  int low = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.log_uniform(1, 1024);
    ASSERT_GE(x, 1);
    ASSERT_LE(x, 1024);
    low += x < 32;
  }
  EXPECT_NEAR(low, 10000, 1000);
  EXPECT_EQ(random.log_uniform(7, 7), 7);
}

TEST(RandomScene, SeedsMeanTheSameEverywhere) {
  const std::uint64_t known[] = {9182497214786153321U, 397839124888320273U, 14821778263735489303U,
                                 11838670131858052163U};
  for (std::uint64_t seed = 0; seed < std::size(known); ++seed) {
    EXPECT_EQ(hash(random_scene(seed)), known[seed]) << "seed " << seed;
  }
  EXPECT_EQ(hash(random_scene(3)), hash(random_scene(3)));
  EXPECT_NE(hash(random_scene(3)), hash(random_scene(4)));
}

TEST(RandomScene, IsLegalAndVaried) {
  int fog = 0, textured = 0, translucent = 0, holes = 0, on_end = 0, small = 0, large = 0, outside = 0;
  RandomOptions options;
  options.triangles = 100;
  for (std::uint64_t seed = 100; seed < 200; ++seed) {
    const Scene scene = random_scene(seed, options);
    ASSERT_EQ(scene.triangles.size(), 100U);
    ASSERT_NO_THROW(check_scene(scene, scene.name));
    fog += scene.fog.has_value();
    for (const Texture& t : scene.textures) {
      ASSERT_EQ(t.rgba.size(), static_cast<std::size_t>(t.width * t.height * 4));
      for (std::size_t i = 0; i < t.rgba.size(); i += 4) {
        holes += t.rgba[i] == 255 && t.rgba[i + 1] == 0 && t.rgba[i + 2] == 255;
      }
    }
    for (const Triangle& t : scene.triangles) {
      textured += t.texture >= 0;
      translucent += t.v[0].c[3] < 1;
      const auto [x_min, x_max] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
      small += x_max - x_min < 2;
      large += x_max - x_min > 128;
      outside += x_min < 0 || x_max > scene.width;
      for (const Vertex& v : t.v) {
        on_end += v.s == scene.s_min || v.s == scene.s_max;
        ASSERT_LE(std::fabs(v.u), options.uv_limit);
        ASSERT_LE(std::fabs(v.v), options.uv_limit);
      }
    }
  }
  EXPECT_GT(fog, 20);
  EXPECT_GT(textured, 3000);
  EXPECT_GT(translucent, 1000);
  EXPECT_GT(holes, 1000);
  EXPECT_GT(on_end, 100);
  EXPECT_GT(small, 1000);
  EXPECT_GT(large, 150);
  EXPECT_GT(outside, 500);
}

}  // namespace
}  // namespace bitspan
