// SPDX-License-Identifier: Apache-2.0
// Quotients against exact rationals.
#include "model/numeric/ratio.hpp"

#include <gtest/gtest.h>

#include "tests/numeric/modes.hpp"
#include "tests/numeric/rational.hpp"

namespace bitspan {
namespace {

using model::Exact;
using model::int128;
using reference::Rational;

Rational rational(Exact e) { return Rational{reference::to_integer(e.raw)} * reference::two_to(-e.fraction); }

TEST(Ratio, ExhaustiveSmallQuotientsInAllModes) {
  for (const bool is_signed : {false, true}) {
    for_all_modes(5, 3, is_signed, [&](const Format& f) {
      const model::Register r = model::make_register(f);
      for (int n = -40; n <= 40; ++n) {
        for (int d = -12; d <= 12; ++d) {
          if (d != 0) {
            ASSERT_EQ(model::quantize_ratio(Exact{n, 0}, Exact{d, 0}, r, model::NoObserve{}),
                      reference::quantize(Rational{n} / Rational{d}, f))
                << n << " / " << d;
          }
        }
      }
    });
  }
}

// Numerators that fit 127 bits after scaling, numerators that do not, and quotients with more bits than kept.
TEST(Ratio, RandomUpTo127Bits) {
  std::mt19937_64 random(11);
  int lengthy = 0;
  int dropped = 0;
  for (int i = 0; i < 300000; ++i) {
    const Format f = random_format(random);
    const Exact n{random_value(random, 126), random_int(random, -40, 150)};
    Exact d{random_value(random, 126), random_int(random, -40, 150)};
    d.raw = d.raw == 0 ? 1 : d.raw;
    const int shift = f.fraction() + d.fraction - n.fraction;
    lengthy += shift > 64 ? 1 : 0;
    dropped += shift < 0 ? 1 : 0;
    ASSERT_EQ(model::quantize_ratio(n, d, model::make_register(f), model::NoObserve{}),
              reference::quantize(rational(n) / rational(d), f))
        << "case " << i << ", shift " << shift;
  }
  EXPECT_GT(lengthy, 10000);
  EXPECT_GT(dropped, 10000);
}

TEST(Ratio, FloorDivideIsTheFloor) {
  for (int n = -50; n <= 50; ++n) {
    for (int d = 1; d <= 9; ++d) {
      const auto q = model::floor_divide(n, d);
      EXPECT_EQ(q.floor * d + q.rest, n);
      EXPECT_TRUE(q.rest >= 0 && q.rest < d);
    }
  }
}

}  // namespace
}  // namespace bitspan
