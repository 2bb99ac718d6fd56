// SPDX-License-Identifier: Apache-2.0
#include "model/stages/rotate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "golden/rotate.hpp"
#include "tests/numeric/rational.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

RotateFormats with(Rounding rounding, int fraction = 10) {
  const Format small{18, 1, true, Rounding::rnd, Overflow::sat, false};
  return {small, small, {32, 32 - fraction, true, rounding, Overflow::sat, false}};
}

// Far enough from the ends for no overflow.
PlaneVector random_vector(std::mt19937_64& random, int bits = 29) {
  return {static_cast<std::int64_t>(random()) >> (64 - bits),
          static_cast<std::int64_t>(random()) >> (64 - bits)};
}

constexpr Rounding odd[] = {Rounding::rnd_conv, Rounding::rnd_inf, Rounding::rnd_zero, Rounding::trn_zero};

TEST(Rotate, TakesAnglesApart) {
  const auto parts = [](int angle) {
    const AngleParts p = angle_parts(angle, 360);
    return std::pair{p.quarter, p.rest};
  };
  EXPECT_EQ(parts(0), (std::pair{0, 0}));
  EXPECT_EQ(parts(45), (std::pair{0, 45}));
  EXPECT_EQ(parts(46), (std::pair{1, -44}));
  EXPECT_EQ(parts(90), (std::pair{1, 0}));
  EXPECT_EQ(parts(135), (std::pair{1, 45}));
  EXPECT_EQ(parts(136), (std::pair{2, -44}));
  EXPECT_EQ(parts(180), (std::pair{2, 0}));
  EXPECT_EQ(parts(-46), (std::pair{-1, 44}));
  for (int turn : {8, 16, 360, 1024}) {
    for (int angle = -turn / 2; angle <= turn / 2; ++angle) {
      const AngleParts p = angle_parts(angle, turn);
      EXPECT_EQ(p.quarter * (turn / 4) + p.rest, angle);
      EXPECT_LE(std::abs(p.rest), turn / 8);
      EXPECT_LE(std::abs(p.quarter), 2);
    }
  }
}

// By 30 degrees, with t = 0.267949... and s = 1/2: 17560 and 32768 in 2^-16, whole numbers for x and y.
//   x1 = 1000 - Q(0.26794 * 200 = 53.589) = 946; y1 = 200 + Q(473) = 673; x2 = 946 - Q(180.33) = 766
TEST(Rotate, ByHand) {
  RotateFormats formats = with(Rounding::rnd_conv, 0);
  formats.t = formats.s = {18, 2, true, Rounding::rnd, Overflow::sat, false};
  const model::RotateStage stage = model::prepare_rotate(formats, 360);
  EXPECT_EQ(stage.tangents[30], 17560);
  EXPECT_EQ(stage.sines[30], 32768);
  EXPECT_EQ(model::rotate(stage, {1000, 200}, 30), (PlaneVector{766, 673}));
  EXPECT_EQ(model::rotate(stage, {1000, 200}, 90), (PlaneVector{-200, 1000}));
  EXPECT_EQ(model::rotate(stage, {1000, 200}, -90), (PlaneVector{200, -1000}));
  EXPECT_EQ(model::rotate(stage, {1000, 200}, 180), (PlaneVector{-1000, -200}));
  EXPECT_EQ(model::rotate(stage, {1000, 200}, 120), (PlaneVector{-673, 766}));
  EXPECT_EQ(model::rotate(stage, {-673, 766}, -120), (PlaneVector{1000, 200}));
  EXPECT_EQ(golden::Rotation(formats, 360)({1000, 200}, 30), (PlaneVector{766, 673}));
}

// Any registers: tables and vectors, at the ends of the range too.
TEST(Rotate, ModelEqualsGolden) {
  const std::uint64_t seed = 61;
  std::mt19937_64 random(seed);
  const int designs = is_long_run() ? 4000 : 60;
  for (int n = 0; n < designs; ++n) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", design " << n);
    const auto format = [&](int most) {
      return Format{static_cast<int>(4 + random() % static_cast<unsigned>(most)),
                    static_cast<int>(1 + random() % 4),
                    true,
                    static_cast<Rounding>(random() % rounding_modes),
                    static_cast<Overflow>(random() % overflow_modes),
                    false};
    };
    const RotateFormats formats{format(50), format(50), format(55)};
    const int turn = 8 * static_cast<int>(1 + random() % 90);
    const model::RotateStage stage = model::prepare_rotate(formats, turn);
    const golden::Rotation golden(formats, turn);
    ASSERT_EQ(stage.tangents, golden.tangents());
    ASSERT_EQ(stage.sines, golden.sines());
    for (int i = 0; i < 200; ++i) {
      const PlaneVector v =
          random_vector(random, static_cast<int>(1 + random() % static_cast<unsigned>(formats.xy.word)));
      const int angle = static_cast<int>(random() % static_cast<unsigned>(turn + 1)) - turn / 2;
      ASSERT_EQ(model::rotate(stage, v, angle), golden(v, angle)) << v.x << " " << v.y << " by " << angle;
    }
  }
}

// An odd rounding: turned back, every bit is as before. In the long form 10^8 vectors.
TEST(Rotate, TurnedBackEveryBitIsRestored) {
  const std::uint64_t seed = 62;
  std::mt19937_64 random(seed);
  const int vectors = is_long_run() ? 25'000'000 : 20'000;
  for (const Rounding rounding : odd) {
    const model::RotateStage stage = model::prepare_rotate(with(rounding), 360);
    for (int n = 0; n < vectors; ++n) {
      const PlaneVector v = random_vector(random);
      const int angle = static_cast<int>(random() % 361) - 180;
      const PlaneVector there = model::rotate(stage, v, angle);
      ASSERT_EQ(model::rotate(stage, there, -angle), v)
          << "seed " << seed << " " << to_string(rounding) << " " << v.x << " " << v.y << " by " << angle;
    }
  }
}

