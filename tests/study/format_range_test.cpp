// SPDX-License-Identifier: Apache-2.0
// Intervals and the rounding errors of formats, which the bounds are made of.
#include "study/bounds/format_range.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scene/random.hpp"

namespace bitspan {
namespace {

TEST(FormatRange, IntervalsHoldTheExactResult) {
  Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const auto draw = [&] {
      const double x = random.uniform(-8, 8);
      return Interval(x, x + (random.chance(0.3) ? 0 : random.unit()));
    };
    const Interval a = draw();
    const Interval b = draw();
    const auto inside = [&](Interval x) { return std::lerp(x.lo, x.hi, random.unit()); };
    const long double p = std::clamp(inside(a), a.lo, a.hi);
    const long double q = std::clamp(inside(b), b.lo, b.hi);
    const auto expect = [](Interval result, long double exact) {
      EXPECT_LE(static_cast<long double>(result.lo), exact);
      EXPECT_GE(static_cast<long double>(result.hi), exact);
    };
    expect(a + b, p + q);
    expect(a - b, p - q);
    expect(a * b, p * q);
    expect(square(a), p * p);
    if (b.lo > 0 || b.hi < 0) {
      expect(a / b, p / q);
    } else {
      EXPECT_THROW(a / b, std::logic_error);
    }
  }
}

TEST(FormatRange, RoundingErrorsAreThoseOfTheFormats) {
  Random random(9);
  for (int mode = 0; mode < rounding_modes; ++mode) {
    const Format f{12, 6, true, static_cast<Rounding>(mode), Overflow::sat, false};
    for (const int grid : {6, 7, 9, 20}) {
      const Interval allowed = bounds::rounding(f, grid);
      double least = 0;
      double most = 0;
      for (int i = 0; i < 4000; ++i) {
        const double x = std::ldexp(static_cast<double>(random.integer(-31 << grid, 31 << grid)), -grid);
        const double error = bounds::quantised(x, f) - x;
        EXPECT_TRUE(allowed.holds(error)) << mode << " " << grid << " " << x;
        least = std::min(least, error);
        most = std::max(most, error);
      }
      if (grid == 7 ||
          grid == 9) {  // all rests occur: no wider than needed, one end of a rounding to nearest apart
        EXPECT_LE(std::min(allowed.hi - most, least - allowed.lo), 1e-15);
        EXPECT_LE(std::max(allowed.hi - most, least - allowed.lo), std::ldexp(1.0, -grid));
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
