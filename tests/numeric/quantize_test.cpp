// SPDX-License-Identifier: Apache-2.0
// The narrowing routine against exact rationals.
#include "model/numeric/quantize.hpp"

#include <gtest/gtest.h>

#include "tests/numeric/modes.hpp"
#include "tests/numeric/rational.hpp"

namespace bitspan {
namespace {

using model::int128;
using reference::Rational;

Rational rational(int128 raw, int fraction) {
  return Rational{reference::to_integer(raw)} * reference::two_to(-fraction);
}

// Hand-worked: -2.5 .. 2.5 in halves to integers.
TEST(Quantize, TiesOfEachMode) {
  const auto row = [](Rounding rounding) {
    const Format f{8, 8, true, rounding, Overflow::sat, false};
    std::vector<std::int64_t> out;
    for (const int halves : {-5, -3, -1, 1, 3, 5}) {
      out.push_back(model::quantize(halves, 1, f));
    }
    return out;
  };
  using Row = std::vector<std::int64_t>;
  EXPECT_EQ(row(Rounding::rnd), (Row{-2, -1, 0, 1, 2, 3}));
  EXPECT_EQ(row(Rounding::rnd_zero), (Row{-2, -1, 0, 0, 1, 2}));
  EXPECT_EQ(row(Rounding::rnd_min_inf), (Row{-3, -2, -1, 0, 1, 2}));
  EXPECT_EQ(row(Rounding::rnd_inf), (Row{-3, -2, -1, 1, 2, 3}));
  EXPECT_EQ(row(Rounding::rnd_conv), (Row{-2, -2, 0, 0, 2, 2}));
  EXPECT_EQ(row(Rounding::trn), (Row{-3, -2, -1, 0, 1, 2}));
  EXPECT_EQ(row(Rounding::trn_zero), (Row{-2, -1, 0, 0, 1, 2}));
}

// Hand-worked: around the range of a signed 3-bit integer, -4..3.
TEST(Quantize, OverflowOfEachMode) {
  const auto row = [](Overflow overflow) {
    const Format f{3, 3, true, Rounding::trn, overflow, false};
    std::vector<std::int64_t> out;
    for (const int v : {-9, -5, -4, 3, 4, 8}) {
      out.push_back(model::quantize(v, 0, f));
    }
    return out;
  };
  using Row = std::vector<std::int64_t>;
  EXPECT_EQ(row(Overflow::sat), (Row{-4, -4, -4, 3, 3, 3}));
  EXPECT_EQ(row(Overflow::sat_sym), (Row{-3, -3, -3, 3, 3, 3}));
  EXPECT_EQ(row(Overflow::sat_zero), (Row{0, 0, -4, 3, 0, 0}));
  EXPECT_EQ(row(Overflow::wrap), (Row{-1, 3, -4, 3, -4, 0}));
  // 4 = 0100: the bit above is 0, the old sign 1, so 00 is inverted: 011.
  // -5 = ..1011: above 1, sign 0: 11 inverted, 100. -9 = ..0111: above 0, sign 1: 00. 8 = 1000: above 1: 111.
  EXPECT_EQ(row(Overflow::wrap_sm), (Row{0, -4, -4, 3, 3, -1}));
}

TEST(Quantize, ExhaustiveAgainstRationals) {
  for (int word = 1; word <= 5; ++word) {
    for (int integer = -2; integer <= 8; ++integer) {
      for (const bool is_signed : {false, true}) {
        for_all_modes(word, integer, is_signed, [&](const Format& f) {
          for (int raw = -128; raw < 128; ++raw) {
            ASSERT_EQ(model::quantize(raw, 4, f), reference::quantize(rational(raw, 4), f)) << raw;
          }
        });
      }
    }
  }
}

// Values up to 127 bits, the source's point anywhere: growth, dropping more than 127 bits, and between.
TEST(Quantize, RandomAgainstRationals) {
  std::mt19937_64 random(7);
  int far = 0;
  for (int i = 0; i < 300000; ++i) {
    const Format f = random_format(random);
    const int128 raw = random_value(random, 127);
    const int fraction = random_int(random, -150, 250);
    const int shift = fraction - f.fraction();
    far += shift <= 0 || shift > 126 ? 1 : 0;
    ASSERT_EQ(model::quantize(raw, fraction, f), reference::quantize(rational(raw, fraction), f))
        << "case " << i << ", shift " << shift;
  }
  EXPECT_GT(far, 30000);
}

// Every shift from beyond growth to beyond all bits, at the ends of 127 bits.
TEST(Quantize, EveryShiftOfTheExtremes) {
  const int128 max = static_cast<int128>((model::uint128{1} << 127) - 1);
  for (const int128 raw :
       {max, -max, max - 1, int128{1} << 126, -(int128{1} << 126), int128{1}, int128{-1}}) {
    for (int fraction = -140; fraction <= 200; ++fraction) {
      for_all_modes(9, 4, true, [&](const Format& f) {
        ASSERT_EQ(model::quantize(raw, fraction, f), reference::quantize(rational(raw, fraction), f))
            << fraction;
      });
      for_all_modes(63, 20, false, [&](const Format& f) {
        ASSERT_EQ(model::quantize(raw, fraction, f), reference::quantize(rational(raw, fraction), f))
            << fraction;
      });
    }
  }
}

// The 64-bit instantiation is the same function.
TEST(Quantize, NarrowAndWideAgree) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 300000; ++i) {
    const model::Register r = model::make_register(random_format(random));
    const auto raw = static_cast<std::int64_t>(random_value(random, 63));
    const int fraction = random_int(random, -100, 150);
    ASSERT_EQ(model::quantize(raw, fraction, r, model::NoObserve{}),
              model::quantize(int128{raw}, fraction, r, model::NoObserve{}));
  }
}

TEST(Exact, SumsAndProductsAreThoseOfRationals) {
  std::mt19937_64 random(9);
  const auto value = [](model::Exact e) { return rational(e.raw, e.fraction); };
  for (int i = 0; i < 20000; ++i) {
    const model::Exact a{random_value(random, 50), random_int(random, -10, 40)};
    const model::Exact b{random_value(random, 50), random_int(random, -10, 40)};
    ASSERT_EQ(value(a + b), value(a) + value(b));
    ASSERT_EQ(value(a - b), value(a) - value(b));
    ASSERT_EQ(value(a * b), value(a) * value(b));
    ASSERT_EQ(reference::to_integer(model::floor_of(a)), reference::floor_of(value(a)));
    ASSERT_EQ(reference::to_integer(model::ceil_of(a)), -reference::floor_of(-value(a)));
    const int e = random_int(random, -30, 30);
    ASSERT_EQ(value(model::scaled(a, e)), value(a) * reference::two_to(-e));
  }
}

}  // namespace
}  // namespace bitspan
