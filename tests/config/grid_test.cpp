// SPDX-License-Identifier: Apache-2.0
// The algebra of widths against every value of small grids.
#include "config/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace bitspan {
namespace {

double least(Grid g) { return g.is_signed ? -std::ldexp(1.0, g.integer) : 0; }
double most(Grid g) { return std::ldexp(1.0, g.integer) - std::ldexp(1.0, -g.fraction); }

bool holds(Grid g, double x) {
  const double raw = std::ldexp(x, g.fraction);
  return raw == std::floor(raw) && x >= least(g) && x <= most(g);
}

// Grids of up to four bits.
std::vector<Grid> small_grids() {
  std::vector<Grid> grids;
  for (const bool is_signed : {false, true}) {
    for (int integer = -1; integer <= 2; ++integer) {
      for (int fraction = -integer; fraction <= 4 - integer - (is_signed ? 1 : 0); ++fraction)
        grids.push_back({integer, fraction, is_signed});
    }
  }
  return grids;
}

std::vector<double> values(Grid g) {
  std::vector<double> list;
  for (double x = least(g); x <= most(g); x += std::ldexp(1.0, -g.fraction)) list.push_back(x);
  return list;
}

TEST(Grid, HoldsTwoToTheNumberOfItsBits) {
  for (const Grid g : small_grids()) EXPECT_EQ(values(g).size(), std::size_t{1} << g.bits());
}

TEST(Grid, OfAFormatHoldsItsRange) {
  EXPECT_EQ(grid_of({8, 3, true}), (Grid{2, 5, true}));
  EXPECT_EQ(grid_of({8, 3, false}), (Grid{3, 5, false}));
  EXPECT_EQ(grid_of({4, -2, true}).bits(), 4);
}

TEST(Grid, HoldsEverySumDifferenceAndProduct) {
  for (const Grid a : small_grids()) {
    for (const Grid b : small_grids()) {
      for (const double x : values(a)) {
        for (const double y : values(b)) {
          ASSERT_TRUE(holds(a + b, x + y)) << x << " + " << y;
          ASSERT_TRUE(holds(a - b, x - y)) << x << " - " << y;
          ASSERT_TRUE(holds(a * b, x * y)) << x << " * " << y;
        }
      }
    }
  }
}

// No operation gives a bit away where both operands are of one grid and have bits at all.
TEST(Grid, HoldsNoMoreThanOneBitTooMuch) {
  for (const Grid a : small_grids()) {
    if (a.bits() < 2) continue;
    const auto narrower = [](Grid g) { return Grid{g.integer - 1, g.fraction, g.is_signed}; };
    EXPECT_FALSE(holds(narrower(a + a), most(a) + most(a)));
    EXPECT_FALSE(holds(narrower(a - a), most(a) - least(a)));
    const double farthest = a.is_signed ? least(a) : most(a);
    EXPECT_FALSE(holds(narrower(a * a), farthest * farthest));
  }
}

TEST(Grid, KeepsItsValuesWhereTheNotationChanges) {
  for (const Grid a : small_grids()) {
    for (const double x : values(a)) {
      EXPECT_TRUE(holds(as_signed(a), x));
      EXPECT_EQ(holds(positive(a), x), x >= 0);
      EXPECT_TRUE(holds(aligned(a, a.fraction + 3), x));
      EXPECT_EQ(aligned(a, a.fraction - 3), a);
      for (const int e : {-3, 0, 2}) EXPECT_TRUE(holds(scaled(a, e), std::ldexp(x, -e)));
      EXPECT_EQ(scaled(a, 2).bits(), a.bits());
    }
  }
}

// 2^e <= d < 2^(e+1): the least and the largest e that occur.
TEST(Grid, ExponentsAreThoseOfTheOperands) {
  Reciprocal unit;
  for (const Grid a : small_grids()) {
    if (a.is_signed || a.bits() < 1) continue;
    Exponents found{100, -100};
    for (const double d : values(a)) {
      if (d == 0) continue;
      found.low = std::min(found.low, std::ilogb(d));
      found.high = std::max(found.high, std::ilogb(d));
    }
    unit.normalize = true;
    EXPECT_EQ(exponents_of(unit, a).low, found.low);
    EXPECT_EQ(exponents_of(unit, a).high, found.high);
    unit.normalize = false;
    EXPECT_EQ(exponents_of(unit, a).low, 0);
    EXPECT_EQ(exponents_of(unit, a).high, 0);
  }
}

}  // namespace
}  // namespace bitspan
