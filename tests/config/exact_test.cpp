// SPDX-License-Identifier: Apache-2.0
// The widths of exact intermediates: against values found by hand, and against the extremes themselves.
#include "config/exact.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "config/check.hpp"
#include "tests/config/support.hpp"

namespace bitspan {
namespace {

using F = FormatId;

const ExactIntermediate& find(const std::vector<ExactIntermediate>& list, const std::string& stage,
                              const std::string& expression) {
  const auto found = std::ranges::find_if(list, [&](const ExactIntermediate& x) {
    return x.stage == stage && x.expression.starts_with(expression);
  });
  if (found == list.end()) throw std::out_of_range(stage + ": " + expression);
  return *found;
}

// Bits of the smallest signed integer type that holds lo..hi on the grid of 2^-fraction.
int bits_of(long double lo, long double hi, int fraction) {
  int bits = 1;
  while (std::ldexp(hi, fraction) > std::ldexp(1.0L, bits - 1) - 1 ||
         std::ldexp(lo, fraction) < -std::ldexp(1.0L, bits - 1)) {
    ++bits;
  }
  return bits;
}

long double most(const Format& f) {
  return (std::ldexp(1.0L, f.is_signed ? f.word - 1 : f.word) - 1) * std::ldexp(1.0L, -f.fraction());
}
long double least(const Format& f) { return f.is_signed ? -std::ldexp(1.0L, f.integer - 1) : 0; }

// Small formats, so that extremes are exact in a long double.
Config small() {
  Config c = shipped_config("depth16");
  c.format(F::setup_uv) = {12, 9, true};
  c.format(F::edge_uv) = {12, 9, true};
  c.format(F::setup_h) = {14, 8, false};
  c.format(F::edge_h) = {14, 8, false};
  c.format(F::setup_b) = {12, 5, false};
  c.format(F::span_h) = {13, 8, false};
  c.format(F::span_h_step) = {15, 10, true};
  c.format(F::span_f_diff) = {9, 12, true};
  return c;
}

TEST(Exact, CoversTheExtremesAndWastesAtMostTwoBits) {
  const Config c = small();
  const auto list = exact_intermediates(c);
  const Format uv = c.format(F::edge_uv);
  const long double q = most(c.format(F::edge_h)) + most(c.format(F::setup_b));
  const int diff = bits_of((least(uv) - most(uv)) * q, (most(uv) - least(uv)) * q, 3 + 7);
  const int claimed_diff = find(list, "span_setup", "fu_diff").bits;
  EXPECT_GE(claimed_diff, diff);
  EXPECT_LE(claimed_diff, diff + 2);

  const Format h = c.format(F::span_h);
  const Format step = c.format(F::span_h_step);
  const int sum = bits_of(least(step), most(h) + most(step), 5);
  const int claimed_sum = find(list, "span", "h + h_step").bits;
  EXPECT_GE(claimed_sum, sum);
  EXPECT_LE(claimed_sum, sum + 2);

  const int channel = bits_of(-255.0L * most(c.format(F::fog_factor)),
                              most(c.format(F::texture_color)) * most(c.format(F::fog_factor)) + 255,
                              c.format(F::texture_color).fraction() + c.format(F::fog_factor).fraction());
  const int claimed_channel = find(list, "fog", "r = VT_r").bits;
  EXPECT_GE(claimed_channel, channel);
  EXPECT_LE(claimed_channel, channel + 3);
}

TEST(Exact, CoversThePixelProductOverAllExponents) {
  const Config c = small();
  const Format uv = c.format(F::edge_uv);
  const Format f = c.format(F::span_f);
  const Format m = c.pixel_reciprocal.output;
  const long double q = most(c.format(F::span_h)) + most(c.format(F::setup_b));
  int widest = 0;
  for (int e = -7; std::ldexp(1.0L, e) <= q; ++e) {
    const int fraction =
        std::max({uv.fraction(), f.fraction() + m.fraction() + e, c.format(F::span_uv).fraction()});
    const long double scale = std::ldexp(1.0L, -e);
    widest = std::max(widest, bits_of(least(uv) + least(f) * most(m) * scale,
                                      most(uv) + most(f) * most(m) * scale, fraction));
  }
  const int claimed = find(exact_intermediates(c), "span", "u = u1 + fu m 2^-e").bits;
  EXPECT_GE(claimed, widest);
  EXPECT_LE(claimed, widest + 3);
}

TEST(Exact, QuotientsAreScaledToTheLastKeptPlace) {
  Config c = shipped_config("depth16");
  c.perspective = Perspective::hyperbolic;
  // fu 42 bits with fraction 8; h + B has fraction 20; span.uv fraction 8: the numerator is shifted by 8 - 8
  // + 20.
  EXPECT_EQ(find(exact_intermediates(c), "span", "u = fu / (h + B)").bits, 42 + 20);
}

TEST(Exact, ListsTheStagesOfTheMode) {
  for (const Perspective mode : all_perspectives) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    std::set<std::string> stages;
    for (const ExactIntermediate& x : exact_intermediates(c)) {
      stages.insert(x.stage);
      EXPECT_GT(x.bits, 0) << x.expression;
      EXPECT_FALSE(x.key.empty()) << x.expression;
    }
    const bool planes = mode == Perspective::const_depth_rows;
    EXPECT_EQ(stages.contains("plane_walk"), planes);
    EXPECT_EQ(stages.contains("edge_walk"), !planes);
    EXPECT_EQ(stages.contains("setup.edge"), !planes);
    for (const char* stage :
         {"constants", "setup", "span_setup", "span", "depth", "texture", "fog", "merge"}) {
      EXPECT_TRUE(stages.contains(stage)) << stage;
    }
  }
}

TEST(Exact, TooWideIsRefusedNamingStageExpressionAndFormats) {
  Config c = shipped_config("depth16");
  c.format(F::span_f) = {64, 40, true};
  c.format(F::edge_uv) = {60, 50, true};
  c.pixel_reciprocal.output = {40, 1, false, Rounding::rnd, Overflow::sat, false};
  const auto v = first_violation(c);
  ASSERT_TRUE(v.has_value());
  EXPECT_EQ(v->key, "formats.span.uv");
  EXPECT_NE(v->text.find("stage span: the exact value of `u = u1 + fu m 2^-e` takes "), std::string::npos)
      << v->text;
  EXPECT_NE(v->text.find("span.f fixed<64,40>"), std::string::npos) << v->text;
  EXPECT_NE(v->text.find("reciprocal.pixel.output ufixed<40,1>"), std::string::npos) << v->text;
  EXPECT_NE(v->text.find("legal: at most 127"), std::string::npos) << v->text;
}

TEST(Exact, TheLimitIsSharp) {
  // Widens one format a bit at a time: accepted as long as, and only as long as, the list stays within the
  // limit.
  for (const F id : {F::setup_b, F::setup_s, F::edge_f_step, F::span_f, F::span_h_step, F::edge_uv}) {
    Config c = shipped_config("depth20");
    const int most_word = c.format(id).is_signed ? 64 : 63;
    for (; c.format(id).word <= most_word; ++c.format(id).word) {
      const auto list = exact_intermediates(c);
      const bool fits = std::ranges::all_of(list, [](const auto& x) { return x.bits <= exact_bits_limit; });
      EXPECT_EQ(!first_violation(c).has_value(), fits) << key_of(id) << " " << c.format(id).word;
    }
  }
  Config c = shipped_config("depth20");
  c.format(F::setup_b) = {63, 20, false, Rounding::rnd, Overflow::sat, false};
  c.format(F::setup_s) = {63, 1, false, Rounding::rnd, Overflow::sat, false};
  EXPECT_TRUE(first_violation(c).has_value());
}

TEST(Exact, ReciprocalUnitsAreCounted) {
  Config c = shipped_config("depth20");
  c.pixel_reciprocal.operand_bits = 60;
  c.pixel_reciprocal.internal_bits = 60;
  const int nq = find(exact_intermediates(c), "reciprocal.pixel", "nq y").bits;
  EXPECT_EQ(nq, 60 + 60 + 3);
  EXPECT_EQ(find(exact_intermediates(c), "reciprocal.pixel", "y (2 - a)").bits, 60 + 60 + 4);
  EXPECT_FALSE(first_violation(c).has_value());
}

}  // namespace
}  // namespace bitspan
