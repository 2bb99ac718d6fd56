// SPDX-License-Identifier: Apache-2.0
#include "model/stages/merge.hpp"

#include <gtest/gtest.h>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

MergeRecord merged(const Config& c, double colour, double alpha, std::array<std::uint8_t, 4> stored) {
  DepthRecord z;
  z.triangle = 1;
  z.x = 2;
  z.y = 3;
  z.z = 4;
  TextureRecord t;
  t.a = encoded(alpha, c.format(FormatId::texture_alpha));
  FogRecord f;
  f.r = f.g = f.b = encoded(colour, c.format(FormatId::fog_color));
  MergeRecord out;
  model::merge(model::prepare_merge(c), z, t, f, stored, out);
  EXPECT_EQ(out.triangle, 1);
  EXPECT_EQ(out.x, 2);
  EXPECT_EQ(out.y, 3);
  EXPECT_EQ(out.z, 4);
  return out;
}

TEST(Merge, OpaqueReplaces) {
  const MergeRecord r = merged(plain_config(), 99.5, 1, {1, 2, 3});
  EXPECT_EQ(r.r, 100);  // half up
  EXPECT_EQ(r.g, 100);
  EXPECT_EQ(merged(plain_config(), 255.9375, 1, {}).r, 255);  // saturates
}

TEST(Merge, TranslucentBlends) {
  const MergeRecord r = merged(plain_config(), 100, 0.25, {0, 100, 200});
  EXPECT_EQ(r.r, 25);
  EXPECT_EQ(r.g, 100);
  EXPECT_EQ(r.b, 175);
}

// Alpha that can pass 1 does not extrapolate.
TEST(Merge, AlphaAboveOneIsOpaque) {
  Config c = plain_config();
  c.format(FormatId::texture_alpha) = {12, 2, false, Rounding::rnd, Overflow::sat, false};
  EXPECT_EQ(merged(c, 100, 1.5, {200, 0, 0}).r, 100);
  EXPECT_EQ(merged(c, 100, 0.5, {200, 0, 0}).r, 150);
}

TEST(Merge, RoundingIsTheFormats) {
  Config c = plain_config();
  c.format(FormatId::merge_color).rounding = Rounding::trn;
  EXPECT_EQ(merged(c, 99.9375, 1, {}).r, 99);
  EXPECT_EQ(merged(c, 3, 0.5, {0, 0, 0}).r, 1);
}

TEST(Merge, NarrowAndWideAgree) {
  const Config c = shipped_config("depth16");
  const auto stage = model::prepare_merge(c);
  ASSERT_TRUE(stage.fits_int64);
  auto wide = stage;
  wide.fits_int64 = false;
  std::mt19937_64 random(61);
  for (int i = 0; i < 50000; ++i) {
    TextureRecord t;
    t.a = static_cast<std::int64_t>(random() % 1025);
    FogRecord f;
    f.r = static_cast<std::int64_t>(random() % 4096);
    f.g = static_cast<std::int64_t>(random() % 4096);
    const std::array<std::uint8_t, 4> stored{static_cast<std::uint8_t>(random()),
                                             static_cast<std::uint8_t>(random()),
                                             static_cast<std::uint8_t>(random())};
    MergeRecord a;
    MergeRecord b;
    model::merge(stage, {}, t, f, stored, a);
    model::merge(wide, {}, t, f, stored, b);
    ASSERT_EQ(a, b);
  }
}

}  // namespace
}  // namespace bitspan
