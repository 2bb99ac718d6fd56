// SPDX-License-Identifier: Apache-2.0
// The kept truth is `ideal`, and truth_config keeps all that it reads.
#include "report/truth.hpp"

#include <gtest/gtest.h>

#include "report/random_config.hpp"
#include "scene/random.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

void expect_same(const IdealPoint& a, const IdealPoint& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.h, b.h);
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.shade, b.shade);
}

TEST(Truth, IsIdealOfAnyConfiguration) {
  const std::vector<Config> bases = shipped_configs();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Config config = random_config(seed, bases);
    RandomOptions options;
    options.width = 64;
    options.height = 48;
    options.triangles = 24;
    options.size_max = 60;
    options.mip_chains = has_lod(config);
    const Scene scene = random_scene(seed, options);
    const Truth truth(config, scene, scene.triangles);
    ASSERT_EQ(truth.size(), scene.triangles.size());
    std::size_t covered = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto t = ideal_triangle(config, scene.triangles[i]);
      ASSERT_EQ(t.has_value(), truth.triangle(i).has_value()) << "seed " << seed;
      if (!t) continue;
      for (int k = 0; k < 3; ++k) expect_same(truth.vertex(i, k), ideal_at_vertex(config, scene, *t, k));
      for (std::int64_t y = 0; y < scene.height; ++y) {
        const Truth::Pixels pixels = truth.covered(i, y);
        for (std::int64_t x = 0; x < scene.width; ++x) {
          const bool inside = ideal_covers(config, *t, x, y);
          ASSERT_EQ(inside, x >= pixels.first && x < pixels.end) << "seed " << seed << ' ' << x << ',' << y;
          covered += inside ? 1 : 0;
          if (!inside && (x + y) % 7 != 0) continue;  // some of those outside, which are computed anew
          const IdealFragment a = truth.at(i, x, y);
          const IdealFragment b = ideal_at(config, scene, *t, x, y);
          expect_same(a.point, b.point);
          EXPECT_EQ(a.z, b.z);
          EXPECT_EQ(a.fogged, b.fogged);
          EXPECT_EQ(a.killed, b.killed);
        }
        for (int edge = 0; edge < 3; ++edge) {
          const std::int64_t a = t->v[edge == 2 ? 1 : 0].y;
          const std::int64_t b = t->v[edge == 1 ? 1 : 2].y;
          if (a != b) expect_same(truth.on_edge(i, edge, y), ideal_on_edge(config, scene, *t, edge, y));
        }
      }
    }
    EXPECT_GT(covered, 100U) << "seed " << seed;
  }
}

}  // namespace
}  // namespace bitspan
