// SPDX-License-Identifier: Apache-2.0
#include "model/stages/span.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "golden/constants.hpp"
#include "golden/span.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

model::SpanStage stage_of(const Config& c) {
  return model::prepare_span(c, model::make_constants(c, worked_scene()));
}

std::vector<FragmentRecord> walk(const model::SpanStage& stage, const SpanRecord& span,
                                 const model::PlaneGeometry* geometry = nullptr) {
  std::vector<FragmentRecord> out;
  model::SpanState state = model::start_span(span, geometry);
  while (!model::finished(state)) {
    out.emplace_back();
    model::span(stage, state, out.back());
  }
  return out;
}

SpanRecord straight_span(const Config& c) {
  SpanRecord s;
  s.triangle = 9;
  s.x = 3;
  s.y = 4;
  s.count = 5;
  s.h = encoded(1, c.format(FormatId::span_h));
  s.h_step = encoded(2, c.format(FormatId::span_h_step));
  s.u1 = encoded(10, c.format(FormatId::edge_uv));
  s.fu = encoded(65536, c.format(FormatId::span_f));
  s.fu_step0 = s.fu_step1 = encoded(65536, c.format(FormatId::span_f_step));
  s.r = encoded(0.25, c.format(FormatId::span_shade_acc));
  s.r_step0 = s.r_step1 = encoded(0.125, c.format(FormatId::span_shade_step));
  return s;
}

// Ten pixels in subspans of four: 0, 4 and 8 are exact, and 9, which no subspan has.
TEST(Span, SubspansAreLinearBetweenExactPixels) {
  Config c = plain_config();
  SpanRecord row = straight_span(c);
  row.count = 10;
  const auto exact = walk(stage_of(c), row);
  c.subspan_bits = 2;
  const auto stage = stage_of(c);
  const auto fragments = walk(stage, row);
  ASSERT_EQ(fragments.size(), 10U);
  const auto u = [&](std::size_t i) { return decoded(fragments[i].u, c.format(FormatId::span_uv)); };
  for (std::size_t i = 0; i < 10; ++i) {
    FragmentRecord same = fragments[i];
    if (i % 4 == 0 || i == 9) {
      EXPECT_EQ(same, exact[i]) << i;
      EXPECT_NE(same.recip_m, 0);
      continue;
    }
    EXPECT_EQ(same.recip_m, 0);
    EXPECT_EQ(same.recip_e, 0);
    const std::size_t a = i / 4 * 4;
    EXPECT_NEAR(u(i), u(a) + (u(a + 4) - u(a)) * static_cast<double>(i - a) / 4, 0x1p-21) << i;
    EXPECT_NE(same.u, exact[i].u);
    // All else is as without subspans.
    same.u = exact[i].u;
    same.v = exact[i].v;
    same.recip_m = exact[i].recip_m;
    same.recip_e = exact[i].recip_e;
    EXPECT_EQ(same, exact[i]) << i;
  }
}

// Of every length of a row: how many pixels divide, and what golden makes of the same row.
TEST(Span, SubspansOfEveryRowEqualGoldens) {
  for (const int bits : {1, 2, 3, 6}) {
    Config c = shipped_config("depth16");
    c.subspan_bits = bits;
    const Scene scene = worked_scene();
    const auto stage = model::prepare_span(c, model::make_constants(c, scene));
    const auto golden = golden::make_span({}, c, golden::make_constants(c, scene));
    for (std::int64_t count = 1; count <= 150; ++count) {
      SpanRecord row = straight_span(c);
      row.count = count;
      row.fu_step0 = row.fu_step1 = encoded(77, c.format(FormatId::span_f_step));
      row.fv = encoded(-5000, c.format(FormatId::span_f));
      row.v1 = encoded(3, c.format(FormatId::edge_uv));
      const auto fragments = walk(stage, row);
      std::vector<FragmentRecord> expected;
      std::vector<FragmentChannelRecord> channels;
      golden(std::array{row}, {}, {}, expected, channels);
      ASSERT_EQ(fragments, expected) << bits << " " << count;
      std::int64_t divides = 0;
      for (const FragmentRecord& f : fragments) divides += f.recip_m != 0 ? 1 : 0;
      const std::int64_t length = std::int64_t{1} << bits;
      const std::int64_t subspans = (count - 1) / length;
      EXPECT_EQ(divides, subspans + count - subspans * length);
    }
  }
}

