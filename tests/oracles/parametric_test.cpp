// SPDX-License-Identifier: Apache-2.0
// Triangles filled by parameters in object space: the source's number of points leaves gaps, the safe one
// none. [O1]
#include <gtest/gtest.h>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using test::triangle_of;

const Config& config() {
  static const Config shipped = shipped_config("depth20");
  return shipped;
}

double count_of(const std::string& oracle, std::string_view what, const Scene& scene) {
  const Visibility visibility(config(), scene, std::vector<double>(scene.triangles.size()));
  std::vector<OracleCount> counts;
  visibility.picture(test::oracle_named(oracle), &counts);
  for (const OracleCount& count : counts) {
    if (count.name == what) return count.value;
  }
  ADD_FAILURE() << oracle << " does not count " << what;
  return -1;
}

// The corners are four pixels apart, so that four points lie on a side, 4/3 pixels apart: at 4.5, 5.83, 7.17
// and 8.5. Pixel 6 has no point in x, and none in y.
TEST(Parametric, TheSourcesPointsByHand) {
  const Scene scene = test::scene_of({triangle_of({4.5, 4.5, 10}, {8.5, 4.5, 10}, {4.5, 8.5, 10})}, 12, 12);
  const std::vector<Visible> picture = test::picture_of("parametric_source", config(), scene);
  for (int y = 4; y < 8; ++y) {
    for (int x = 4; x + y < 12; ++x) {
      const bool is_hit = x != 6 && y != 6;
      EXPECT_EQ(test::triangle_at(picture, scene, x, y), is_hit ? 0 : -1) << x << ", " << y;
    }
  }
  EXPECT_EQ(count_of("parametric_source", "gaps", scene), 4);
  EXPECT_EQ(count_of("parametric_source", "points per pixel", scene), 1);
  // 4 + 1 + 2 = 7 points, 2/3 pixel apart: 28 in the 15 pixels that they lie in.
  EXPECT_EQ(count_of("parametric", "gaps", scene), 0);
  EXPECT_NEAR(count_of("parametric", "points per pixel", scene), 28.0 / 15, 1e-9);
}

// At constant depth, and where perspective stretches the near end.
TEST(Parametric, TheSourcesNumberLeavesGaps) {
  for (const double far : {10.0, 20.0, 100.0}) {
    const Scene scene = test::scene_of({triangle_of({2, 4, 10}, {60, 8, far}, {30, 44, far})});
    EXPECT_GT(count_of("parametric_source", "gaps", scene), 0) << far;
    EXPECT_EQ(count_of("parametric", "gaps", scene), 0) << far;
  }
}

TEST(Parametric, TheSafeNumberLeavesNone) {
  Random draw(61);
  double source_gaps = 0;
  const int rounds = is_long_run() ? 5000 : 200;
  for (int round = 0; round < rounds; ++round) {
    const double ratio = draw.log_uniform(1, 30);
    const auto corner = [&] {
      return test::At{draw.uniform(-4, 40), draw.uniform(-4, 40), draw.log_uniform(1, ratio)};
    };
    const Scene scene = test::scene_of({triangle_of(corner(), corner(), corner())}, 40, 40);
    EXPECT_EQ(count_of("parametric", "gaps", scene), 0) << "round " << round;
    source_gaps += count_of("parametric_source", "gaps", scene);
  }
  EXPECT_GT(source_gaps, 5 * rounds);
}

// Slivers: a side between two rows of centres, and corners on centres.
TEST(Parametric, SliversHaveNone) {
  Random draw(62);
  for (int round = 0; round < 300; ++round) {
    const test::At a{static_cast<double>(draw.integer(0, 60)) / 2,
                     static_cast<double>(draw.integer(0, 60)) / 2, 1};
    const test::At b{static_cast<double>(draw.integer(0, 60)) / 2,
                     static_cast<double>(draw.integer(0, 60)) / 2, draw.uniform(1, 4)};
    const Scene scene =
        test::scene_of({triangle_of(a, b, {b.x + 0.0625, b.y - 0.0625, draw.uniform(1, 4)})}, 32, 32);
    EXPECT_EQ(count_of("parametric", "gaps", scene), 0) << "round " << round;
  }
}

RandomOptions gentle_options() {
  RandomOptions options = test::opaque_options();
  options.size_max = 60;
  options.depth_ratio_max = 4;
  return options;
}

TEST(Parametric, RandomStreamsHold) {
  test::hold_random_streams("parametric", is_long_run() ? 10000 : 20, 4001, gentle_options());
}

TEST(Parametric, SeesSpotAndTheSourceSeesLess) {
  const Scene scene = test::spot(320, 240);
  const Frame frame = test::drawn_by("model", config(), scene);
  const VisibilityReport safe = test::compared(test::oracle_named("parametric"), config(), scene, frame);
  EXPECT_EQ(safe.unexplained, 0U) << safe.first;
  EXPECT_GT(safe.equal, 12000U);
  const VisibilityReport source =
      test::compared(test::oracle_named("parametric_source"), config(), scene, frame);
  EXPECT_GT(source.unexplained, 100U);
  EXPECT_TRUE(source.held());
}

TEST(Parametric, ABiasOfFourCodesOnOneTriangleIsFound) {
  const Scene scene = test::two_that_cut();
  const VisibilityReport report =
      test::compared(test::oracle_named("parametric"), config(), scene,
                     test::drawn_by("model", config(), test::biased(scene, 1, 4)));
  EXPECT_GT(report.unexplained, 500U);
}

TEST(Parametric, RefusesMorePointsThanItCanMake) {
  const Oracle& safe = test::oracle_named("parametric");
  EXPECT_EQ(safe.refuses(config(), test::two_that_cut()), "");
  const Scene scene = test::scene_of({triangle_of({0, 0, 1}, {60, 0, 1000}, {0, 40, 1000})});
  EXPECT_EQ(safe.refuses(config(), scene),
            "its triangles need 1.9e+09 points, and it takes no more than 3e+08");
}

}  // namespace
}  // namespace bitspan
