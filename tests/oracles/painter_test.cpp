// SPDX-License-Identifier: Apache-2.0
// The painter's algorithm by five tests: right where the middle of z is wrong, and equal to a brute force
// pixel by pixel, in either fill rule. [B4]
#include <gtest/gtest.h>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using test::triangle_of;

VisibilityReport painted(const std::string& painter, const Scene& scene) {
  const Config config = shipped_config("depth20");
  return test::compared(test::oracle_named(painter), config, scene, test::drawn_by("model", config, scene));
}

// The two examples of the sources: each triangle hides a part of the other one, and three hide each other in
// turn.
TEST(Painter, IsRightWhereTheMiddleOfZIsWrong) {
  for (const Scene& scene : {test::two_that_cut(), test::three_in_a_cycle()}) {
    EXPECT_GT(painted("painter_mid_z", scene).unexplained, 10U);
    const VisibilityReport report = painted("painter", scene);
    EXPECT_EQ(report.unexplained, 0U) << report.first;
    EXPECT_GT(report.equal, 500U);
    EXPECT_EQ(test::agreement("painter", shipped_config("depth20"), scene).differences, 0U);
  }
}

// Tests 3 and 4 each decide for a pair whose distances overlap: the first lies behind the plane of the
// second, or the second in front of the plane of the first.
TEST(Painter, OnePlaneIsEnough) {
  const Config config = shipped_config("depth20");
  const Triangle floor = triangle_of({2, 46, 5}, {62, 46, 5}, {32, 10, 90});
  const Triangle above = triangle_of({10, 44, 3}, {54, 44, 3}, {32, 30, 10});
  const Triangle below = triangle_of({10, 44, 20}, {54, 44, 20}, {32, 30, 80});
  for (const auto& pair : {std::pair{floor, above}, {above, floor}, {floor, below}, {below, floor}}) {
    const test::Agreement one = test::agreement("painter", config, test::scene_of({pair.first, pair.second}));
    EXPECT_EQ(one.differences, 0U);
    EXPECT_GT(one.seen, 500U);
  }
}

// Of faces that are exactly as far the first is seen, whatever the order of painting.
TEST(Painter, EqualFacesShowTheFirst) {
  const Triangle one = triangle_of({4, 4, 10}, {40, 4, 20}, {4, 40, 15});
  const Triangle other = triangle_of({4, 4, 10}, {40, 4, 20}, {4.5, 40, 15});
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    for (const auto& scene : {test::scene_of({one, one, one}), test::scene_of({one, other, one}),
                              test::scene_of({other, one, other})}) {
      EXPECT_EQ(test::agreement("painter", config, scene).differences, 0U);
    }
  }
}

// Vertices on few places and distances, so that faces touch, cut each other along centres, and lie in one
// plane.
TEST(Painter, WhereFacesTouch) {
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    Random draw(51);
    std::uint64_t seen = 0;
    const int rounds = is_long_run() ? 20000 : 600;
    for (int round = 0; round < rounds; ++round) {
      const auto corner = [&] {
        return test::At{static_cast<double>(draw.integer(0, 6)) * 2 + 0.5,
                        static_cast<double>(draw.integer(0, 6)) * 2 + 0.5,
                        static_cast<double>(draw.integer(2, 4))};
      };
      std::vector<Triangle> triangles;
      for (int i = 0; i < 6; ++i) triangles.push_back(triangle_of(corner(), corner(), corner()));
      const test::Agreement one = test::agreement("painter", config, test::scene_of(triangles, 13, 13));
      ASSERT_EQ(one.differences, 0U) << "round " << round;
      seen += one.seen;
    }
    EXPECT_GT(seen, 60U * static_cast<unsigned>(rounds));
  }
}

TEST(Painter, SeesWhatHalfPlanesSee) {
  const Config config = shipped_config("depth20");
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const test::Agreement one = test::agreement("painter", config, test::random_opaque_scene(seed));
    EXPECT_EQ(one.differences, 0U) << "seed " << seed;
    EXPECT_GT(one.seen, 100U);
  }
}

TEST(Painter, GiantsAtAllDistances) {
  const Config config = shipped_config("depth16");
  Random draw(52);
  for (const double ratio : {1e3, 1e9, 1e250}) {
    const Scene scene = test::scattered_scene(draw, ratio, 8, {-1000, 1000}, {-1000, 1000});
    const test::Agreement one = test::agreement("painter", config, scene);
    EXPECT_EQ(one.differences, 0U) << ratio;
    EXPECT_GT(one.seen, 1000U) << ratio;
  }
}

TEST(Painter, RandomStreamsHold) { test::hold_random_streams("painter", is_long_run() ? 10000 : 20, 3001); }

TEST(Painter, SeesSpotWithFewTies) {
  const Scene scene = test::spot(320, 240);
  const VisibilityReport report = painted("painter", scene);
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 12000U);
  EXPECT_LE(report.ties * 1000, report.compared());
}

TEST(Painter, ABiasOfFourCodesOnOneTriangleIsFound) {
  const Config config = shipped_config("depth20");
  const Scene scene = test::two_that_cut();
  for (const std::int64_t bias : {4, -4}) {
    const VisibilityReport report =
        test::compared(test::oracle_named("painter"), config, scene,
                       test::drawn_by("model", config, test::biased(scene, 1, bias)));
    EXPECT_GT(report.unexplained, 500U) << bias;
    EXPECT_FALSE(report.held());
  }
}

}  // namespace
}  // namespace bitspan