// SC_RND fails at ties, and only there; SC_TRN nearly always.
TEST(Rotate, OtherRoundingsDoNotRestore) {
  std::mt19937_64 random(63);
  const auto failures = [&](Rounding rounding, bool& only_at_ties) {
    const model::RotateStage stage = model::prepare_rotate(with(rounding), 360);
    const model::RotateStage even = model::prepare_rotate(with(Rounding::rnd_inf), 360);
    int failed = 0;
    only_at_ties = true;
    for (int n = 0; n < 20000; ++n) {
      const PlaneVector v = random_vector(random);
      const int angle = 1 + static_cast<int>(random() % 44);
      const PlaneVector there = model::rotate(stage, v, angle);
      if (model::rotate(stage, there, -angle) == v) continue;
      ++failed;
      // Without a tie of a negative product SC_RND and SC_RND_INF are one.
      only_at_ties =
          only_at_ties && (model::rotate(even, v, angle) != there ||
                           model::rotate(even, there, -angle) != model::rotate(stage, there, -angle));
    }
    return failed;
  };
  bool only_at_ties = false;
  const int rnd = failures(Rounding::rnd, only_at_ties);
  EXPECT_GT(rnd, 0);
  EXPECT_LT(rnd, 1000);
  EXPECT_TRUE(only_at_ties);
  EXPECT_GT(failures(Rounding::trn, only_at_ties), 19000);
}

// Each product loses half an ulp and t, s half of theirs; a full turn in 360 steps stays near.
TEST(Rotate, DriftsLittleInATurn) {
  const model::RotateStage stage = model::prepare_rotate(with(Rounding::rnd_conv), 360);
  std::mt19937_64 random(64);
  for (int n = 0; n < 50; ++n) {
    const PlaneVector v = random_vector(random, 25);
    PlaneVector now = v;
    const double length = std::hypot(static_cast<double>(v.x), static_cast<double>(v.y));
    for (int step = 1; step <= 360; ++step) {
      now = model::rotate(stage, now, 1);
      const double angle = step * std::numbers::pi / 180;
      const double x =
          static_cast<double>(v.x) * std::cos(angle) - static_cast<double>(v.y) * std::sin(angle);
      const double y =
          static_cast<double>(v.x) * std::sin(angle) + static_cast<double>(v.y) * std::cos(angle);
      // Per step three roundings, and the tables' errors of 2^-18 each on the length.
      const double bound = step * (3 * 0.5 + 3 * std::ldexp(length, -18));
      ASSERT_LE(std::hypot(static_cast<double>(now.x) - x, static_cast<double>(now.y) - y), 1.5 * bound);
    }
  }
}

// Over all angles, coarse tables and coarse vectors: within the bound, and the bound within four times of it.
TEST(Rotate, StaysWithinItsBound) {
  const std::uint64_t seed = 65;
  std::mt19937_64 random(seed);
  for (const Rounding rounding : {Rounding::rnd_conv, Rounding::trn}) {
    for (const int table : {8, 18}) {
      RotateFormats formats = with(rounding);
      formats.t = formats.s = {table, 1, true, Rounding::rnd, Overflow::sat, false};
      const model::RotateStage stage = model::prepare_rotate(formats, 360);
      const double length = std::ldexp(1.5, 15);
      const double bound = rotate_error_bound(formats, length);
      double worst = 0;
      for (int n = 0; n < 40000; ++n) {
        const double direction = static_cast<double>(random() % 100000) * 2e-5 * std::numbers::pi;
        const double size = n % 2 == 0 ? length : length * static_cast<double>(random() % 1000) / 1000;
        const PlaneVector v{static_cast<std::int64_t>(std::ldexp(size * std::cos(direction), 10)),
                            static_cast<std::int64_t>(std::ldexp(size * std::sin(direction), 10))};
        const int angle = static_cast<int>(random() % 361) - 180;
        const PlaneVector now = model::rotate(stage, v, angle);
        const long double turned = angle * std::numbers::pi_v<long double> / 180;
        const auto x = static_cast<long double>(v.x);
        const auto y = static_cast<long double>(v.y);
        const auto error_x =
            static_cast<double>(x * std::cos(turned) - y * std::sin(turned)) - static_cast<double>(now.x);
        const auto error_y =
            static_cast<double>(x * std::sin(turned) + y * std::cos(turned)) - static_cast<double>(now.y);
        worst = std::max({worst, std::fabs(error_x), std::fabs(error_y)});
      }
      EXPECT_LE(std::ldexp(worst, -10), bound)
          << "seed " << seed << " " << to_string(rounding) << " " << table;
      EXPECT_GE(4 * std::ldexp(worst, -10), bound)
          << "seed " << seed << " " << to_string(rounding) << " " << table;
    }
  }
}

TEST(Rotate, RefusesWhatIsNotLegal) {
  EXPECT_THROW(model::prepare_rotate(with(Rounding::rnd), 12), InputError);
  EXPECT_THROW(model::prepare_rotate(with(Rounding::rnd), 0), InputError);
  RotateFormats formats = with(Rounding::rnd);
  formats.t.is_signed = false;
  EXPECT_THROW(model::prepare_rotate(formats, 360), InputError);
  formats = with(Rounding::rnd);
  formats.xy.word = 64;
  formats.s = {50, 1, true, Rounding::rnd, Overflow::sat, false};
  EXPECT_THROW(golden::Rotation(formats, 360), InputError);
  EXPECT_EQ(rotate_formats(shipped_config("depth16")).xy.rounding, Rounding::rnd_conv);
}

}  // namespace
}  // namespace bitspan
