// SPDX-License-Identifier: Apache-2.0
// The columns of golden/lanes against Quantizer<double>, which is checked against exact rationals, value by
// value.
#include "golden/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "golden/quantize.hpp"
#include "golden/reciprocal.hpp"
#include "tests/golden/golden_support.hpp"

namespace bitspan::test {
namespace {

using namespace bitspan::golden;

Format random_format(Draw& draw) {
  Format f{static_cast<int>(draw.integer(2, 40)), 0, draw.flip()};
  f.integer = f.word - static_cast<int>(draw.integer(-2, 24));
  f.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
  f.overflow = static_cast<Overflow>(draw.integer(0, overflow_modes - (f.is_signed ? 1 : 2)));
  return f;
}

// Integers of up to `bits` bits times 2^-fraction, many of them on ties.
Column random_column(Draw& draw, int bits, int fraction) {
  Column out;
  for (double& x : out.at) {
    x = std::ldexp(static_cast<double>(static_cast<std::int64_t>(draw.wide_integer(bits))), -fraction);
    if (draw.integer(0, 3) == 0) x = std::floor(x) + 0.5;
  }
  return out;
}

// `quick` is a form of lanes_narrow, `slow` gives the value of one lane. A column that it vouches for is
// equal.
template <class Quick, class Slow>
void compare(const Format& f, const Quick& quick, const Slow& slow, int& held, const char* what) {
  const LaneFormat lane_format(f);
  const bool has_form = f.rounding != Rounding::rnd_conv && f.rounding != Rounding::trn_zero;
  ASSERT_EQ(lane_format.usable, has_form);
  if (!has_form) return;
  const Quantizer<double> q(f);
  Column out;
  for (const std::size_t n : {std::size_t{1}, std::size_t{7}, lanes}) {
    if (quick(lane_format, n, out) != 0) continue;
    ++held;
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(out.at[i], static_cast<double>(q.raw(slow(q, i))))
          << what << " lane " << i << " rounding " << static_cast<int>(f.rounding) << " overflow "
          << static_cast<int>(f.overflow) << " word " << f.word;
    }
  }
}

TEST(Lanes, EqualTheQuantizer) {
  Draw draw(51);
  std::array<int, 7> held{};
  for (int round = 0; round < 1500; ++round) {
    const Format f = random_format(draw);
    const double to_ulps = std::ldexp(1.0, f.fraction());
    const int bits = static_cast<int>(draw.integer(2, 26));
    const int fraction = static_cast<int>(draw.integer(0, 20));
    const Column a = random_column(draw, bits, fraction);
    const Column b = random_column(draw, static_cast<int>(draw.integer(1, 24)), 10);
    const Column c = random_column(draw, 20, 6);
    Column positive = b;
    for (double& x : positive.at) x = std::fabs(x) + 0.25;
    Column share;
    for (double& x : share.at) x = static_cast<double>(draw.integer(0, 256));
    Column powers;
    for (double& x : powers.at) x = std::ldexp(1.0, static_cast<int>(draw.integer(-30, 3)));
    using Q = Quantizer<double>;
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) { return lanes_narrow(a, to_ulps, q, n, out); },
        [&](const Q& q, std::size_t i) { return q(a.at[i]); }, held[0], "narrow");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_less(3 * to_ulps, a, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) { return q.sum(3.0, -a.at[i]); }, held[1], "less");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_product(a, b, powers, to_ulps, c, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) {
          return q.sum(exact_product(a.at[i], b.at[i]).scaled(powers.at[i]), c.at[i]);
        },
        held[2], "product");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_short(a, b, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) { return q(a.at[i] * b.at[i]); }, held[3], "short");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_mix(a, c, share, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) { return q.sum(a.at[i] * (1 - share.at[i]), c.at[i] * share.at[i]); },
        held[4], "mix");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_toward(c, a, share, 0x1p-8, 256, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) {
          if (share.at[i] >= 256) return q(a.at[i]);
          return q.sum(c.at[i], (a.at[i] - c.at[i]) * (share.at[i] * 0x1p-8));
        },
        held[5], "toward");
    compare(
        f,
        [&](const LaneFormat& q, std::size_t n, Column& out) {
          return lanes_narrow_quotient(a, positive, to_ulps, q, n, out);
        },
        [&](const Q& q, std::size_t i) { return q.quotient(a.at[i], positive.at[i]); }, held[6], "quotient");
    if (HasFatalFailure()) return;
  }
  for (const int count : held) EXPECT_GT(count, 1000);
}

