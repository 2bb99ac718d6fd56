// SPDX-License-Identifier: Apache-2.0
#include "model/stages/forward_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "config/config.hpp"
#include "golden/forward_difference.hpp"
#include "scene/generate/patch.hpp"
#include "tests/numeric/rational.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using reference::Rational;

Format wide(int fraction, Rounding rounding = Rounding::rnd) {
  return {56, 56 - fraction, true, rounding, Overflow::sat, false};
}
CurveFormats equal(const Format& f) { return {f, f, f, f}; }

// Of a cubic in Bezier's form.
CurveCoefficients bezier(const std::array<std::int64_t, 4>& p, int fraction) {
  return {{p[0], 3 * (p[1] - p[0]), 3 * (p[0] - 2 * p[1] + p[2]), p[3] - 3 * p[2] + 3 * p[1] - p[0]},
          fraction};
}

std::vector<CurveRegisters> of_model(const CurveFormats& formats, const CurveCoefficients& curve, int k) {
  const model::ForwardDifferenceStage stage = model::prepare_forward_difference(formats, curve.fraction, k);
  CurveRegisters d = model::start_curve(stage, curve);
  std::vector<CurveRegisters> out{d};
  for (int n = 0; n < 1 << k; ++n) {
    model::forward_difference(stage, d);
    out.push_back(d);
  }
  return out;
}

Rational value_at(const CurveCoefficients& curve, const Rational& t) {
  Rational sum = 0;
  for (std::size_t i = 4; i-- > 0;) sum = sum * t + Rational{curve.power[i]};
  return sum * reference::two_to(-curve.fraction);
}
Rational value_of(std::int64_t raw, const Format& f) {
  return Rational{raw} * reference::two_to(-f.fraction());
}

// d0, d1, d2, d3 of t^3 in four steps, in 64ths: 0 1 6 6, then 1 7 12 6, 8 19 18 6, 27 37 24 6, 64 61 30 6.
TEST(ForwardDifference, ByHand) {
  const CurveFormats formats = equal(wide(6));
  const CurveCoefficients cube{{0, 0, 0, 1}, 0};
  const std::vector<CurveRegisters> expected{
      {0, 1, 6, 6}, {1, 7, 12, 6}, {8, 19, 18, 6}, {27, 37, 24, 6}, {64, 61, 30, 6}};
  EXPECT_EQ(of_model(formats, cube, 2), expected);
  EXPECT_EQ(golden::forward_difference(formats, cube, 2), expected);
}

// With 4 fraction bits 1/64 becomes 0, and 6/64, a tie's upper neighbour, 2/16.
TEST(ForwardDifference, RoundsWhereBitsAreMissing) {
  const CurveFormats formats = equal(wide(4));
  const CurveCoefficients cube{{0, 0, 0, 1}, 0};
  const std::vector<CurveRegisters> expected{
      {0, 0, 2, 2}, {0, 2, 4, 2}, {2, 6, 6, 2}, {8, 12, 8, 2}, {20, 20, 10, 2}};
  EXPECT_EQ(of_model(formats, cube, 2), expected);
  EXPECT_EQ(golden::forward_difference(formats, cube, 2), expected);
}

TEST(ForwardDifference, AStepTakesTheOldValues) {
  const model::ForwardDifferenceStage stage = model::prepare_forward_difference(equal(wide(0)), 0, 0);
  CurveRegisters d{1000, 100, 10, 1};
  model::forward_difference(stage, d);
  EXPECT_EQ(d, (CurveRegisters{1100, 110, 11, 1}));
}

Format random_format(std::mt19937_64& random) {
  const int word = static_cast<int>(4 + random() % 58);
  const bool is_signed = random() % 4 != 0;
  const auto overflow =
      static_cast<Overflow>(random() % static_cast<unsigned>(overflow_modes - (is_signed ? 0 : 1)));
  return {word,      static_cast<int>(random() % 24),
          is_signed, static_cast<Rounding>(random() % rounding_modes),
          overflow,  false};
}

