// SPDX-License-Identifier: Apache-2.0
// The z-buffer line by line against values worked by hand, against another oracle pixel by pixel, and against
// the engines. [H5, B3]
#include <gtest/gtest.h>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using test::triangle_at;
using test::triangle_of;

std::vector<Visible> lines_of(const Scene& scene, FillRule rule = FillRule::top_left) {
  Config config = shipped_config("depth16");
  config.fill_rule = rule;
  return test::picture_of("scanline", config, scene);
}

TEST(Scanline, StepsAlongARow) {
  // 1/S is 1/2 at (8, 8), less by 1/64 per pixel to the right, and by 3/128 per pixel downwards.
  const Scene scene = test::scene_of({triangle_of({8, 8, 2}, {24, 8, 4}, {8, 24, 8})});
  const std::vector<Visible> picture = lines_of(scene);
  for (int x = 8; x < 21; ++x) {
    ASSERT_EQ(triangle_at(picture, scene, x, 10), 0) << x;
    const long double q = 0.5L - (x + 0.5L - 8) / 64 - 2.5L * 3 / 128;
    EXPECT_EQ(picture[static_cast<std::size_t>(10 * 64 + x)].q.value, q) << x;
  }
  EXPECT_EQ(triangle_at(picture, scene, 7, 10), -1);
  EXPECT_EQ(triangle_at(picture, scene, 21, 10), -1);  // its centre lies on the right side
}

// Centres on all three sides: the upper and the left one are the triangle's own, or all.
TEST(Scanline, TheFillRuleDecidesOnSides) {
  const Scene scene = test::scene_of({triangle_of({4.5, 4.5, 10}, {8.5, 4.5, 10}, {4.5, 8.5, 10})}, 12, 12);
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    const std::vector<Visible> picture = lines_of(scene, rule);
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 12; ++x) {
        const bool inside = x >= 4 && y >= 4 && x + y <= (rule == FillRule::inclusive ? 12 : 11);
        EXPECT_EQ(triangle_at(picture, scene, x, y), inside ? 0 : -1) << x << ", " << y;
      }
    }
  }
}

// Vertices on pixels' centres and borders, so that many centres lie on a side or a corner.
TEST(Scanline, EqualsTheCoverageOnEdgesToo) {
  Random draw(41);
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    test::Agreement all;
    for (int round = 0; round < 1500; ++round) {
      const auto corner = [&] {
        return test::At{static_cast<double>(draw.integer(-6, 30)) / 2,
                        static_cast<double>(draw.integer(-6, 30)) / 2, draw.log_uniform(1, 20)};
      };
      const Scene scene = test::scene_of({triangle_of(corner(), corner(), corner())}, 12, 12);
      test::compare_pictures(test::picture_of("scanline", config, scene),
                             test::picture_of("half_planes", config, scene), all);
      ASSERT_EQ(all.differences, 0U) << "round " << round;
    }
    EXPECT_GT(all.seen, 18000U);
  }
}

TEST(Scanline, SeesWhatHalfPlanesSee) {
  const Config config = shipped_config("depth20");
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const test::Agreement one = test::agreement("scanline", config, test::random_opaque_scene(seed));
    EXPECT_EQ(one.differences, 0U) << "seed " << seed;
    EXPECT_GT(one.seen, 100U);
  }
}

// Triangles far outside the picture, at distances that differ beyond a double's products.
TEST(Scanline, GiantsAtAllDistances) {
  const Config config = shipped_config("depth16");
  Random draw(42);
  for (const double ratio : {1e3, 1e9, 1e250}) {
    const Scene scene = test::scattered_scene(draw, ratio, 20, {-1000, 1000}, {-1000, 1000});
    const test::Agreement one = test::agreement("scanline", config, scene);
    EXPECT_EQ(one.differences, 0U) << ratio;
    EXPECT_GT(one.seen, 1000U) << ratio;
  }
}

// Of equal triangles the first is seen, and of triangles that differ by the last bit of one corner the
// nearer.
TEST(Scanline, TheLastBitOfADistanceDecides) {
  Random draw(43);
  for (int round = 0; round < 12; ++round) {
    const auto corner = [&] {
      return test::At{draw.uniform(0, 64), draw.uniform(0, 48), draw.log_uniform(1, 1000)};
    };
    const Triangle one = triangle_of(corner(), corner(), corner());
    Triangle two = one;
    if (round % 3 != 0) two.v[0].s = std::nextafter(two.v[0].s, round % 3 == 1 ? 0 : 1e9);
    for (const Visible& at : lines_of(test::scene_of({one, two}))) {
      if (at.triangle < 0) continue;
      EXPECT_EQ(at.triangle, round % 3 == 1 ? 1 : 0) << "round " << round;
    }
  }
}

TEST(Scanline, RandomStreamsHold) { test::hold_random_streams("scanline", is_long_run() ? 10000 : 60, 2001); }

TEST(Scanline, SeesSpotWithFewTies) {
  const Scene scene = test::spot(320, 240);
  for (const char* name : {"depth16", "depth20"}) {
    const Config config = shipped_config(name);
    const VisibilityReport report =
        test::compared(test::oracle_named("scanline"), config, scene, test::drawn_by("model", config, scene));
    EXPECT_EQ(report.unexplained, 0U) << name << ": " << report.first;
    EXPECT_GT(report.equal, 12000U);
    EXPECT_LE(report.ties * 1000, report.compared());
  }
}

TEST(Scanline, ABiasOfFourCodesOnOneTriangleIsFound) {
  const Config config = shipped_config("depth20");
  const Scene scene = test::two_that_cut();
  for (const std::int64_t bias : {4, -4}) {
    const VisibilityReport report =
        test::compared(test::oracle_named("scanline"), config, scene,
                       test::drawn_by("model", config, test::biased(scene, 1, bias)));
    EXPECT_GT(report.unexplained, 500U) << bias;
    EXPECT_FALSE(report.held());
  }
}

}  // namespace
}  // namespace bitspan
