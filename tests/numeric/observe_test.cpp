// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/observe.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "model/numeric/quantize.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan {
namespace {

using model::FieldStatistics;
using model::Observe;
using model::Register;
using model::Statistics;

constexpr std::int64_t ulp = std::int64_t{1} << model::bias_fraction;

Register observed(const Format& f) { return model::make_register(f, model::id_of(FormatId::span_h)); }

TEST(Observe, CountsRangeAndSaturations) {
  Statistics s;
  const Register r = observed({4, 4, true, Rounding::trn, Overflow::sat, false});  // -8..7
  for (const int v : {3, -8, 7, 8, -20}) {
    model::quantize(std::int64_t{v}, 0, r, Observe{&s});
  }
  const FieldStatistics& h = s.of(FormatId::span_h);
  EXPECT_EQ(h.count, 5U);
  EXPECT_EQ(h.saturations, 2U);
  EXPECT_EQ(h.wraps, 0U);
  EXPECT_EQ(h.min, -20);
  EXPECT_EQ(h.max, 8);
  EXPECT_EQ(h.bias, 0);
  EXPECT_EQ(model::used_bits(h, true), 6);  // -20 needs -32..31
  EXPECT_EQ(s.of(FormatId::span_f).count, 0U);
}

TEST(Observe, CountsWraps) {
  Statistics s;
  const Register r = observed({4, 4, false, Rounding::trn, Overflow::wrap, false});
  EXPECT_EQ(model::quantize(std::int64_t{17}, 0, r, Observe{&s}), 1);
  EXPECT_EQ(model::quantize(std::int64_t{-1}, 0, r, Observe{&s}), 15);
  EXPECT_EQ(s.of(FormatId::span_h).wraps, 2U);
  EXPECT_EQ(s.of(FormatId::span_h).saturations, 0U);
  EXPECT_EQ(model::used_bits(s.of(FormatId::span_h), false), 6);  // 17 and a sign, for -1
}

TEST(Observe, BiasOfTruncationAndOfRounding) {
  // 0, 1/4, 1/2, 3/4: floor loses 0 + 1 + 2 + 3 quarters; SC_RND gives 0 - 1 + 2 + 1.
  for (const auto& [mode, quarters] : {std::pair{Rounding::trn, -6}, std::pair{Rounding::rnd, 2}}) {
    Statistics s;
    const Register r = observed({8, 8, true, mode, Overflow::sat, false});
    for (int v = 0; v < 4; ++v) {
      model::quantize(std::int64_t{v}, 2, r, Observe{&s});
    }
    EXPECT_EQ(s.of(FormatId::span_h).bias, quarters * ulp / 4);
  }
}

TEST(Observe, BiasOfQuotients) {
  Statistics s;
  const Register r = observed({8, 8, true, Rounding::trn, Overflow::sat, false});
  model::quantize_ratio(model::Exact{7, 0}, model::Exact{4, 0}, r, Observe{&s});   // 1.75 -> 1
  model::quantize_ratio(model::Exact{-7, 0}, model::Exact{4, 0}, r, Observe{&s});  // -1.75 -> -2
  EXPECT_EQ(s.of(FormatId::span_h).bias, -ulp);
  EXPECT_EQ(s.of(FormatId::span_h).count, 2U);
}

// Shifts beyond 64 and beyond 127 bits, and growth out of any range.
TEST(Observe, FarShifts) {
  Statistics s;
  const Register r = observed({8, 8, true, Rounding::trn, Overflow::sat, false});
  model::quantize(model::int128{-1}, 200, r, Observe{&s});  // just below 0: floor is -1, error just under -1
  EXPECT_EQ(s.of(FormatId::span_h).min, -1);
  EXPECT_EQ(s.of(FormatId::span_h).bias, -(ulp - 1));
  model::quantize(model::int128{1}, -200, r, Observe{&s});
  EXPECT_EQ(s.of(FormatId::span_h).max, INT64_MAX);
  EXPECT_EQ(s.of(FormatId::span_h).saturations, 1U);
}

TEST(Observe, OffIsEmptyAndEqual) {
  static_assert(std::is_empty_v<model::NoObserve>);
  Statistics s;
  const Register r = observed({6, 3, true, Rounding::rnd_conv, Overflow::wrap_sm, false});
  for (int v = -2000; v < 2000; ++v) {
    ASSERT_EQ(model::quantize(std::int64_t{v}, 6, r, model::NoObserve{}),
              model::quantize(std::int64_t{v}, 6, r, Observe{&s}));
  }
  EXPECT_EQ(s.of(FormatId::span_h).count, 4000U);
}

TEST(Observe, RegistersHaveNames) {
  EXPECT_EQ(model::name_of(model::id_of(FormatId::span_h)), "span.h");
  EXPECT_EQ(model::name_of(model::RegisterId::depth_z), "depth.z");
  EXPECT_EQ(model::name_of(model::RegisterId::coordinate), "coordinate");
}

}  // namespace
}  // namespace bitspan
