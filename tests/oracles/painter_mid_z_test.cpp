// SPDX-License-Identifier: Apache-2.0
// The painter by the middle of z: right where the order is plain, wrong on the two examples of the textbooks.
// [H3]
#include <gtest/gtest.h>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

VisibilityReport painted(const Scene& scene) {
  const Config config = shipped_config("depth20");
  return test::compared(test::oracle_named("painter_mid_z"), config, scene,
                        test::drawn_by("model", config, scene));
}

TEST(PainterMidZ, IsRightWhereTheOrderIsPlain) {
  // Drawn from near to far, so that the sort has work to do.
  const VisibilityReport report =
      painted(test::scene_of({test::triangle_of({4, 4, 10}, {40, 8, 12}, {10, 44, 11}),
                              test::triangle_of({10, 2, 20}, {60, 8, 22}, {20, 46, 21}),
                              test::triangle_of({2, 2, 30}, {62, 2, 32}, {30, 46, 31})}));
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 1000U);
}

TEST(PainterMidZ, CountsItsWrongPixelsAndFailsNothing) {
  const VisibilityReport report = painted(test::two_that_cut());
  EXPECT_GT(report.unexplained, 100U);
  EXPECT_TRUE(report.held());
  EXPECT_NE(visibility_text(report).find("wrong, as this algorithm may be"), std::string::npos);
}

TEST(PainterMidZ, NoOrderIsRightForACycle) {
  const VisibilityReport report = painted(test::three_in_a_cycle());
  EXPECT_GT(report.unexplained, 10U);
  EXPECT_TRUE(report.held());
}

// A long floor whose middle is farther than the middle of what stands behind a part of it.
TEST(PainterMidZ, AMiddleCanMislead) {
  const VisibilityReport report =
      painted(test::scene_of({test::triangle_of({2, 46, 5}, {62, 46, 5}, {32, 10, 90}),
                              test::triangle_of({10, 44, 20}, {54, 44, 20}, {32, 30, 20})}));
  EXPECT_GT(report.unexplained, 100U);
}

}  // namespace
}  // namespace bitspan