TEST(Span, DeltaF) {
  const Config c = plain_config();
  const auto stage = stage_of(c);
  EXPECT_EQ(stage.divides_per_fragment, 1);
  const auto fragments = walk(stage, straight_span(c));
  ASSERT_EQ(fragments.size(), 5U);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const FragmentRecord& f = fragments[i];
    const auto n = static_cast<double>(i);
    EXPECT_EQ(f.triangle, 9);
    EXPECT_EQ(f.x, 3 + static_cast<std::int64_t>(i));
    EXPECT_EQ(f.y, 4);
    EXPECT_EQ(f.covered, 1);
    EXPECT_EQ(f.last, i == 4 ? 1 : 0);
    EXPECT_EQ(decoded(f.h, c.format(FormatId::span_h)), 1 + 2 * n);
    EXPECT_EQ(decoded(f.fu, c.format(FormatId::span_f)), 65536 * (1 + n));
    EXPECT_EQ(decoded(f.r, c.format(FormatId::span_shade)), 0.25 + 0.125 * n);
    EXPECT_EQ(f.v, 0);
    EXPECT_EQ(f.recip_e, 16);
    EXPECT_NEAR(decoded(f.u, c.format(FormatId::span_uv)), 10 + 65536 * (1 + n) / (1 + 2 * n + 65535), 1e-4);
  }
  // q = 65536: the reciprocal is 1 exactly.
  EXPECT_EQ(fragments[0].recip_m, std::int64_t{1} << 30);
  EXPECT_EQ(decoded(fragments[0].u, c.format(FormatId::span_uv)), 11);
}

TEST(Span, HyperbolicIsTheExactQuotient) {
  Config c = plain_config();
  c.perspective = Perspective::hyperbolic;
  c.format(FormatId::span_uv).rounding = Rounding::trn;
  const auto stage = stage_of(c);
  EXPECT_EQ(stage.divides_per_fragment, 2);
  SpanRecord s = straight_span(c);
  s.u1 = 0;
  const auto fragments = walk(stage, s);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    // floor(65536 (1 + i) 2^20 / (65536 + 2i))
    const std::int64_t n = static_cast<std::int64_t>(i);
    EXPECT_EQ(fragments[i].u, (65536 * (1 + n) << 20) / (65536 + 2 * n));
    EXPECT_EQ(fragments[i].recip_m, 0);
  }
}

// h + B below zero divides by one ulp.
TEST(Span, DivisorsOfZeroAndBelow) {
  Config c = plain_config();
  c.perspective = Perspective::hyperbolic;
  SpanRecord s = straight_span(c);
  s.count = 1;
  s.h = encoded(-65536, c.format(FormatId::span_h));
  s.fu = encoded(1, c.format(FormatId::span_f));
  s.fv = 1;
  const auto hyperbolic = walk(stage_of(c), s);
  EXPECT_EQ(decoded(hyperbolic[0].u, c.format(FormatId::span_uv)), 1 << 20);
  EXPECT_EQ(decoded(hyperbolic[0].v, c.format(FormatId::span_uv)), 1);
  c.perspective = Perspective::delta_f;
  const auto delta = walk(stage_of(c), s);
  EXPECT_EQ(delta[0].recip_m, std::int64_t{1} << 30);
  EXPECT_EQ(delta[0].recip_e, -20);
  EXPECT_EQ(decoded(delta[0].u, c.format(FormatId::span_uv)), 10 + (1 << 20));
}

TEST(Span, LinearModes) {
  for (const Perspective mode : {Perspective::affine, Perspective::const_depth_rows}) {
    Config c = plain_config();
    c.perspective = mode;
    c.format(FormatId::span_uv) = {20, 16, true, Rounding::trn, Overflow::sat, false};
    const auto stage = stage_of(c);
    EXPECT_EQ(stage.divides_per_fragment, 0);
    const auto fragments = walk(stage, straight_span(c));
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      EXPECT_EQ(fragments[i].u, std::min<std::int64_t>(fragments[i].fu >> 16, (1 << 19) - 1));
      EXPECT_EQ(fragments[i].recip_m, 0);
    }
  }
}

