// SPDX-License-Identifier: Apache-2.0
#include "scene/picture_size.hpp"

#include <gtest/gtest.h>

#include <string>

namespace bitspan {
namespace {

TEST(PictureSize, IsReadWhole) {
  const std::optional<Size> size = parse_size("64x048");
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 64);
  EXPECT_EQ(size->height, 48);
  EXPECT_EQ(parse_size("-3x0")->width, -3);  // a size, though no legal one
  for (const char* text : {"", "x", "64", "64x", "x48", "64x48x2", "64 x 48", " 64x48", "64x48 ", "64X48",
                           "6.4x48", "99999999999x1", "1x99999999999"}) {
    EXPECT_FALSE(parse_size(text)) << text;
  }
}

TEST(PictureSize, HasLimitsEachWayAndOfTheArea) {
  EXPECT_TRUE(is_legal(Size{}));
  for (const Size& legal :
       {Size{1, 1}, Size{32768, 1}, Size{1, 32768}, Size{32768, 2048}, Size{8192, 8192}}) {
    EXPECT_TRUE(is_legal(legal)) << legal.width << 'x' << legal.height;
  }
  for (const Size& not_legal : {Size{0, 1}, Size{1, 0}, Size{-1, -1}, Size{32769, 1}, Size{1, 32769},
                                Size{32768, 2049}, Size{8193, 8192}}) {
    EXPECT_FALSE(is_legal(not_legal)) << not_legal.width << 'x' << not_legal.height;
  }
}

}  // namespace
}  // namespace bitspan
