// SPDX-License-Identifier: Apache-2.0
// Equality of all that a frame holds: the picture, and per pixel the triangle and the texture coordinates.
#pragma once

#include <gtest/gtest.h>

#include "engine/frame.hpp"
#include "tests/support/same_bits.hpp"

namespace bitspan {

inline void expect_same_frame(const Frame& got, const Frame& expected) {
  EXPECT_EQ(got.color, expected.color);
  EXPECT_EQ(got.depth, expected.depth);
  EXPECT_EQ(got.triangle, expected.triangle);
  EXPECT_EQ(got.stencil, expected.stencil);
  EXPECT_TRUE(same_bits(got.u, expected.u));
  EXPECT_TRUE(same_bits(got.v, expected.v));
}

}  // namespace bitspan