// Any formats, any coefficients: the two views have the same bits in every register, and exact rationals,
// which round each sum alone, have them too.
TEST(ForwardDifference, ModelEqualsGoldenAndRationals) {
  const std::uint64_t seed = 41;
  std::mt19937_64 random(seed);
  std::uint64_t rounded = 0;
  std::uint64_t compared = 0;
  for (int n = 0; n < 400; ++n) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", curve " << n);
    const CurveFormats formats{random_format(random), random_format(random), random_format(random),
                               random_format(random)};
    const int k = static_cast<int>(random() % 6);
    CurveCoefficients curve{{}, static_cast<int>(random() % 20)};
    const int bits = static_cast<int>(1 + random() % 48);
    for (std::int64_t& c : curve.power) c = static_cast<std::int64_t>(random()) >> (64 - bits);
    const auto model = of_model(formats, curve, k);
    ASSERT_EQ(model, golden::forward_difference(formats, curve, k));
    const Rational delta = reference::two_to(-k);
    const Rational unit = reference::two_to(-curve.fraction);
    const auto term = [&](std::size_t i, int times) {
      Rational out = Rational{curve.power[i]} * times * unit;
      for (std::size_t j = 0; j < i; ++j) out *= delta;
      return out;
    };
    const std::array<Rational, 4> start{term(0, 1), term(1, 1) + term(2, 1) + term(3, 1),
                                        term(2, 2) + term(3, 6), term(3, 6)};
    CurveRegisters d{};
    for (std::size_t i = 0; i < 4; ++i) d[i] = reference::quantize(start[i], formats[i]);
    for (const CurveRegisters& at : model) {
      ASSERT_EQ(at, d);
      ++compared;
      for (std::size_t i = 0; i < 3; ++i) {
        const Rational sum = value_of(d[i], formats[i]) + value_of(d[i + 1], formats[i + 1]);
        d[i] = reference::quantize(sum, formats[i]);
        rounded += value_of(d[i], formats[i]) == sum ? 0U : 1U;
      }
    }
  }
  EXPECT_GT(compared, 3000U);
  EXPECT_GT(rounded, 3000U);
}

// The certificate says yes: every point is the cubic's, the last one is the last control point.
TEST(ForwardDifference, ThreeBitsPerHalvingAreEnough) {
  const std::uint64_t seed = 42;
  std::mt19937_64 random(seed);
  const int fraction = 10;
  const ControlGrid grid{fraction, std::int64_t{1} << 14};
  for (int k = 0; k <= 8; ++k) {
    const CurveFormats formats = equal(wide(fraction + 3 * k));
    ASSERT_EQ(curve_violation(formats, grid, k), std::nullopt) << k;
    EXPECT_EQ(curve_error_bound(formats, fraction, k), 0) << k;
    for (int n = 0; n < 8; ++n) {
      std::array<std::int64_t, 4> p{};
      for (std::int64_t& x : p) {
        x = n == 0 ? grid.largest * (&x - p.data() >= 2 ? -1 : 1)
                   : static_cast<std::int64_t>(random() % 32769) - 16384;
      }
      const CurveCoefficients curve = bezier(p, fraction);
      const auto points = of_model(formats, curve, k);
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(value_of(points[i][0], formats[0]), value_at(curve, Rational{i} * reference::two_to(-k)))
            << "seed " << seed << ", k " << k << ", point " << i;
      }
      ASSERT_EQ(points.back()[0], p[3] << (3 * k));
    }
  }
}

// One bit less: the certificate says no and names the register, and a curve shows it at its end.
TEST(ForwardDifference, OneBitLessIsNotEnough) {
  const int fraction = 10;
  const ControlGrid grid{fraction, 16384};
  for (int k = 1; k <= 8; ++k) {
    const CurveFormats formats = equal(wide(fraction + 3 * k - 1));
    const auto violation = curve_violation(formats, grid, k);
    ASSERT_TRUE(violation) << k;
    EXPECT_EQ(*violation, "formats.curve.d1 has " + std::to_string(fraction + 3 * k - 1) +
                              " fraction bits; the first differences of 2^" + std::to_string(k) +
                              " steps need " + std::to_string(fraction + 3 * k));
    // a is odd, so d1 is a tie: half an ulp is added in each step.
    const auto points = of_model(formats, bezier({0, 0, 0, 1}, fraction), k);
    EXPECT_EQ(points.back()[0] - (std::int64_t{1} << (3 * k - 1)), std::int64_t{1} << (k - 1)) << k;
    // An even a needs it no more.
    EXPECT_EQ(of_model(formats, bezier({0, 0, 0, 2}, fraction), k).back()[0], std::int64_t{2} << (3 * k - 1));
  }
}

TEST(ForwardDifference, TheCertificateKnowsRanges) {
  const ControlGrid grid{0, 100};
  CurveFormats formats = equal({20, 11, true, Rounding::rnd, Overflow::sat, false});  // 9 fraction bits
  EXPECT_EQ(curve_violation(formats, grid, 3), std::nullopt);
  formats[0].integer = 7;
  formats[0].word = 16;  // below 64
  EXPECT_NE(curve_violation(formats, grid, 3)->find("formats.curve.d0 holds at most"), std::string::npos);
  formats[0] = formats[1];
  formats[1].is_signed = false;
  EXPECT_NE(curve_violation(formats, grid, 3)->find("formats.curve.d1 is unsigned"), std::string::npos);
  formats[1] = formats[0];
  formats[2].word = 12;
  formats[2].integer = 3;  // below 4; 24 * 100 / 64 = 37.5
  EXPECT_NE(curve_violation(formats, grid, 3)->find("formats.curve.d2 holds at most"), std::string::npos);
}

