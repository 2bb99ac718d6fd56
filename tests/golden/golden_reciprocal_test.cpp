// SPDX-License-Identifier: Apache-2.0
// The reciprocal units against the text of docs/numeric-spec.md on exact rationals.
#include <gtest/gtest.h>

#include <algorithm>

#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "tests/golden/golden_support.hpp"
#include "tests/support/reciprocal_definition.hpp"

namespace bitspan::test {
namespace {

using namespace bitspan::golden;

template <class Real>
void compare(std::uint64_t seed, int operand_bits) {
  Draw draw(seed);
  for (int round = 0; round < 300; ++round) {
    Reciprocal unit;
    unit.kind = static_cast<ReciprocalKind>(draw.integer(0, reciprocal_kinds - 1));
    unit.normalize = draw.flip();
    unit.operand_bits = static_cast<int>(draw.integer(4, 18));
    unit.index_bits = static_cast<int>(draw.integer(1, 6));
    unit.table_bits = static_cast<int>(draw.integer(4, 14));
    unit.internal_bits = static_cast<int>(draw.integer(6, 22));
    unit.steps = static_cast<int>(draw.integer(1, 3));
    unit.output.integer = unit.normalize ? 1 : static_cast<int>(draw.integer(1, 6));
    unit.output.word = unit.output.integer + static_cast<int>(draw.integer(6, 22));
    unit.output.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
    unit.output.overflow = static_cast<Overflow>(draw.integer(0, 2));
    const int grid = static_cast<int>(draw.integer(0, 6));
    const ReciprocalUnit<Real> r(unit, grid);
    for (int i = 0; i < 60; ++i) {
      std::int64_t d = draw.integer(-2, std::int64_t{1} << draw.integer(1, operand_bits));
      if (i < 20) d = (std::int64_t{1} << i) - draw.integer(-1, 1);  // around powers of two
      const Inverse<Real> got = r(Real(d) * pow2<Real>(-grid));
      const Rational operand = scale(Rational(Int(std::max<std::int64_t>(d, 1))), -grid);
      const ReciprocalByDefinition want = reciprocal_by_definition(unit, operand);
      ASSERT_EQ(Int(r.raw(got.m)), oracle_raw(unit.output, want.value))
          << "kind " << static_cast<int>(unit.kind) << " d " << d;
      ASSERT_EQ(got.e, want.e);
    }
  }
}

TEST(GoldenReciprocal, DoubleEqualsTheSpecification) { compare<Checked<double>>(21, 24); }
TEST(GoldenReciprocal, LongDoubleEqualsTheSpecification) { compare<Checked<long double>>(22, 34); }
TEST(GoldenReciprocal, QuadEqualsTheSpecification) { compare<Checked<Quad>>(23, 40); }

TEST(GoldenReciprocal, TableByHand) {
  Reciprocal unit;
  unit.index_bits = 1;
  unit.table_bits = 4;
  unit.kind = ReciprocalKind::lut_linear;
  EXPECT_EQ(reciprocal_table(unit), (std::vector<std::int64_t>{16, 11, 8}));  // 16/1, 16/1.5 = 10.67, 16/2
  unit.kind = ReciprocalKind::lut_newton;
  EXPECT_EQ(reciprocal_table(unit), (std::vector<std::int64_t>{13, 9}));  // 16/1.25 = 12.8, 16/1.75 = 9.14
  // 16/1, 16/1.5; 16 (3/1 - 4/1.25 + 1/1.5) = 7.47, 16 (3/1.5 - 4/1.75 + 1/2) = 3.43; 16 (2/1 - 4/1.25 +
  // 2/1.5) = 2.13, 16 (2/1.5 - 4/1.75 + 2/2) = 0.76.
  unit.kind = ReciprocalKind::lut_quadratic;
  EXPECT_EQ(reciprocal_table(unit), (std::vector<std::int64_t>{16, 11, 7, 3, 2, 1}));
  unit.kind = ReciprocalKind::restoring;
  EXPECT_TRUE(reciprocal_table(unit).empty());
}

TEST(GoldenReciprocal, SlopeInBothForms) {
  const Format steps{20, 10, true, Rounding::trn, Overflow::sat, false};
  Reciprocal unit;
  unit.output = {5, 1, false, Rounding::trn, Overflow::sat, false};
  const ReciprocalUnit<double> r(unit, 4);
  const Quantizer<double> q(steps);
  // 7 / 3 = 2.333..: floor(2.333 * 1024) / 1024; by the reciprocal 1/3 = 0.6666 2^-1, cut to 10/16.
  EXPECT_EQ(q.raw(Divisor<double>(3.0, SlopeForm::divide, r).slope(7.0, q)), 2389);
  EXPECT_EQ(q.raw(Divisor<double>(3.0, SlopeForm::reciprocal, r).slope(7.0, q)), 7 * 10 * 1024 / 32);
}

}  // namespace
}  // namespace bitspan::test
