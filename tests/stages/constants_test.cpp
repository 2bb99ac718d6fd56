// SPDX-License-Identifier: Apache-2.0
#include "model/stages/constants.hpp"

#include <gtest/gtest.h>

#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

using model::make_constants;

TEST(Constants, WorkedExample) {
  const Config c = plain_config();
  const model::Constants k = make_constants(c, worked_scene());
  EXPECT_EQ(k.exponent, 1);
  EXPECT_EQ(decoded(k.record.s_min, c.format(FormatId::setup_s)), 0.5);
  EXPECT_EQ(decoded(k.record.s_max, c.format(FormatId::setup_s)), 1.0);
  EXPECT_EQ(decoded(k.record.b, c.format(FormatId::setup_b)), 65535.0);
  EXPECT_EQ(k.record.c1, 0);
  EXPECT_EQ(k.record.c0, 0);
  EXPECT_EQ(k.record.fog_scale, 0);
}

TEST(Constants, ExponentIsTheSmallest) {
  const Config c = plain_config();
  Scene s = worked_scene();
  for (const auto& [s_max, e] : {std::pair{1000.0, 10}, std::pair{1024.0, 10}, std::pair{1025.0, 11}}) {
    s.s_max = s_max;
    EXPECT_EQ(make_constants(c, s).exponent, e) << s_max;
  }
  s.s_min = 0.1;
  s.s_max = 0.25;
  EXPECT_EQ(make_constants(c, s).exponent, -2);
}

// c1 = hmax B s_max' / (s_max' - s_min') = 65535 65535 1 / (1/2), c0 = hmax s_min' / (1/2).
TEST(Constants, LinearDepthCode) {
  Config c = plain_config();
  c.depth_code = DepthCode::linear;
  const model::Constants k = make_constants(c, worked_scene());
  EXPECT_EQ(decoded(k.record.c1, c.format(FormatId::depth_c1)), 2.0 * 65535 * 65535);
  EXPECT_EQ(decoded(k.record.c0, c.format(FormatId::depth_c0)), 65535.0);
}

// B s_max' / (distance 2^-E) = 65535 / (4 / 2); only with linear fog in a scene that has fog.
TEST(Constants, LinearFog) {
  Config c = plain_config();
  c.fog = FogMode::linear;
  Scene s = worked_scene();
  EXPECT_EQ(make_constants(c, s).record.fog_scale, 0);
  s.fog = Fog{{}, 4};
  EXPECT_EQ(decoded(make_constants(c, s).record.fog_scale, c.format(FormatId::fog_scale)), 32767.5);
  c.fog = FogMode::table;
  EXPECT_EQ(make_constants(c, s).record.fog_scale, 0);
}

// A distance with 53 bits that are no power of two, in front of a wide numerator: rounded right all the same.
TEST(Constants, FogDistanceOfManyBits) {
  Config c = plain_config();
  c.fog = FogMode::linear;
  c.format(FormatId::fog_scale) = {60, 22, false, Rounding::rnd, Overflow::sat, false};
  Scene s = worked_scene();
  s.fog = Fog{{}, 0.1};
  const double want = 65535 / (0.1 / 2);
  EXPECT_NEAR(decoded(make_constants(c, s).record.fog_scale, c.format(FormatId::fog_scale)), want, 1e-8);
}

TEST(Constants, RefusesWhatDoesNotFit) {
  Scene s = worked_scene();
  {
    Config c = plain_config();
    c.format(FormatId::setup_s) = {2, 1, false, Rounding::trn, Overflow::sat, false};
    s.s_min = 0.5;  // 1/4 is below the last place
    EXPECT_THROW(make_constants(c, s), InputError);
    s.s_min = 1;
    EXPECT_NO_THROW(make_constants(c, s));
    s.s_min = 1.9;   // as s_min' = 1/2, s_max' = 1
    s.s_max = 1.95;  // both 1/2
    EXPECT_THROW(make_constants(c, s), InputError);
  }
  {
    Config c = plain_config();
    c.format(FormatId::setup_b) = {8, 8, false, Rounding::trn, Overflow::sat, false};
    Scene far = worked_scene();
    far.s_max = 1e6;  // B = 0.0655
    EXPECT_THROW(make_constants(c, far), InputError);
  }
  for (const double s_min : {0.0, -1.0, 2.0, 3.0, std::nan("")}) {
    Scene bad = worked_scene();
    bad.s_min = s_min;
    EXPECT_THROW(make_constants(plain_config(), bad), InputError) << s_min;
  }
}

TEST(Constants, StartOffsets) {
  const Format kept{12, 8, true, Rounding::trn, Overflow::sat, false};  // ulp 1/16
  const auto value = [&](StartOffset o) {
    const model::Exact e = model::offset_value(o, kept);
    return std::ldexp(static_cast<double>(static_cast<std::int64_t>(e.raw)), -e.fraction);
  };
  EXPECT_EQ(value({true, 0}), 1.0 / 32);
  EXPECT_EQ(value({false, 0}), 0.0);
  EXPECT_EQ(value({false, -2.75}), -2.75);
}

}  // namespace
}  // namespace bitspan
