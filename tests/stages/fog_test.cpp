// SPDX-License-Identifier: Apache-2.0
#include "model/stages/fog.hpp"

#include <gtest/gtest.h>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

struct Foggy {
  explicit Foggy(FogMode mode, double distance = 2) : config(plain_config()), scene(worked_scene()) {
    config.fog = mode;
    scene.fog = Fog{{200, 100, 0}, distance};
    prepare();
  }
  void prepare() { stage = model::prepare_fog(config, model::make_constants(config, scene), scene); }
  FogRecord operator()(double h, std::int64_t x, std::int64_t y, double colour = 50) const {
    FragmentRecord f;
    f.x = x;
    f.y = y;
    f.h = encoded(h, config.format(FormatId::span_h));
    TextureRecord t;
    t.r = t.g = t.b = encoded(colour, config.format(FormatId::texture_color));
    FogRecord out;
    model::fog(stage, f, {}, t, out);
    return out;
  }
  double factor(const FogRecord& r) const { return decoded(r.factor, config.format(FormatId::fog_factor)); }
  Config config;
  Scene scene;
  model::FogStage stage;
};

TEST(Fog, NonePassesTheColourOn) {
  Foggy fog(FogMode::none);
  for (int i = 0; i < 2; ++i) {
    const FogRecord r = fog(0, 0, 0, 50.5);
    EXPECT_EQ(r.index, -1);
    EXPECT_EQ(fog.factor(r), 1);
    EXPECT_EQ(decoded(r.r, fog.config.format(FormatId::fog_color)), 50.5);
    // A mode, but a scene without fog.
    fog.config.fog = FogMode::table;
    fog.scene.fog.reset();
    fog.prepare();
  }
}

// 1 - S / 4: at h = 0, S = 2: 1/2; at h = 65535, S = 1: 3/4.
TEST(Fog, LinearByDistance) {
  const Foggy fog(FogMode::linear, 4);
  const FogRecord far = fog(0, 0, 0);
  EXPECT_EQ(fog.factor(far), 0.5);
  EXPECT_EQ(far.index, -1);
  EXPECT_NE(far.recip_m, 0);
  EXPECT_EQ(decoded(far.r, fog.config.format(FormatId::fog_color)), (200 + 50) / 2.0);
  EXPECT_EQ(decoded(far.b, fog.config.format(FormatId::fog_color)), 25);
  EXPECT_EQ(fog.factor(fog(65535, 0, 0)), 0.75);
  const Foggy thick(FogMode::linear, 1);
  EXPECT_EQ(fog.factor(thick(0, 0, 0)), 0);  // saturates beyond full fog
  EXPECT_EQ(decoded(thick(0, 0, 0).r, fog.config.format(FormatId::fog_color)), 200);
}

TEST(Fog, IndexIsSixBitsOfDepthAndFourOfTheZone) {
  const Foggy fog(FogMode::table);
  ASSERT_EQ(fog.stage.table.size(), 1024U);
  EXPECT_EQ(fog(0, 32, 24).index, 0);  // next to the middle
  EXPECT_EQ(fog(1023.9, 32, 24).index, 0);
  EXPECT_EQ(fog(1024, 32, 24).index, 16);
  EXPECT_EQ(fog(65535, 32, 24).index, 63 * 16);
  EXPECT_EQ(fog(70000, 32, 24).index, 63 * 16);  // above the range
  EXPECT_EQ(fog(-3, 32, 24).index, 0);
  EXPECT_EQ(fog(0, 0, 0).index, 15);  // a corner: (63^2 + 47^2) / (64^2 + 48^2) = 0.966
  EXPECT_EQ(fog(0, 63, 47).index, 15);
  // ((2x+1-64)^2 + (2y+1-48)^2) 16 / 6400 = (31^2 + 1) / 400 = 2.4
  EXPECT_EQ(fog(0, 47, 24).index, 2);
  EXPECT_EQ(fog.factor(fog(0, 47, 24)), decoded(fog.stage.table[2], fog.config.format(FormatId::fog_factor)));
}

TEST(Fog, IndexOfOtherSplits) {
  Foggy fog(FogMode::table);
  const auto split = [&fog](int depth_bits, int zone_bits) {
    fog.config.fog_depth_bits = depth_bits;
    fog.config.fog_zone_bits = zone_bits;
    fog.prepare();
  };
  split(8, 2);
  ASSERT_EQ(fog.stage.table.size(), 1024U);
  EXPECT_EQ(fog(255.9, 32, 24).index, 0);
  EXPECT_EQ(fog(256, 32, 24).index, 4);
  EXPECT_EQ(fog(70000, 0, 0).index, 255 * 4 + 3);
  EXPECT_EQ(fog(0, 47, 24).index, 0);  // 4 * 0.15
  EXPECT_EQ(fog(0, 60, 24).index, 2);  // (57^2 + 1) / 6400 = 0.508
  split(5, 5);
  EXPECT_EQ(fog(2047.9, 32, 24).index, 0);
  EXPECT_EQ(fog(2048, 32, 24).index, 32);
  EXPECT_EQ(fog(0, 47, 24).index, 4);  // 32 * 0.15 = 4.8
  split(12, 0);
  ASSERT_EQ(fog.stage.table.size(), 4096U);
  EXPECT_EQ(fog(15.9, 0, 0).index, 0);
  EXPECT_EQ(fog(16, 0, 0).index, 1);
  split(1, 8);
  ASSERT_EQ(fog.stage.table.size(), 512U);
  EXPECT_EQ(fog(32768, 47, 24).index, 256 + 38);  // 256 * 0.1503
}

