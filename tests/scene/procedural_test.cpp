// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural.hpp"

#include <gtest/gtest.h>

#include "scene/texels.hpp"

namespace bitspan {
namespace {

constexpr std::array kinds{TexelFormat::checker, TexelFormat::brick, TexelFormat::noise};

TEST(Procedural, RandomTablesAreLegal) {
  Random random(9);
  for (int n = 0; n < 1000; ++n) {
    const TexelFormat format = kinds[static_cast<std::size_t>(n % 3)];
    const Texture t = random_procedural(random, format, static_cast<int>(random.integer(1, 300)),
                                        static_cast<int>(random.integer(1, 300)));
    EXPECT_EQ(procedural_fault(t), "");
    EXPECT_TRUE(is_whole(t));
    EXPECT_TRUE(t.raw.empty() && t.rgba.empty());
    EXPECT_EQ(byte_count(t), 0U);
  }
}

// One step beyond each end of each number.
TEST(Procedural, WhatIsOutOfRangeIsNamed) {
  Random random(10);
  for (const TexelFormat format : kinds) {
    const Texture good = random_procedural(random, format, 64, 64);
    const auto values = procedural_values(format);
    for (std::size_t k = 0; k < values.size(); ++k) {
      for (const int wrong : {values[k].low - 1, values[k].high + 1}) {
        Texture bad = good;
        if (wrong > 32767) continue;  // no such number in the table
        bad.table[8 + k] = static_cast<std::int16_t>(wrong);
        EXPECT_TRUE(
            procedural_fault(bad).starts_with(std::string(values[k].key) + ": " + std::to_string(wrong)))
            << procedural_fault(bad);
        EXPECT_FALSE(is_whole(bad));
      }
    }
    Texture bad = good;
    bad.table[5] = 256;
    EXPECT_EQ(procedural_fault(bad), "colors: 256 is out of range; expected 0..255");
  }
  Texture noise = random_procedural(random, TexelFormat::noise, 64, 64);
  noise.table[noise_cell] = 3;
  noise.table[noise_octaves] = 5;
  EXPECT_EQ(procedural_fault(noise), "octaves: 5 is out of range; expected 1..4");
}

}  // namespace
}  // namespace bitspan
