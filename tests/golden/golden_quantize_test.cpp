// SPDX-License-Identifier: Apache-2.0
// Q on floating point against exact rationals: every rounding and overflow mode, each Real.
#include <gtest/gtest.h>

#include "golden/quantize.hpp"
#include "tests/golden/golden_support.hpp"
#include "tests/numeric/modes.hpp"

namespace bitspan::test {
namespace {

using namespace bitspan::golden;

// The exact Real of n 2^e.
template <class Real>
Real real_of(__int128 n, int e) {
  return Real(static_cast<typename RealTraits<Real>::Base>(n)) * pow2<Real>(e);
}
Rational rational_of(__int128 n, int e) { return scale(Rational(int_of(n)), e); }

template <class Real>
class QuantizeTest : public testing::Test {};
using Reals = testing::Types<double, long double, Quad, Checked<double>, Checked<long double>, Checked<Quad>>;
TYPED_TEST_SUITE(QuantizeTest, Reals);

std::string describe(const Format& f) {
  return (f.is_signed ? "signed " : "unsigned ") + std::to_string(f.word) + "." + std::to_string(f.integer) +
         " rounding " + std::to_string(static_cast<int>(f.rounding)) + " overflow " +
         std::to_string(static_cast<int>(f.overflow));
}

TEST(Quantize, ModesByHand) {
  const auto q = [](double x, Rounding mode) {
    return Quantizer<double>(Format{8, 8, true, mode, Overflow::sat, false})(x);
  };
  EXPECT_EQ(q(2.5, Rounding::rnd), 3);
  EXPECT_EQ(q(-2.5, Rounding::rnd), -2);
  EXPECT_EQ(q(2.5, Rounding::rnd_zero), 2);
  EXPECT_EQ(q(-2.5, Rounding::rnd_zero), -2);
  EXPECT_EQ(q(2.5, Rounding::rnd_min_inf), 2);
  EXPECT_EQ(q(-2.5, Rounding::rnd_min_inf), -3);
  EXPECT_EQ(q(2.5, Rounding::rnd_inf), 3);
  EXPECT_EQ(q(-2.5, Rounding::rnd_inf), -3);
  EXPECT_EQ(q(2.5, Rounding::rnd_conv), 2);
  EXPECT_EQ(q(-3.5, Rounding::rnd_conv), -4);
  EXPECT_EQ(q(-2.25, Rounding::trn), -3);
  EXPECT_EQ(q(-2.75, Rounding::trn_zero), -2);
  EXPECT_EQ(q(1e300, Rounding::trn), 127);
  EXPECT_EQ(q(-1e-300, Rounding::trn), -1);
  EXPECT_EQ(q(-1e-300, Rounding::rnd), 0);
}

// Every value of a small grid, two bits finer than the format and four times as wide.
TYPED_TEST(QuantizeTest, ExhaustiveAtSmallWidths) {
  for (const bool is_signed : {false, true}) {
    for (int word = is_signed ? 2 : 1; word <= 5; ++word) {
      for (const int integer : {-2, 0, word, word + 2}) {
        for_all_modes(word, integer, is_signed, [&](const Format& f) {
          const Quantizer<TypeParam> q(f);
          const int e = -f.fraction() - 2;
          for (int n = -(16 << word); n <= 16 << word; ++n) {
            const std::int64_t raw = q.raw(q(real_of<TypeParam>(n, e)));
            ASSERT_EQ(Int(raw), oracle_raw(f, rational_of(n, e))) << describe(f) << " n " << n;
          }
        });
      }
    }
  }
}

TYPED_TEST(QuantizeTest, RandomValuesSumsProductsAndQuotients) {
  constexpr int bits = real_bits<TypeParam>;
  Draw draw(11);
  int compared = 0;
  for (int round = 0; round < 120; ++round) {
    const bool is_signed = draw.flip();
    const int word = static_cast<int>(draw.integer(2, std::min(bits - 2, 62)));
    const int integer = static_cast<int>(draw.integer(-4, word + 4));
    for_all_modes(word, integer, is_signed, [&](const Format& f) {
      const Quantizer<TypeParam> q(f);
      const auto expect = [&](TypeParam got, const Rational& x, const char* what) {
        ++compared;
        ASSERT_EQ(Int(q.raw(got)), oracle_raw(f, x)) << what << " " << describe(f);
      };
      const auto exponent = [&] { return static_cast<int>(draw.integer(-6, 3)) - f.fraction(); };
      {
        const __int128 n = draw.wide_integer(bits);
        const int e = -f.fraction() - static_cast<int>(draw.integer(0, bits));
        expect(q(real_of<TypeParam>(n, e)), rational_of(n, e), "value");
      }
      {
        const __int128 n = draw.wide_integer(bits - 8);
        const __int128 m = draw.wide_integer(std::min(bits, 60) / 2);
        const int e1 = exponent();
        const int e2 = exponent();
        expect(q.sum(real_of<TypeParam>(n, e1), real_of<TypeParam>(m, e2)),
               rational_of(n, e1) + rational_of(m, e2), "sum");
      }
      {
        const __int128 n = draw.wide_integer(bits / 2 - 3);
        const __int128 m = draw.wide_integer(bits / 2 - 3);
        const int e1 = -f.fraction() / 2 - static_cast<int>(draw.integer(0, bits / 4));
        const int e2 = -f.fraction() / 2 - static_cast<int>(draw.integer(0, bits / 4));
        expect(q.product(real_of<TypeParam>(n, e1), real_of<TypeParam>(m, e2)),
               rational_of(n, e1) * rational_of(m, e2), "product");
      }
      {
        const __int128 n = draw.wide_integer(bits / 2 - 4);
        __int128 d = draw.wide_integer(bits / 3);
        if (d == 0) d = 1;
        if (draw.flip()) d = d % 2 == 0 ? d + 1 : d;
        const int e = -f.fraction() + static_cast<int>(draw.integer(0, 3));
        expect(q.quotient(real_of<TypeParam>(n, e), real_of<TypeParam>(d, 0)),
               rational_of(n, e) / rational_of(d, 0), "quotient");
      }
    });
  }
  EXPECT_GT(compared, 10000);
}

// Quotients that lie on a tie, on a whole number, and one last bit beside them.
TYPED_TEST(QuantizeTest, QuotientsAtTheBoundary) {
  Draw draw(12);
  for (int round = 0; round < 400; ++round) {
    const std::int64_t d = draw.integer(1, 1 << 20);
    const std::int64_t q2 = draw.integer(-(1 << 20), 1 << 20);  // twice the quotient
    for_all_modes(24, 24, true, [&](const Format& f) {
      const Quantizer<TypeParam> q(f);
      for (const int beside : {-1, 0, 1}) {
        const std::int64_t n = q2 * d + beside;  // over 2 d
        const std::int64_t raw = q.raw(q.quotient(real_of<TypeParam>(n, -1), real_of<TypeParam>(d, 0)));
        ASSERT_EQ(Int(raw), oracle_raw(f, Rational(Int(n), Int(2 * d))))
            << describe(f) << " " << n << "/" << 2 * d;
      }
    });
  }
}

// A floor that a rounded product crosses: (2^30 + 1)(2^30 - 1) = 2^60 - 1 is 2^60 in double.
TEST(Quantize, ProductJustBelowAFloorBoundary) {
  const Format f{40, 70, true, Rounding::trn, Overflow::sat, false};  // ulp 2^30
  const double a = 0x1p30 + 1;
  const double b = 0x1p30 - 1;
  const Quantizer<double> q(f);
  EXPECT_EQ(q.raw(q(a * b)), 1 << 30) << "the naive product was expected to be wrong";
  EXPECT_EQ(q.raw(q.product(a, b)), (1 << 30) - 1);
  EXPECT_THROW(Checked<double>(a) * Checked<double>(b), InexactError);
  const Quantizer<long double> wide(f);
  EXPECT_EQ(wide.raw(wide(static_cast<long double>(a) * b)), (1 << 30) - 1);
}

// With an ulp of 2^60 the remainder 1 - 2^-60 does not fit 53 bits, nor do the terms of a sum that spans 150
// places, nor a quotient of 2^70: all of them are narrowed right nevertheless.
TEST(Quantize, WhatNoSingleDoubleHolds) {
  const Format f{8, 68, true, Rounding::trn, Overflow::sat, false};
  const double a = 0x1p30 + 1;
  const double b = 0x1p30 - 1;
  const Quantizer<double> q(f);
  EXPECT_EQ(q.raw(q.product(a, b)), 0);
  EXPECT_EQ(q.raw(q.sum(exact_product(a, b), 1.0)), 1);
  EXPECT_EQ(q.raw(q.sum(0x1p60, -0x1p-90)), 0);
  EXPECT_EQ(q.raw(q.sum(exact_product(a, b), 1.0, -0x1p-90)), 0);
  EXPECT_EQ(q.raw(q.quotient(0x1p70, 1.0)), 127);
  const Quantizer<double> wrapped(Format{8, 8, false, Rounding::trn, Overflow::wrap, false});
  EXPECT_EQ(wrapped.raw(wrapped.quotient(0x1p70 + 0x1p20, 3.0)), 0xaa);
  EXPECT_EQ(wrapped.raw(wrapped.sum(0x1p60, 3.0)), 3);
  EXPECT_EQ(wrapped.raw(wrapped.sum(exact_product(a, b), -3.0)), 252);  // 2^60 - 4
}

// Numerators and denominators that are pairs, against exact rationals.
TEST(Quantize, QuotientsOfPairs) {
  Draw draw(13);
  for (int round = 0; round < 2000; ++round) {
    const auto pair = [&](int bits) {
      const double x = static_cast<double>(draw.integer(-(std::int64_t{1} << bits), std::int64_t{1} << bits));
      const double y = static_cast<double>(draw.integer(1, std::int64_t{1} << bits));
      return exact_product(x, y);
    };
    const auto rational = [](const Pair<double>& x) {
      return test::rational_of(x.high) + test::rational_of(x.low);
    };
    const Pair<double> n = pair(static_cast<int>(draw.integer(1, 32)));
    Pair<double> d = pair(static_cast<int>(draw.integer(1, 32)));
    if (d.high == 0) d.high = 1;
    Format f{24, 20, true};
    f.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
    f.overflow = static_cast<Overflow>(draw.integer(0, overflow_modes - 1));
    const Quantizer<double> q(f);
    ASSERT_EQ(Int(q.raw(q.quotient(n, d))), oracle_raw(f, rational(n) / rational(d))) << describe(f);
  }
}

TEST(Quantize, CheckedRefusesWhatIsRounded) {
  EXPECT_THROW(Checked<double>(0x1p53) + Checked<double>(1), InexactError);
  EXPECT_THROW(Checked<long double>(0x1p64L) + Checked<long double>(1.0L), InexactError);
  EXPECT_THROW(Checked<Quad>(pow2<Quad>(113)) + Checked<Quad>(1), InexactError);
  EXPECT_THROW(Checked<double>((std::int64_t{1} << 53) + 1), InexactError);
  EXPECT_NO_THROW(Checked<double>(0x1p53) + Checked<double>(2));
  EXPECT_NO_THROW(Checked<Quad>(pow2<Quad>(56) + 1) * Checked<Quad>(pow2<Quad>(56) - 1));
  EXPECT_THROW(Checked<Quad>(pow2<Quad>(57) + 1) * Checked<Quad>(pow2<Quad>(57) - 1), InexactError);
}

TEST(Quantize, RawValuesAreIntegersOrAnError) {
  const Quantizer<long double> q(Format{64, 64, true});
  EXPECT_EQ(q.raw(-0x1p63L), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(q.raw(0x1p63L - 1), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(q.raw(-3.0L), -3);
  EXPECT_THROW(q.raw(0x1p63L), std::logic_error);
  EXPECT_THROW(q.raw(0.5L), std::logic_error);
  EXPECT_THROW(to_integer(1.5), std::logic_error);
  EXPECT_THROW(to_integer(Quad(0.25)), std::logic_error);
}

}  // namespace
}  // namespace bitspan::test