// Narrow registers: observed within the bound, and the bound within four times of what is observed.
TEST(ForwardDifference, StaysWithinItsBound) {
  const std::uint64_t seed = 43;
  std::mt19937_64 random(seed);
  for (const Rounding rounding : {Rounding::rnd, Rounding::trn, Rounding::rnd_conv, Rounding::trn_zero}) {
    for (const auto& below : {std::array{0, 0, 0, 0}, {4, 4, 4, 4}, {2, 5, 8, 9}, {9, 4, 6, 2}}) {
      const int k = 3;
      CurveFormats formats;
      for (std::size_t i = 0; i < 4; ++i) formats[i] = wide(6 + below[i], rounding);
      const double bound = curve_error_bound(formats, 6, k);
      double worst = 0;
      for (int n = 0; n < 600; ++n) {
        std::array<std::int64_t, 4> p{};
        for (std::int64_t& x : p) x = static_cast<std::int64_t>(random() % 4096) - 2048;
        const CurveCoefficients curve = bezier(p, 6);
        const auto points = of_model(formats, curve, k);
        for (std::size_t i = 0; i < points.size(); ++i) {
          const Rational error =
              value_of(points[i][0], formats[0]) - value_at(curve, Rational{i} * reference::two_to(-k));
          worst = std::max(worst, std::fabs(static_cast<double>(error)));
        }
      }
      EXPECT_LE(worst, bound) << "seed " << seed << " " << to_string(rounding);
      EXPECT_GE(4 * worst, bound) << "seed " << seed << " " << to_string(rounding);
    }
  }
}

TEST(ForwardDifference, RefusesWhatTheViewsDoNotHold) {
  const CurveCoefficients curve{{1, 2, 3, 4}, 0};
  EXPECT_THROW(of_model(equal(wide(6)), curve, curve_k_limit + 1), InputError);
  EXPECT_THROW(of_model(equal(wide(6)), curve, -1), InputError);
  CurveFormats formats = equal(wide(6));
  formats[1] = {60, 110, true, Rounding::rnd, Overflow::sat, false};
  EXPECT_THROW(golden::forward_difference(formats, curve, 2), InputError);
}

TEST(ForwardDifference, TheConfigurationHasItsRegisters) {
  Config c = shipped_config("depth16");
  EXPECT_EQ(curve_formats(c), equal(c.format(FormatId::curve_d0)));
  c.format(FormatId::curve_d2).word = 30;
  EXPECT_EQ(curve_formats(c)[2].word, 30);
  EXPECT_EQ(curve_formats(c)[1].word, 44);
}

// A patch is four curves and then one per row, each by the unit (P1). Its walk in plain integers has the same
// bits.
TEST(ForwardDifference, APatchIsMadeOfCurves) {
  const std::uint64_t seed = 45;
  std::mt19937_64 random(seed);
  for (int k = patch_k_least; k <= 5; ++k) {
    PatchGrid grid;
    for (auto& row : grid) {
      for (std::int64_t& p : row) p = static_cast<std::int64_t>(random() % 2097153) - 1048576;
    }
    const auto whole = [](int fraction) {
      return equal({64, 64 - fraction, true, Rounding::trn, Overflow::sat, false});
    };
    std::array<std::vector<CurveRegisters>, 4> columns;
    for (std::size_t j = 0; j < 4; ++j) {
      columns[j] = of_model(whole(3 * k), bezier({grid[0][j], grid[1][j], grid[2][j], grid[3][j]}, 0), k);
    }
    std::vector<std::int64_t> points;
    for (std::size_t row = 0; row < patch_side(k); ++row) {
      const CurveCoefficients along =
          bezier({columns[0][row][0], columns[1][row][0], columns[2][row][0], columns[3][row][0]}, 3 * k);
      for (const CurveRegisters& d : of_model(whole(6 * k), along, k)) points.push_back(d[0]);
    }
    EXPECT_EQ(points, patch_points(grid, k, 3 * k)) << "seed " << seed << ", k " << k;
  }
}

// In the long form more than 10^8 steps.
TEST(ForwardDifference, ManySteps) {
  const std::uint64_t seed = 44;
  std::mt19937_64 random(seed);
  const int k = 12;
  const int curves = is_long_run() ? 24500 : 20;
  std::uint64_t steps = 0;
  for (int n = 0; n < curves; ++n) {
    CurveFormats formats{random_format(random), random_format(random), random_format(random),
                         random_format(random)};
    if (n % 2 == 0) formats = equal(wide(20 + static_cast<int>(random() % 17)));
    CurveCoefficients curve{{}, 16};
    for (std::int64_t& c : curve.power) c = static_cast<std::int64_t>(random()) >> 38;
    const auto model = of_model(formats, curve, k);
    ASSERT_EQ(model, golden::forward_difference(formats, curve, k)) << "seed " << seed << ", curve " << n;
    steps += model.size() - 1;
  }
  EXPECT_EQ(steps, static_cast<std::uint64_t>(curves) << k);
}

}  // namespace
}  // namespace bitspan
