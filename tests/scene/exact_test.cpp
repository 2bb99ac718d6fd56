// SPDX-License-Identifier: Apache-2.0
#include "scene/exact.hpp"

#include <gtest/gtest.h>

#include "scene/random.hpp"

namespace bitspan {
namespace {

TEST(Exact, OrientationOfPlainTriangles) {
  EXPECT_EQ(orientation(0, 0, 1, 0, 0, 1), 1);
  EXPECT_EQ(orientation(0, 0, 0, 1, 1, 0), -1);
  EXPECT_EQ(orientation(0, 0, 1, 1, 2, 2), 0);
  EXPECT_EQ(orientation(5, 5, 5, 5, 9, 1), 0);
}

TEST(Exact, OrientationBelowTheRoundingOfDoubles) {
  // One ulp off the line y = x, far from and near to the origin.
  EXPECT_EQ(orientation(0.5, 0.5, 12, 12, 24, 24), 0);
  EXPECT_EQ(orientation(0.5, 0.5 + 0x1p-53, 12, 12, 24, 24),
            -orientation(0.5, 0.5 - 0x1p-54, 12, 12, 24, 24));
  EXPECT_NE(orientation(0.5, 0.5 + 0x1p-53, 12, 12, 24, 24), 0);
  // Products that underflow.
  EXPECT_EQ(orientation(0, 0, 1e-200, 0, 0, 1e-200), 1);
  EXPECT_EQ(orientation(0, 0, 1e-200, 1e-200, 2e-200, 2e-200), 0);
}

TEST(Exact, OrientationChangesSignWithAnySwap) {
  Random random(5);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    // Points on a coarse grid, moved by single ulps: nearly or exactly on one line.
    double p[6];
    for (double& x : p)
      x = static_cast<double>(random.integer(0, 6)) / 3 +
          static_cast<double>(random.integer(-1, 1)) * 0x1p-52;
    const int sign = orientation(p[0], p[1], p[2], p[3], p[4], p[5]);
    zeros += sign == 0;
    EXPECT_EQ(orientation(p[2], p[3], p[0], p[1], p[4], p[5]), -sign);
    EXPECT_EQ(orientation(p[2], p[3], p[4], p[5], p[0], p[1]), sign);
    EXPECT_EQ(orientation(p[1], p[0], p[3], p[2], p[5], p[4]), -sign);
  }
  EXPECT_GT(zeros, 100);
}

}  // namespace
}  // namespace bitspan