// A span.h so coarse that a step of depth is finer than its last place, and so fine that no step is left.
TEST(Fog, IndexWhereTheStepIsNotWithinH) {
  Foggy fog(FogMode::table);
  fog.config.depth_bits = 8;
  fog.config.fog_depth_bits = 8;
  fog.config.format(FormatId::span_h) = {12, 14, true, Rounding::trn, Overflow::sat, false};
  fog.prepare();
  EXPECT_EQ(fog(4, 32, 24).index, 4 * 16);
  EXPECT_EQ(fog(252, 32, 24).index, 252 * 16);
  EXPECT_EQ(fog(256, 32, 24).index, 255 * 16);
  EXPECT_EQ(fog(8188, 32, 24).index, 255 * 16);
  EXPECT_EQ(fog(-4, 32, 24).index, 0);
  fog.config.depth_bits = 32;
  fog.config.fog_depth_bits = 1;
  fog.config.format(FormatId::span_h) = {40, -20, true, Rounding::trn, Overflow::sat, false};
  fog.prepare();
  EXPECT_EQ(fog(1e-7, 32, 24).index, 0);
}

// The entries against exp and sqrt in long double; the register's last place is far above its error.
TEST(Fog, TableIsCorrectlyRounded) {
  Foggy fog(FogMode::table, 1.3);
  const auto expect_rounded = [&fog](int depth_bits, int zone_bits, Rounding mode) {
    fog.config.fog_depth_bits = depth_bits;
    fog.config.fog_zone_bits = zone_bits;
    fog.config.format(FormatId::fog_factor) = {26, 1, false, mode, Overflow::sat, false};
    fog.prepare();
    const int steps = 1 << depth_bits;
    const int zones = 1 << zone_bits;
    ASSERT_EQ(fog.stage.table.size(), static_cast<std::size_t>(steps * zones));
    for (int hi = 0; hi < steps; ++hi) {
      for (int zone = 0; zone < zones; ++zone) {
        const long double s = 65535.0L * 2 / ((hi + 0.5L) * (65536.0L / steps) + 65535);
        const long double r2 = (zone + 0.5L) / zones * (32.0L * 32 + 24 * 24);
        const long double d = s * sqrtl(1 + r2 / (50.0L * 50));
        const long double entry = std::ldexp(expl(-d / 1.3), 25);
        const long double nearest = mode == Rounding::trn ? floorl(entry) : floorl(entry + 0.5L);
        ASSERT_EQ(fog.stage.table[static_cast<std::size_t>(zones * hi + zone)],
                  static_cast<std::int64_t>(nearest))
            << hi << ", " << zone;
      }
    }
  };
  for (const Rounding mode : {Rounding::rnd, Rounding::trn, Rounding::rnd_conv}) expect_rounded(6, 4, mode);
  for (const auto& [depth_bits, zone_bits] : {std::pair(7, 3), {8, 2}, {5, 5}, {12, 0}, {1, 8}}) {
    expect_rounded(depth_bits, zone_bits, Rounding::rnd);
  }
}

// Entries so small that only "something is there" is left, and so near 1 that they round to it.
TEST(Fog, TableAtItsEnds) {
  Foggy dense(FogMode::table, 1e-6);
  EXPECT_EQ(dense.stage.table[0], 0);
  Foggy thin(FogMode::table, 1e30);
  EXPECT_EQ(thin.stage.table[0], 1024);
  thin.config.format(FormatId::fog_factor).rounding = Rounding::trn;
  thin.prepare();
  EXPECT_EQ(thin.stage.table[0], 1023);  // exp of less than 0 is below 1
}

TEST(Fog, RefusesADistanceOfNothing) {
  Foggy fog(FogMode::table);
  fog.scene.fog->distance = 0;
  EXPECT_THROW(fog.prepare(), InputError);
  fog.scene.fog->distance = 1;
  fog.scene.focal = std::nan("");
  EXPECT_THROW(fog.prepare(), InputError);
}

TEST(Fog, NarrowAndWideAgree) {
  const Foggy fog(FogMode::table);
  ASSERT_TRUE(fog.stage.fits_int64);
  Foggy wide(FogMode::table);
  wide.stage.fits_int64 = false;
  std::mt19937_64 random(51);
  for (int i = 0; i < 20000; ++i) {
    const auto h = static_cast<double>(random() % 65536);
    const auto x = static_cast<std::int64_t>(random() % 64);
    const double colour = static_cast<double>(random() % 4096) / 16;
    ASSERT_EQ(fog(h, x, 7, colour), wide(h, x, 7, colour));
  }
}

}  // namespace
}  // namespace bitspan
