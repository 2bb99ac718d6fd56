// SPDX-License-Identifier: Apache-2.0
// The channel of fog per vertex (F4) in golden, on values worked by hand. docs/numeric-spec.md, "Channels".
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "config/lines.hpp"
#include "config/modes.hpp"
#include "engine/counters.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/precision.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using F = FormatId;

Config vertex_fog(Perspective perspective, RowSlope slope) {
  Config c = plain_config();
  c.perspective = perspective;
  c.row_slope = slope;
  c.fog = FogMode::vertex;
  return c;
}
// Each mode, with each way to start a row that it has.
std::vector<Config> every_mode() {
  std::vector<Config> out;
  for (const Perspective p : all_perspectives) {
    out.push_back(vertex_fog(p, RowSlope::divide));
    if (!has_plane_rows(p)) out.push_back(vertex_fog(p, RowSlope::plane));
  }
  return out;
}

// x / 16 + y / 32 is the factor: at the centre of a pixel (4 x + 2 y + 3) / 64.
Scene worked(double a = 0, double b = 1, double c = 0.5) {
  Scene scene;
  scene.width = 64;
  scene.height = 48;
  scene.s_min = 1;
  scene.s_max = 2;
  scene.background = {0, 0, 0};
  scene.fog = Fog{{200, 100, 0}, 4};
  Triangle t;
  t.v[0] = {{0, 0, 1}, {.c = {1, 1, 1, 1}, .fog = a}};
  t.v[1] = {{16, 0, 2}, {.c = {1, 1, 1, 1}, .fog = b}};
  t.v[2] = {{0, 16, 1.5}, {.c = {1, 1, 1, 1}, .fog = c}};
  scene.triangles = {t};
  return scene;
}

struct Drawn {
  Trace trace;
  Counters counters;
  Frame frame;
};
Drawn drawn(const Config& c, const Scene& scene) {
  const auto engine = make_golden(c, true);
  Drawn out;
  engine->begin(scene);
  engine->draw(scene.triangles, 7, &out.trace);
  out.counters = engine->counters();
  out.frame = engine->frame();
  return out;
}
double value(std::int64_t raw, const Config& c, F id) { return decoded(raw, c.format(id)); }

TEST(GoldenChannel, IsLinearOnTheScreenInEveryMode) {
  for (const Config& c : every_mode()) {
    SCOPED_TRACE(std::string(to_string(c.perspective)) + " " + std::string(to_string(c.row_slope)));
    const Drawn run = drawn(c, worked());
    ASSERT_EQ(run.trace.fragment_channel.size(), run.trace.fragment.size());
    std::size_t covered = 0;
    for (std::size_t i = 0; i < run.trace.fragment.size(); ++i) {
      const FragmentRecord& f = run.trace.fragment[i];
      const FragmentChannelRecord& w = run.trace.fragment_channel[i];
      ASSERT_EQ(w.triangle, 7);
      ASSERT_EQ(w.channel, 0);
      ASSERT_EQ(std::pair(w.x, w.y), std::pair(f.x, f.y));
      if (f.covered == 0) continue;
      ++covered;
      EXPECT_EQ(value(w.w, c, F::fog_factor), static_cast<double>(4 * f.x + 2 * f.y + 3) / 64);
    }
    EXPECT_EQ(covered, 120U);  // 15 + 14 + ... + 1
    ASSERT_EQ(run.trace.fog.size(), covered);
    for (const FogRecord& f : run.trace.fog) {
      const double factor = static_cast<double>(4 * f.x + 2 * f.y + 3) / 64;
      EXPECT_EQ(value(f.factor, c, F::fog_factor), factor);
      EXPECT_EQ(f.index, -1);
      EXPECT_EQ(f.recip_m, 0);
      EXPECT_EQ(f.recip_e, 0);
      const auto narrowed = [](double color) { return std::floor(color * 16 + 0.5) / 16; };
      EXPECT_EQ(value(f.r, c, F::fog_color), narrowed(200 + 55 * factor));  // 255 without fog
      EXPECT_EQ(value(f.b, c, F::fog_color), narrowed(255 * factor));
    }
  }
}

