// The proved error of reciprocal units against what they give.
#include "study/bounds/unit_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/numeric/reciprocal.hpp"
#include "scene/random.hpp"
#include "study/bounds/format_range.hpp"
#include "tests/support/reciprocal_definition.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using bounds::Unit;
using bounds::UnitError;

// m 2^-e d - 1 of d = raw 2^-fraction, in long double: d and m have few enough bits.
long double error_of(const model::ReciprocalUnit& unit, std::int64_t raw, int fraction) {
  const model::Inverse r = unit(raw, fraction, model::NoObserve{});
  const int scale = -unit.config().output.fraction() - r.e - fraction;
  return std::ldexp(static_cast<long double>(r.m) * static_cast<long double>(raw), scale) - 1;
}

// Every operand of `bits` bits with its top bit set.
struct Extremes {
  long double least = 0, most = 0;
};
Extremes of_all(const Reciprocal& config, int bits) {
  const model::ReciprocalUnit unit(config, model::RegisterId::pixel_reciprocal);
  Extremes out;
  for (std::int64_t raw = std::int64_t{1} << (bits - 1); raw < std::int64_t{1} << bits; ++raw) {
    const long double e = error_of(unit, raw, bits - 1);
    out.least = std::min(out.least, e);
    out.most = std::max(out.most, e);
  }
  return out;
}

void expect_inside(const Reciprocal& config, const Extremes& seen) {
  const UnitError proved = Unit(config).error({1, 2});
  EXPECT_FALSE(proved.any);
  // A long double's 64 bits are not quite exact.
  EXPECT_GE(seen.least, proved.relative.lo - 1e-18L);
  EXPECT_LE(seen.most, proved.relative.hi + 1e-18L);
}

Reciprocal table_unit(ReciprocalKind kind, int operand, int index, int table, int internal, int steps,
                      int word) {
  Reciprocal r;
  r.kind = kind;
  r.operand_bits = operand;
  r.index_bits = index;
  r.table_bits = table;
  r.internal_bits = internal;
  r.steps = steps;
  r.output = {word, 1, false, Rounding::rnd, Overflow::sat, false};
  return r;
}

TEST(UnitError, HoldsForEveryOperandAndIsNearlyReached) {
  // Each with one source of error that outweighs the others: the output, the table, the truncation after a
  // step, the operand's.
  const std::array<Reciprocal, 11> units{table_unit(ReciprocalKind::restoring, 0, 0, 0, 0, 0, 10),
                                         table_unit(ReciprocalKind::lut_newton, 15, 6, 10, 20, 1, 10),
                                         table_unit(ReciprocalKind::lut_newton, 15, 3, 12, 20, 1, 18),
                                         table_unit(ReciprocalKind::lut_newton, 15, 6, 12, 10, 2, 18),
                                         table_unit(ReciprocalKind::lut_newton, 9, 6, 12, 20, 2, 18),
                                         table_unit(ReciprocalKind::lut_newton, 15, 4, 8, 20, 0, 18),
                                         table_unit(ReciprocalKind::lut_linear, 15, 3, 16, 20, 0, 18),
                                         table_unit(ReciprocalKind::lut_linear, 15, 6, 16, 10, 0, 18),
                                         table_unit(ReciprocalKind::lut_quadratic, 15, 2, 18, 20, 0, 18),
                                         table_unit(ReciprocalKind::lut_quadratic, 15, 5, 11, 20, 0, 18),
                                         table_unit(ReciprocalKind::lut_quadratic, 15, 4, 18, 10, 0, 18)};
  for (const Reciprocal& unit : units) {
    SCOPED_TRACE(std::string(to_string(unit.kind)) + " " + std::to_string(unit.operand_bits) + " " +
                 std::to_string(unit.index_bits) + " " + std::to_string(unit.internal_bits) + " " +
                 std::to_string(unit.output.word));
    const Extremes seen = of_all(unit, 17);
    expect_inside(unit, seen);
    const double bound = Unit(unit).error({1, 2}).relative.mag();
    // The two truncations of a Newton step partly cancel.
    const bool cancels = unit.kind == ReciprocalKind::lut_newton && unit.internal_bits == 10;
    EXPECT_GT(std::max(-seen.least, seen.most), (cancels ? 0.45L : 0.75L) * bound) << bound;
  }
}

TEST(UnitError, HoldsForAnyUnit) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    Reciprocal r = table_unit(static_cast<ReciprocalKind>(random.integer(0, reciprocal_kinds - 1)), 0, 0, 0,
                              0, 0, static_cast<int>(random.integer(4, 20)));
    if (r.kind != ReciprocalKind::restoring) {
      r.index_bits = static_cast<int>(random.integer(1, 8));
      r.operand_bits = r.index_bits + static_cast<int>(random.integer(1, 8));
      r.table_bits = static_cast<int>(random.integer(3, 20));
      r.internal_bits = static_cast<int>(random.integer(4, 24));
    }
    if (r.kind == ReciprocalKind::lut_newton) r.steps = static_cast<int>(random.integer(0, 3));
    r.output.rounding = static_cast<Rounding>(random.integer(0, rounding_modes - 1));
    const bool narrow = random.chance(0.2);  // cannot hold 1: saturates
    r.output.integer = narrow ? 0 : 1;
    SCOPED_TRACE(i);
    expect_inside(r, of_all(r, 11));
  }
}

// One fixed-point number: the rounding counts by the operand, and small operands saturate.
TEST(UnitError, WithoutANormalisedResultTheOperandCounts) {
  Reciprocal r = table_unit(ReciprocalKind::restoring, 0, 0, 0, 0, 0, 18);
  r.normalize = false;
  r.output = {18, 2, false, Rounding::rnd, Overflow::sat, false};  // up to 4 by 2^-16
  const model::ReciprocalUnit unit(r, model::RegisterId::pixel_reciprocal);
  const Interval operands(1.0 / 16, 64);
  const UnitError proved = Unit(r).error(operands);
  EXPECT_FALSE(proved.any);
  for (std::int64_t raw = 64; raw <= 65536; ++raw) {
    const long double e = error_of(unit, raw, 10);
    EXPECT_GE(e, proved.relative.lo);
    EXPECT_LE(e, proved.relative.hi);
  }
  EXPECT_NEAR(proved.relative.lo, -0.75, 1e-4) << "4 instead of 16";
  EXPECT_NEAR(proved.relative.hi, 64 * std::ldexp(1.0, -17), 1e-6);
  r.output.overflow = Overflow::wrap;
  EXPECT_TRUE(Unit(r).error(operands).any);
  EXPECT_FALSE(Unit(r).error({0.5, 64}).any);
}

}  // namespace
}  // namespace bitspan