// k = 3/8 from phase 1/2: 7/8, 10/8 -> 2/8 with a step, 5/8, 1 -> 0 with a step, 3/8, ...
TEST(Span, DigitalLine) {
  Config c = plain_config();
  c.perspective = Perspective::const_depth_rows;
  const auto stage = stage_of(c);
  SpanRecord s = straight_span(c);
  s.count = 8;
  s.phase = std::int64_t{1} << 19;
  s.fu = 0;
  s.fu_step0 = 1000;
  s.fu_step1 = 1;
  model::PlaneGeometry geometry;
  geometry.one = std::int64_t{1} << 20;
  geometry.k = 3 * geometry.one / 8;
  geometry.coverage.sides = {model::Coverage::Side{1, 0, -5}, {0, 0, 0}, {0, 0, 0}};  // x >= 5
  const std::vector<std::int64_t> rises{0, 0, 1, 1, 2, 2, 2, 3};
  const auto right = walk(stage, s, &geometry);
  for (std::size_t i = 0; i < rises.size(); ++i) {
    const auto n = static_cast<std::int64_t>(i);
    EXPECT_EQ(right[i].x, 3 + n);
    EXPECT_EQ(right[i].y, 4 + rises[i]);
    EXPECT_EQ(right[i].fu, 1000 * (n - rises[i]) + rises[i]);
    EXPECT_EQ(right[i].covered, 3 + n >= 5 ? 1 : 0);
  }
  geometry.k = -geometry.k;
  geometry.along_y = true;
  // 1/2, 1/8, -2/8 -> 6/8 with a step, 3/8, 0, -3/8 -> 5/8, 2/8, -1/8 -> 7/8
  const std::vector<std::int64_t> falls{0, 0, 1, 1, 1, 2, 2, 3};
  const auto down = walk(stage, s, &geometry);
  for (std::size_t i = 0; i < falls.size(); ++i) {
    const auto n = static_cast<std::int64_t>(i);
    EXPECT_EQ(down[i].y, 4 + n);
    EXPECT_EQ(down[i].x, 3 - falls[i]);
    EXPECT_EQ(down[i].fu, 1000 * (n - falls[i]) + falls[i]);
  }
}

// The pattern is the digital line of the specification: y = row + floor(k (m - m0) + 1/2).
TEST(Span, DigitalLineOfAnySlope) {
  Config c = plain_config();
  c.perspective = Perspective::const_depth_rows;
  const auto stage = stage_of(c);
  std::mt19937_64 random(31);
  for (int i = 0; i < 300; ++i) {
    SpanRecord s = straight_span(c);
    s.count = 200;
    s.phase = std::int64_t{1} << 19;
    model::PlaneGeometry geometry;
    geometry.one = std::int64_t{1} << 20;
    geometry.k = static_cast<std::int64_t>(random() % (2 * (1 << 20) + 1)) - (1 << 20);
    geometry.coverage.sides = {};
    const auto fragments = walk(stage, s, &geometry);
    for (std::size_t n = 0; n < fragments.size(); ++n) {
      const std::int64_t along = geometry.k * static_cast<std::int64_t>(n) + (1 << 19);
      ASSERT_EQ(fragments[n].y, 4 + (along >> 20)) << geometry.k;
    }
  }
}

// The 64-bit path gives what the 128-bit path gives.
TEST(Span, NarrowAndWideAgree) {
  std::mt19937_64 random(32);
  for (const Perspective mode :
       {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine, Perspective::const_depth_rows}) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    auto stage = stage_of(c);
    ASSERT_TRUE(stage.fits_int64);
    auto wide = stage;
    wide.fits_int64 = false;
    for (int i = 0; i < 2000; ++i) {
      SpanRecord s;
      s.count = 20;
      const auto draw = [&](const Format& f) {
        const auto bits = static_cast<int>(random() % static_cast<unsigned>(f.word)) + 1;
        const auto v = static_cast<std::int64_t>(random() >> (64 - bits));
        return f.is_signed ? v - (std::int64_t{1} << (bits - 1)) : v;
      };
      const bool linear = mode == Perspective::affine || mode == Perspective::const_depth_rows;
      s.h = draw(c.format(FormatId::span_h));
      s.h_step = draw(c.format(FormatId::span_h_step));
      s.u1 = draw(c.format(FormatId::edge_uv));
      s.fu = draw(c.format(linear ? FormatId::span_uv_acc : FormatId::span_f));
      s.fv = draw(c.format(linear ? FormatId::span_uv_acc : FormatId::span_f));
      s.fu_step0 = s.fu_step1 = draw(c.format(linear ? FormatId::span_uv_step : FormatId::span_f_step));
      s.fv_step0 = s.fv_step1 = draw(c.format(linear ? FormatId::span_uv_step : FormatId::span_f_step));
      s.a = draw(c.format(FormatId::span_shade_acc));
      s.a_step0 = s.a_step1 = draw(c.format(FormatId::span_shade_step));
      ASSERT_EQ(walk(stage, s), walk(wide, s)) << i;
    }
  }
}

}  // namespace
}  // namespace bitspan
