// SPDX-License-Identifier: Apache-2.0
// Reciprocal units against their definition in docs/numeric-spec.md, on exact rationals.
#include "model/numeric/reciprocal.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/numeric/modes.hpp"
#include "tests/numeric/rational.hpp"
#include "tests/support/reciprocal_definition.hpp"

namespace bitspan {
namespace {

using model::int128;
using reference::Integer;
using reference::Rational;
using reference::two_to;

Reciprocal base(ReciprocalKind kind) {
  Reciprocal c;
  c.kind = kind;
  c.operand_bits = 12;
  c.index_bits = 4;
  c.table_bits = 9;
  c.internal_bits = 14;
  c.steps = 2;
  c.output = {12, 1, false, Rounding::rnd, Overflow::sat, false};
  return c;
}

void expect_equal(const Reciprocal& c, const model::ReciprocalUnit& unit, int128 raw, int fraction) {
  const model::Inverse got = unit(raw, fraction, model::NoObserve{});
  const Integer operand = raw <= 0 ? Integer{1} : reference::to_integer(raw);
  const ReciprocalByDefinition want = reciprocal_by_definition(c, Rational{operand} * two_to(-fraction));
  ASSERT_EQ(got.m, reference::quantize(want.value, c.output)) << "operand " << operand << " 2^-" << fraction;
  ASSERT_EQ(got.e, want.e) << "operand " << operand << " 2^-" << fraction;
}

std::vector<ReciprocalKind> all_kinds() {
  std::vector<ReciprocalKind> kinds;
  for (int i = 0; i < reciprocal_kinds; ++i) kinds.push_back(static_cast<ReciprocalKind>(i));
  return kinds;
}

TEST(Reciprocal, ExhaustiveAtSmallWidths) {
  for (const ReciprocalKind kind : all_kinds()) {
    for (const bool normalize : {true, false}) {
      for_all_modes(10, 1, false, [&](const Format& output) {
        Reciprocal c = base(kind);
        c.normalize = normalize;
        c.output = output;
        if (!normalize) {
          c.output.word = 12;
          c.output.integer = 3;
        }
        const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
        for (int raw = -2; raw <= 260; ++raw) {
          expect_equal(c, unit, raw, 3);
        }
      });
    }
  }
}

// All operands of one binade and its neighbours: every table entry, both ends of each interval.
TEST(Reciprocal, EveryTableEntry) {
  for (const ReciprocalKind kind : all_kinds()) {
    const Reciprocal c = base(kind);
    const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
    for (int raw = (1 << 12) - 3; raw <= (1 << 13) + 3; ++raw) {
      expect_equal(c, unit, raw, 20);
    }
  }
}

// Around every power of two up to 100 bits, where the exponent changes and the mantissa is at its ends.
TEST(Reciprocal, AroundPowersOfTwo) {
  for (const ReciprocalKind kind : all_kinds()) {
    for (const bool normalize : {true, false}) {
      Reciprocal c = base(kind);
      c.normalize = normalize;
      c.output = normalize ? Format{20, 1, false, Rounding::trn, Overflow::sat, false}
                           : Format{50, 4, false, Rounding::rnd_conv, Overflow::sat, false};
      const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
      for (int bits = 1; bits <= 100; ++bits) {
        for (int d = -2; d <= 2; ++d) {
          expect_equal(c, unit, (int128{1} << bits) + d, 10);
        }
      }
    }
  }
}

TEST(Reciprocal, RandomParameters) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 400; ++i) {
    Reciprocal c = base(static_cast<ReciprocalKind>(i % reciprocal_kinds));
    c.normalize = random_int(random, 0, 1) != 0;
    c.operand_bits = random_int(random, 2, 40);
    c.index_bits = random_int(random, 1, std::min(9, c.operand_bits));
    c.table_bits = random_int(random, 2, 40);
    c.internal_bits = random_int(random, 2, 44);
    c.steps = random_int(random, 0, 4);
    c.output = random_format(random);
    c.output.word = std::max(2, c.output.word / 2);
    c.output.integer = c.normalize ? 1 : random_int(random, 1, 10);
    const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
    for (int k = 0; k < 60; ++k) {
      expect_equal(c, unit, random_value(random, 62), random_int(random, -5, 30));
    }
  }
}

// The exact kind rounded down is the floor: m d <= 2^(F+top) < (m + 1) d.
TEST(Reciprocal, RestoringIsTheExactFloor) {
  Reciprocal c = base(ReciprocalKind::restoring);
  c.output = {19, 1, false, Rounding::trn, Overflow::sat, false};
  const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
  std::mt19937_64 random(6);
  for (int i = 0; i < 100000; ++i) {
    const auto d = static_cast<std::int64_t>(random() >> random_int(random, 20, 63)) | 1;
    const model::Inverse r = unit(d, 0, model::NoObserve{});
    const int128 one = int128{1} << (18 + r.e);
    ASSERT_LE(int128{r.m} * d, one);
    ASSERT_GT((int128{r.m} + 1) * d, one);
  }
}

// The kinds with tables are approximations: how far off, at parameters that suit 18 bits.
TEST(Reciprocal, TablesAreAccurate) {
  Reciprocal linear = base(ReciprocalKind::lut_linear);
  linear.operand_bits = 20;
  linear.index_bits = 9;
  linear.table_bits = 20;
  linear.internal_bits = 20;
  linear.output = {20, 1, false, Rounding::trn, Overflow::sat, false};
  Reciprocal newton = linear;
  newton.kind = ReciprocalKind::lut_newton;
  newton.table_bits = 12;
  newton.internal_bits = 24;
  newton.steps = 1;
  for (const Reciprocal& c : {linear, newton}) {
    const model::ReciprocalUnit unit(c, model::RegisterId::pixel_reciprocal);
    for (int d = 1 << 16; d <= 1 << 17; ++d) {
      const model::Inverse r = unit(d, 16, model::NoObserve{});
      const double product = static_cast<double>(r.m) / (1 << 19) / (1 << r.e) * d / (1 << 16);
      ASSERT_NEAR(product, 1.0, 1.0 / (1 << 17)) << d;
    }
  }
}

}  // namespace
}  // namespace bitspan