TEST(GoldenChannel, SetupAndRowsByHand) {
  const Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
  const Drawn run = drawn(c, worked());
  // Sorted by y and x: (0, 0), (16, 0), (0, 16). Edge 1 has no height.
  ASSERT_EQ(run.trace.setup_channel.size(), 1U);
  const SetupChannelRecord& s = run.trace.setup_channel[0];
  EXPECT_EQ(value(s.w0, c, F::fog_vertex), 0);
  EXPECT_EQ(value(s.w1, c, F::fog_vertex), 1);
  EXPECT_EQ(value(s.w2, c, F::fog_vertex), 0.5);
  EXPECT_EQ(value(s.step0, c, F::fog_step), 0.5 / 16);
  EXPECT_EQ(s.step1, 0);
  EXPECT_EQ(value(s.step2, c, F::fog_step), -0.5 / 16);
  EXPECT_EQ(s.f0 | s.f1 | s.f2 | s.w_x | s.w_y, 0);
  ASSERT_EQ(run.trace.row_channel.size(), run.trace.row.size());
  ASSERT_EQ(run.trace.row.size(), 15U);
  for (std::size_t i = 0; i < run.trace.row.size(); ++i) {
    const RowChannelRecord& r = run.trace.row_channel[i];
    const double t = static_cast<double>(i) + 0.5;
    EXPECT_EQ(r.y, run.trace.row[i].y);
    EXPECT_EQ(value(r.l_acc, c, F::fog_acc), t / 32);
    EXPECT_EQ(r.l, r.l_acc);
    EXPECT_EQ(value(r.r_acc, c, F::fog_acc), 1 - t / 32);
    EXPECT_EQ(r.r, r.r_acc);
    const SpanChannelRecord& span = run.trace.span_channel[i];
    EXPECT_EQ(std::pair(span.x, span.y), std::pair(run.trace.span[i].x, run.trace.span[i].y));
    EXPECT_EQ(value(span.w_step0, c, F::fog_step), 1 / 16.0);
    EXPECT_EQ(span.w_step1, span.w_step0);
    EXPECT_EQ(value(span.w, c, F::fog_acc), t / 32 + 0.5 / 16);
  }
}

TEST(GoldenChannel, PlanesByHand) {
  for (const auto& [perspective, slope] : {std::pair(Perspective::affine, RowSlope::plane),
                                           std::pair(Perspective::const_depth_rows, RowSlope::divide)}) {
    const Config c = vertex_fog(perspective, slope);
    const Drawn run = drawn(c, worked());
    ASSERT_EQ(run.trace.setup_channel.size(), 1U);
    const SetupChannelRecord& s = run.trace.setup_channel[0];
    EXPECT_EQ(value(s.w_x, c, F::fog_grad), 1 / 16.0);
    EXPECT_EQ(value(s.w_y, c, F::fog_grad), 1 / 32.0);
    EXPECT_EQ(s.step0 | s.step1 | s.step2, 0);
    EXPECT_TRUE(run.trace.row_channel.empty());
    ASSERT_EQ(run.trace.span_channel.size(), run.trace.span.size());
    for (std::size_t i = 0; i < run.trace.span.size(); ++i) {
      const SpanChannelRecord& w = run.trace.span_channel[i];
      EXPECT_EQ(std::pair(w.x, w.y), std::pair(run.trace.span[i].x, run.trace.span[i].y));
      EXPECT_EQ(value(w.w, c, F::fog_acc), static_cast<double>(4 * w.x + 2 * w.y + 3) / 64);
    }
  }
}

// exp(-s / 4), rounded once.
TEST(GoldenChannel, FollowsFromTheDistanceWhereItIsNotGiven) {
  for (const Config& c : every_mode()) {
    const Drawn run = drawn(c, worked(-1, -1, -1));
    const SetupChannelRecord& s = run.trace.setup_channel.at(0);
    // exp(-1/4), exp(-1/2), exp(-3/8) in units of 2^-20.
    EXPECT_EQ(s.w0, 816632);  // 816631.81
    EXPECT_EQ(s.w1, 635993);  // 635993.49
    EXPECT_EQ(s.w2, 720675);  // 720675.04
  }
  // Far beyond the fog's distance nothing is left; far in front of it a little less than 1.
  Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
  c.format(F::fog_vertex) = {13, 1, false, Rounding::trn, Overflow::sat, false};
  Scene scene = worked(-1, -1, -1);
  scene.fog->distance = 0x1p-20;
  EXPECT_EQ(drawn(c, scene).trace.setup_channel.at(0).w0, 0);
  scene.fog->distance = 0x1p200;
  EXPECT_EQ(drawn(c, scene).trace.setup_channel.at(0).w0, 4095);
}