// A value that wraps, a lost bit and a value beyond the quick floor are counted, each in its lane.
TEST(Lanes, CountWhatDoesNotHold) {
  const LaneFormat wraps(Format{8, 8, false, Rounding::rnd, Overflow::wrap, false});
  const LaneFormat saturates(Format{8, 8, false, Rounding::rnd, Overflow::sat, false});
  Column x{};
  x.at[3] = 255.5;
  Column out;
  EXPECT_EQ(lanes_narrow(x, 1, wraps, lanes, out), 1);
  EXPECT_EQ(lanes_narrow(x, 1, wraps, 3, out), 0);
  EXPECT_EQ(lanes_narrow(x, 1, saturates, lanes, out), 0);
  EXPECT_EQ(out.at[3], 255);
  x.at[3] = 0x1p52;
  EXPECT_EQ(lanes_narrow(x, 1, saturates, lanes, out), 1);
  Column a{};
  Column c{};
  Column ones;
  std::fill(std::begin(ones.at), std::end(ones.at), 1.0);
  a.at[5] = 0x1p50 + 1;
  c.at[5] = 0x1p-90;
  EXPECT_EQ(lanes_narrow_product(a, ones, ones, 1, c, 1, saturates, lanes, out), 0);
  c.at[6] = 0x1p-160;
  a.at[6] = 0x1p30 + 1;
  Column b = ones;
  b.at[6] = 0x1p-60 + 0x1p-100;
  EXPECT_EQ(lanes_narrow_product(a, b, ones, 1, c, 1, saturates, lanes, out), 1);
}

// The reciprocal unit over a column against its one value at a time.
TEST(Lanes, ReciprocalsEqualTheUnit) {
  Draw draw(52);
  int held = 0;
  for (int round = 0; round < 200; ++round) {
    Reciprocal unit;
    unit.kind = static_cast<ReciprocalKind>(draw.integer(0, 2));
    unit.normalize = draw.integer(0, 4) != 0;
    unit.operand_bits = static_cast<int>(draw.integer(10, 18));
    unit.index_bits = static_cast<int>(draw.integer(1, 8));
    unit.table_bits = static_cast<int>(draw.integer(4, 14));
    unit.internal_bits = static_cast<int>(draw.integer(6, 22));
    unit.steps = static_cast<int>(draw.integer(1, 3));
    unit.output.integer = unit.normalize ? 1 : 4;
    unit.output.word = unit.output.integer + static_cast<int>(draw.integer(6, 22));
    unit.output.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
    const ReciprocalUnit<double> r(unit, 8);
    Column d;
    for (double& x : d.at) x = std::ldexp(static_cast<double>(draw.integer(1, 1 << 24)), -8);
    Column m;
    Column power;
    std::array<std::int64_t, lanes> e{};
    if (!r.quick(d, lanes, m, power, e.data())) continue;
    ++held;
    for (std::size_t i = 0; i < lanes; ++i) {
      const Inverse<double> want = r(d.at[i]);
      ASSERT_EQ(m.at[i], static_cast<double>(r.raw(want.m))) << "kind " << static_cast<int>(unit.kind);
      ASSERT_EQ(e[i], want.e);
      ASSERT_EQ(power.at[i], std::ldexp(1.0, -want.e));
    }
  }
  EXPECT_GT(held, 50);
}

}  // namespace
}  // namespace bitspan::test
