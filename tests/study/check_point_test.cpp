// SPDX-License-Identifier: Apache-2.0
// A recommended point is checked for what it is: equal in golden, model and RTL.
#include "study/check_point.hpp"

#include <gtest/gtest.h>

#include <array>

#include "scene/demo.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

TEST(CheckPoint, AWidthThatNobodyShippedIsEqualInAllViews) {
  Config config = shipped_config("narrow");
  config.format(FormatId::span_uv).word += 1;
  const std::array scenes{demo_scene(96, 72)};
  const PointCheck check = check_point(config, scenes);
  EXPECT_TRUE(check.held) << check.text;
  EXPECT_NE(check.text.find("model = golden: "), std::string::npos) << check.text;
  EXPECT_NE(check.text.find("model = rtl: "), std::string::npos) << check.text;
}

TEST(CheckPoint, ComparesTheRtlInAModeOfTwoDivides) {
  Config config = shipped_config("depth16");
  config.perspective = Perspective::hyperbolic;
  const std::array scenes{demo_scene(64, 48)};
  const PointCheck check = check_point(config, scenes);
  EXPECT_TRUE(check.held) << check.text;
  EXPECT_NE(check.text.find("model = rtl: "), std::string::npos) << check.text;
}

TEST(CheckPoint, NothingComparedIsNotHeld) {
  const PointCheck check = check_point(shipped_config("narrow"), {});
  EXPECT_FALSE(check.held) << check.text;
}

TEST(CheckPoint, ASceneThatDrawsNothingIsNotHeld) {
  std::array scenes{demo_scene(64, 48)};
  scenes[0].triangles.clear();
  const PointCheck check = check_point(shipped_config("narrow"), scenes);
  EXPECT_FALSE(check.held) << check.text;
  EXPECT_NE(check.text.find("this says nothing"), std::string::npos) << check.text;
}

}  // namespace
}  // namespace bitspan