// No fog in the scene: no channel, and nothing that another mode would not have.
TEST(GoldenChannel, OnlyInAFoggyScene) {
  for (Config c : every_mode()) {
    Scene scene = worked();
    scene.fog.reset();
    const Drawn run = drawn(c, scene);
    EXPECT_TRUE(run.trace.setup_channel.empty() && run.trace.row_channel.empty() &&
                run.trace.span_channel.empty() && run.trace.fragment_channel.empty());
    c.fog = FogMode::none;
    const Drawn none = drawn(c, scene);
    EXPECT_EQ(run.trace.fog, none.trace.fog);
    EXPECT_EQ(run.frame.color, none.frame.color);
    EXPECT_EQ(run.counters, none.counters);
  }
}

TEST(GoldenChannel, CountsItsDivisions) {
  const auto more = [](Config c) {
    const Drawn with = drawn(c, worked());
    c.fog = FogMode::none;
    const Drawn without = drawn(c, worked());
    EXPECT_EQ(with.trace.fragment, without.trace.fragment);
    EXPECT_EQ(with.trace.span, without.trace.span);
    EXPECT_EQ(with.counters.divides_pixel, without.counters.divides_pixel);
    return std::pair(with.counters.divides_edge - without.counters.divides_edge,
                     with.counters.divides_row - without.counters.divides_row);
  };
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
  EXPECT_EQ(more(c), Pair(2, 15));  // edges with height, rows
  c.edge_slope = SlopeForm::reciprocal;
  c.row_slope = RowSlope::reciprocal;
  EXPECT_EQ(more(c), Pair(0, 0));
  c.row_slope = RowSlope::plane;
  EXPECT_EQ(more(c), Pair(0, 0));
  c.edge_slope = SlopeForm::divide;
  EXPECT_EQ(more(c), Pair(2, 0));  // two gradients
  EXPECT_EQ(more(vertex_fog(Perspective::const_depth_rows, RowSlope::divide)), Pair(2, 0));
}

TEST(GoldenChannel, IsNarrowedAtEachRegister) {
  Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
  c.format(F::fog_vertex) = {3, 1, false, Rounding::rnd, Overflow::sat, false};  // 0.3 -> 0.25
  c.format(F::fog_step) = {10, 2, true, Rounding::rnd, Overflow::sat, false};    // 2^-8
  c.format(F::fog_acc) = {9, 1, false, Rounding::trn, Overflow::sat, false};     // 2^-8
  c.format(F::fog_factor) = {5, 1, false, Rounding::rnd, Overflow::sat, false};  // 2^-4
  const Drawn run = drawn(c, worked(0.3, 0.3, 1));
  const SetupChannelRecord& s = run.trace.setup_channel.at(0);
  EXPECT_EQ(s.w0, 1);
  EXPECT_EQ(s.w2, 4);
  EXPECT_EQ(s.step0, 12);  // 0.75 / 16 = 12 / 256
  // Row 0: 64 + 6. Row 1: 12 more.
  EXPECT_EQ(run.trace.row_channel.at(0).l, 70);
  EXPECT_EQ(run.trace.row_channel.at(1).l, 82);
  EXPECT_EQ(run.trace.fragment_channel.at(0).w, 4);   // 70 / 256 = 4.375 / 16
  EXPECT_EQ(run.trace.fragment_channel.at(15).w, 5);  // row 1: 5.125 / 16
}

TEST(GoldenChannel, PrecisionCountsItsRegisters) {
  const auto widest = [](int word) {
    Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
    c.format(F::fog_acc) = {word, 1, false, Rounding::rnd, Overflow::sat, false};
    const golden::Precision p = golden::choose_precision(c);
    return std::pair(p.edge_walk, p.span);
  };
  EXPECT_EQ(widest(30).second, golden::Width::f64);
  EXPECT_NE(widest(60).first, golden::Width::f64);
  EXPECT_NE(widest(60).second, golden::Width::f64);
}

TEST(GoldenChannel, IdealInterpolatesWhatIsGivenAndTakesTheDistanceElse) {
  const Config c = vertex_fog(Perspective::delta_f, RowSlope::divide);
  const Scene scene = worked();
  const auto t = ideal_triangle(c, scene.triangles[0]);
  ASSERT_TRUE(t);
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(9, 3), std::pair(2, 12)}) {
    EXPECT_NEAR(ideal_at(c, scene, *t, x, y).fog_factor, (4 * x + 2 * y + 3) / 64.0, 1e-12);
  }
  const auto by_distance = ideal_triangle(c, worked(-1, -1, -1).triangles[0]);
  const IdealFragment f = ideal_at(c, scene, *by_distance, 9, 3);
  EXPECT_NEAR(f.fog_factor, std::exp(-f.point.s / 4), 1e-12);
}

}  // namespace
}  // namespace bitspan
