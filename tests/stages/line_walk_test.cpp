// SPDX-License-Identifier: Apache-2.0
// line_walk: lines between whole pixels [B1], clipped by four-bit codes [B2]. docs/numeric-spec.md,
// "line_walk".
#include "golden/line_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/surface.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

struct Pixel {
  std::int64_t x = 0, y = 0;
  bool operator==(const Pixel&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Pixel& p) {
  return out << "(" << p.x << ", " << p.y << ")";
}
using Pixels = std::vector<Pixel>;

Config lines_config(LineForm walk, const char* shipped = "depth16") {
  Config c = shipped_config(shipped);
  c.line_walk = walk;
  return c;
}

Scene window(int width, int height) {
  Scene scene = worked_scene();
  scene.width = width;
  scene.height = height;
  return scene;
}

Triangle line(const Vertex& a, const Vertex& b) { return {.v = {a, b, b}, .is_line = true}; }
// Between the middles of two pixels.
Triangle between(Pixel a, Pixel b) {
  const auto middle = [](Pixel p) {
    return vertex(static_cast<double>(p.x) + 0.5, static_cast<double>(p.y) + 0.5);
  };
  return line(middle(a), middle(b));
}

std::optional<model::WalkedLine> walked(const model::Pipeline& p, const Triangle& of) {
  SetupRecord ends;
  EXPECT_TRUE(model::setup(p.setup, of, 0, ends));
  model::WalkedLine out;
  if (!model::line_walk(p.line_walk, ends, out)) return std::nullopt;
  return out;
}
// What span makes of a line, in its order.
Pixels drawn(const model::Pipeline& p, const Triangle& of) {
  Pixels out;
  const auto found = walked(p, of);
  if (!found) return out;
  SpanRecord span;
  model::span_setup(p.span_setup, found->record, span);
  model::SpanState state = model::start_span(span, &found->geometry);
  FragmentRecord fragment;
  while (!model::finished(state)) {
    model::span(p.span, state, fragment);
    EXPECT_EQ(fragment.covered, 1);
    out.push_back({fragment.x, fragment.y});
  }
  return out;
}

std::int64_t floor_of(std::int64_t n, std::int64_t d) { return n / d - (n % d < 0 ? 1 : 0); }

// The true line, rounded: of two pixels that are as near the one with the larger coordinate.
Pixels rounded_line(Pixel a, Pixel b) {
  const bool along_y = std::abs(b.y - a.y) > std::abs(b.x - a.x);
  if (along_y ? b.y < a.y : b.x < a.x) std::swap(a, b);
  const std::int64_t n = along_y ? b.y - a.y : b.x - a.x;
  Pixels out;
  for (std::int64_t i = 0; i <= n; ++i) {
    const auto at = [&](std::int64_t from, std::int64_t to) {
      return n == 0 ? from : from + floor_of(2 * (to - from) * i + n, 2 * n);
    };
    out.push_back({at(a.x, b.x), at(a.y, b.y)});
  }
  return out;
}

// Bresenham's integers in all octants. A line that falls in its minor coordinate steps at ties one pixel
// later.
Pixels bresenham(Pixel a, Pixel b) {
  const bool along_y = std::abs(b.y - a.y) > std::abs(b.x - a.x);
  if (along_y ? b.y < a.y : b.x < a.x) std::swap(a, b);
  const std::int64_t dx = along_y ? b.y - a.y : b.x - a.x;
  const std::int64_t rise = along_y ? b.x - a.x : b.y - a.y;
  const std::int64_t dy = std::abs(rise), side = rise < 0 ? -1 : 1;
  std::int64_t d = 2 * dy - dx;
  Pixels out{a};
  for (std::int64_t i = 0; i < dx; ++i) {
    ++(along_y ? a.y : a.x);
    const bool steps = side > 0 ? d >= 0 : d > 0;
    if (steps) (along_y ? a.x : a.y) += side;
    d += steps ? 2 * (dy - dx) : 2 * dy;
    out.push_back(a);
  }
  return out;
}

// The source's procedure as it stands (001, Bresenham).
Pixels bresenham_of_the_source(Pixel a, Pixel b) {
  const std::int64_t dx = std::abs(b.x - a.x), dy = std::abs(b.y - a.y);
  std::int64_t d = 2 * dy - dx;
  if (a.x > b.x) std::swap(a, b);
  Pixels out{a};
  while (a.x < b.x) {
    ++a.x;
    if (d < 0) {
      d += 2 * dy;
    } else {
      ++a.y;
      d += 2 * (dy - dx);
    }
    out.push_back(a);
  }
  return out;
}

TEST(LineWalk, TheSourcesProcedureOnlyStepsUp) {
  EXPECT_EQ(bresenham_of_the_source({2, 3}, {12, 7}), rounded_line({2, 3}, {12, 7}));
  EXPECT_NE(bresenham_of_the_source({2, 7}, {12, 3}), rounded_line({2, 7}, {12, 3}));
  EXPECT_EQ(bresenham_of_the_source({2, 7}, {12, 3}).back(), (Pixel{12, 11}));  // 3 is where it should end
  EXPECT_NE(bresenham_of_the_source({2, 3}, {5, 12}), rounded_line({2, 3}, {5, 12}));  // steep
  const model::Pipeline p = model::make_pipeline(lines_config(LineForm::exact), window(64, 48));
  for (const auto& [a, b] : {std::pair{Pixel{2, 7}, Pixel{12, 3}}, {{2, 3}, {5, 12}}, {{2, 12}, {5, 3}}}) {
    EXPECT_EQ(drawn(p, between(a, b)), rounded_line(a, b));
  }
}

TEST(LineWalk, BresenhamIsTheTrueLineRounded) {
  const std::uint64_t seed = 27;
  std::mt19937_64 random(seed);
  const model::Pipeline p = model::make_pipeline(lines_config(LineForm::exact), window(256, 256));
  const int count = is_long_run() ? 1000000 : 20000;
  std::array<int, 8> octants{};
  std::uint64_t pixels = 0;
  for (int i = 0; i < count; ++i) {
    const std::int64_t size = i % 8 == 0 ? 250 : 40;
    const auto at = [&] { return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(size)); };
    const Pixel a{at(), at()}, b{at(), at()};
    // Anywhere in its pixel.
    const auto inside = [&](Pixel q) {
      return vertex(static_cast<double>(q.x) + static_cast<double>(random() % 16) / 16,
                    static_cast<double>(q.y) + static_cast<double>(random() % 16) / 16);
    };
    const Pixels expected = rounded_line(a, b);
    ASSERT_EQ(bresenham(a, b), expected) << "seed " << seed << " line " << i;
    ASSERT_EQ(drawn(p, line(inside(a), inside(b))), expected) << "seed " << seed << " line " << i;
    ASSERT_EQ(drawn(p, line(inside(b), inside(a))), expected) << "reversed: seed " << seed << " line " << i;
    const std::int64_t dx = b.x - a.x, dy = b.y - a.y;
    ++octants[(dx < 0 ? 1U : 0U) + (dy < 0 ? 2U : 0U) + (std::abs(dy) > std::abs(dx) ? 4U : 0U)];
    pixels += expected.size();
  }
  for (const int n : octants) EXPECT_GT(n, count / 20);
  EXPECT_GT(pixels, static_cast<std::uint64_t>(10 * count));
}

TEST(LineWalk, AClippedLineKeepsItsPixels) {
  const std::uint64_t seed = 28;
  std::mt19937_64 random(seed);
  constexpr int width = 24, height = 17;
  for (const LineForm walk : {LineForm::exact, LineForm::dda}) {
    Config narrow = lines_config(walk);
    Format& k = narrow.format(FormatId::plane_k);
    k.word = k.integer + 9;  // so few that a dda's line is another one
    const model::Pipeline p = model::make_pipeline(narrow, window(width, height));
    // The same line a long way inside of a large picture.
    constexpr std::int64_t shift = 200;
    const model::Pipeline whole = model::make_pipeline(narrow, window(512, 512));
    const golden::LineWalkStage by_golden = golden::make_line_walk(narrow, width, height);
    int cut = 0, gone = 0;
    const int count = is_long_run() ? 500000 : 5000;
    for (int i = 0; i < count; ++i) {
      const auto at = [&] { return static_cast<std::int64_t>(random() % 120) - 50; };
      const Pixel a{at(), at()}, b{at(), at()};
      Pixels expected;
      for (Pixel q : drawn(whole, between({a.x + shift, a.y + shift}, {b.x + shift, b.y + shift}))) {
        q = {q.x - shift, q.y - shift};
        if (q.x >= 0 && q.x < width && q.y >= 0 && q.y < height) expected.push_back(q);
      }
      const Triangle one = between(a, b);
      ASSERT_EQ(drawn(p, one), expected) << "seed " << seed << " line " << i << " from " << a << " to " << b;
      const auto found = walked(p, one);
      SetupRecord ends;
      model::setup(p.setup, one, 0, ends);
      const auto golden_found = by_golden(ends);
      ASSERT_EQ(found.has_value(), golden_found.has_value());
      if (found) {
        ASSERT_EQ(found->record, *golden_found) << "seed " << seed << " line " << i;
      }
      const auto pixels = static_cast<std::size_t>(std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)) + 1);
      cut += !expected.empty() && expected.size() < pixels ? 1 : 0;
      gone += expected.empty() ? 1 : 0;
    }
    EXPECT_GT(cut, count / 10);
    EXPECT_GT(gone, count / 10);
  }
}

// The source's clipping as it stands (001, Clip), with `turns` in the place of an end.
struct Clipped {
  bool done = false;
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};
Clipped clip_of_the_source(Clipped c, double x_min, double x_max, double y_min, double y_max, int turns) {
  const auto code = [&](double x, double y) { return std::array{y > y_max, y<y_min, x> x_max, x < x_min}; };
  while (turns-- > 0) {
    auto one = code(c.x1, c.y1), two = code(c.x2, c.y2);
    const auto is_set = [](bool bit) { return bit; };
    for (std::size_t i = 0; i < 4; ++i) c.done = c.done || (one[i] && two[i]);
    c.done = c.done || (std::ranges::none_of(one, is_set) && std::ranges::none_of(two, is_set));
    if (c.done) return c;
    if (std::ranges::none_of(one, is_set)) {
      std::swap(c.x1, c.x2);
      std::swap(c.y1, c.y2);
      one = two;
    }
    if (one[0]) {
      c.x1 = c.x1 + (c.x2 - c.x1) * (y_max - c.y1) / (c.y2 - c.y1);
      c.y1 = y_max;
    } else if (one[1]) {
      if (one[0]) {  // which it is not: the branch is dead
        c.x1 = c.x1 + (c.x2 - c.x1) * (y_min - c.y1) / (c.y2 - c.y1);
        c.y1 = y_min;
      }
    } else if (one[2]) {
      c.y1 = c.x1 + (c.y2 - c.y1) * (y_max - c.x1) / (c.x2 - c.x1);  // x1 for y1, y_max for x_max
      c.x1 = x_max;
    } else if (one[3]) {
      c.y1 = c.x1 + (c.y2 - c.y1) * (y_min - c.x1) / (c.x2 - c.x1);  // x1 for y1, y_min for x_min
      c.x1 = x_min;
    }
  }
  return c;
}

TEST(LineWalk, TheSourcesClippingNeverEndsBelowAndCutsElsewhereAtTheSides) {
  constexpr int width = 24, height = 17;
  const model::Pipeline p = model::make_pipeline(lines_config(LineForm::exact), window(width, height));
  const auto clip = [&](Pixel a, Pixel b) {
    return clip_of_the_source({false, double(a.x), double(a.y), double(b.x), double(b.y)}, 0, width - 1, 0,
                              height - 1, 100);
  };
  // Through the side of the smaller y: a dead branch, and so no end.
  EXPECT_FALSE(clip({4, -8}, {12, 8}).done);
  EXPECT_EQ(drawn(p, between({4, -8}, {12, 8})).front(), (Pixel{8, 0}));
  EXPECT_EQ(drawn(p, between({12, 8}, {4, -8})).front(), (Pixel{8, 0}));
  // Through the side of the larger y it is right.
  const Clipped above = clip({8, 32}, {4, 8});
  EXPECT_TRUE(above.done);
  EXPECT_EQ(above.y1, 16);
  EXPECT_NEAR(above.x1, 4 + 4.0 * 8 / 24, 1e-12);
  EXPECT_EQ(drawn(p, between({8, 32}, {4, 8})).back(), (Pixel{5, 16}));
  // Through the right side at y = 4 + 8 (23 - 5) / 30 = 8.8, and through the left one at y = 12 - 8 4 / 12
  // = 9.33.
  const Clipped right = clip({35, 12}, {5, 4});
  EXPECT_FALSE(right.done && right.x1 == width - 1 && std::abs(right.y1 - 8.8) < 1e-9);
  EXPECT_EQ(drawn(p, between({35, 12}, {5, 4})).back(), (Pixel{23, 9}));
  const Clipped left = clip({-4, 12}, {8, 4});
  EXPECT_FALSE(left.done && left.x1 == 0 && std::abs(left.y1 - (12 - 8.0 * 4 / 12)) < 1e-9);
  EXPECT_EQ(drawn(p, between({-4, 12}, {8, 4})).front(), (Pixel{0, 9}));
}

TEST(LineWalk, ADdaGoesByItsSlope) {
  std::mt19937_64 random(29);
  Config c = lines_config(LineForm::dda);
  Format& k = c.format(FormatId::plane_k);
  k.word = k.integer + 7;
  const model::Pipeline p = model::make_pipeline(c, window(256, 256));
  int others = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto at = [&] { return static_cast<std::int64_t>(random() % 200); };
    const Pixel a{at(), at()}, b{at(), at()};
    const auto found = walked(p, between(a, b));
    ASSERT_TRUE(found.has_value());
    const LineWalkRecord& r = found->record;
    EXPECT_EQ(r.one, 128);
    EXPECT_EQ(r.phase, 64);
    const std::int64_t n = r.count - 1;
    const std::int64_t rise =
        r.major == 1 ? (b.y > a.y ? b.x - a.x : a.x - b.x) : (b.x > a.x ? b.y - a.y : a.y - b.y);
    EXPECT_LE(std::abs(r.k * n - 128 * rise), n);  // at most one ulp of k
    const Pixels pixels = drawn(p, between(a, b));
    for (std::int64_t j = 0; j <= n; ++j) {
      const std::int64_t minor = r.minor_first + floor_of(64 + r.k * j, 128);
      const Pixel expected = r.major == 1 ? Pixel{minor, r.major_first + j} : Pixel{r.major_first + j, minor};
      ASSERT_EQ(pixels[static_cast<std::size_t>(j)], expected);
    }
    others += pixels == rounded_line(a, b) ? 0 : 1;
  }
  EXPECT_GT(others, 500);
}

TEST(LineWalk, TheEndsHaveTheirOwnValues) {
  const Config c = lines_config(LineForm::exact);
  Vertex a = vertex(3.2, 5.9, 2, 10, 20), b = vertex(40.7, 21.1, 1, 50, 5);
  a.c = {0, 1, 0.5, 1};
  b.c = {1, 0, 0.5, 1};
  Scene scene = worked_scene();
  scene.triangles = {line(b, a)};
  Trace trace;
  const auto engine = make_model(c);
  engine->begin(scene);
  engine->draw(scene.triangles, 0, &trace);
  ASSERT_EQ(trace.line_walk.size(), 1U);
  EXPECT_TRUE(trace.row.empty());
  EXPECT_TRUE(trace.edge.empty());
  ASSERT_EQ(trace.fragment.size(), 38U);
  const auto value = [&](std::int64_t raw, FormatId id) {
    return std::ldexp(double(raw), -c.format(id).fraction());
  };
  const FragmentRecord &first = trace.fragment.front(), &last = trace.fragment.back();
  EXPECT_EQ(first.x, 3);
  EXPECT_EQ(first.y, 5);
  EXPECT_EQ(last.x, 40);
  EXPECT_EQ(last.y, 21);
  EXPECT_NEAR(value(first.u, FormatId::span_uv), 10, 0.05);
  EXPECT_NEAR(value(first.v, FormatId::span_uv), 20, 0.05);
  EXPECT_NEAR(value(last.u, FormatId::span_uv), 50, 0.05);
  EXPECT_NEAR(value(last.v, FormatId::span_uv), 5, 0.05);
  EXPECT_NEAR(value(last.h, FormatId::span_h), 65535, 1);
  EXPECT_NEAR(value(first.r, FormatId::span_shade), 0, 0.01);
  EXPECT_NEAR(value(last.r, FormatId::span_shade), 1, 0.01);
  EXPECT_EQ(engine->counters().rows, 1U);
  EXPECT_EQ(engine->counters().divides_edge, 0U);
  EXPECT_EQ(engine->counters().divides_row, 1U);
  EXPECT_EQ(engine->counters().degenerate, 0U);
  // A point is a pixel.
  scene.triangles = {line(a, a)};
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  EXPECT_EQ(engine->counters().fragments, 1U);
}

void expect_same(const Trace& a, const Trace& b, const std::string& what) {
#define BITSPAN_SAME(Record, LIST, name, member) EXPECT_TRUE(a.member == b.member) << what << ": " << name;
  BITSPAN_RECORDS(BITSPAN_SAME)
#undef BITSPAN_SAME
}

TEST(LineWalk, AllViewsDrawTheSameLines) {
  std::uint64_t lines = 0;
  const int scenes = is_long_run() ? 40 : 2;
  for (const char* const shipped : {"depth16", "depth20", "narrow"}) {
    for (const Perspective perspective :
         {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine}) {
      for (const LineForm walk : {LineForm::exact, LineForm::dda}) {
        for (int n = 0; n < scenes; ++n) {
          Config c = lines_config(walk, shipped);
          c.perspective = perspective;
          c.row_slope = n % 2 == 0 ? RowSlope::reciprocal : RowSlope::divide;
          for (Format& f : c.formats) f.overflow_expected = true;
          if (walk == LineForm::dda) c.format(FormatId::plane_k).word -= 5;
          ASSERT_FALSE(first_violation(c).has_value()) << first_violation(c)->text;
          RandomOptions options;
          options.width = 60;
          options.height = 44;
          options.triangles = 50;
          options.size_max = 90;
          options.depth_ratio_max = 20;
          options.command_probability = 0.1;
          options.uv_limit = 100;
          const auto seed = static_cast<std::uint64_t>(100 + n);
          Scene scene = random_scene(seed, options);
          Random random(seed);
          draw_lines(random, scene, 0.6);
          const std::string what = std::string(shipped) + " " + std::string(to_string(perspective)) + " " +
                                   std::string(to_string(walk)) + " seed " + std::to_string(seed);
          std::vector<std::unique_ptr<Engine>> engines;
          engines.push_back(make_golden(c, true));
          engines.push_back(make_model(c, {.form = ModelForm::scalar}));
          engines.push_back(make_model(c));
          std::vector<Trace> traces(engines.size());
          for (std::size_t e = 0; e < engines.size(); ++e) {
            engines[e]->begin(scene);
            draw_scene(*engines[e], scene, 0, scene.triangles.size(), &traces[e]);
            if (e == 0) continue;
            expect_same(traces[0], traces[e], what);
            EXPECT_EQ(engines[e]->frame().color, engines[0]->frame().color) << what;
            EXPECT_EQ(engines[e]->frame().depth, engines[0]->frame().depth) << what;
            EXPECT_TRUE(engines[e]->counters() == engines[0]->counters()) << what;
          }
          // Without a trace the triangles go in lanes, and the lines between them do not.
          const auto in_lanes = make_model(c);
          in_lanes->begin(scene);
          draw_scene(*in_lanes, scene, 0, scene.triangles.size(), nullptr);
          EXPECT_EQ(in_lanes->frame().color, engines[0]->frame().color) << what;
          EXPECT_EQ(in_lanes->frame().depth, engines[0]->frame().depth) << what;
          lines += traces[0].line_walk.size();
        }
      }
    }
  }
  EXPECT_GT(lines, 200U);
}

TEST(LineWalk, IdealDrawsTheSamePixels) {
  RandomOptions options;
  options.width = 80;
  options.height = 60;
  options.triangles = 250;
  options.size_max = 120;
  options.textures = 0;
  options.fog_probability = 0;
  options.translucent_probability = 0;
  options.depth_ratio_max = 4;
  Scene scene = random_scene(5, options);
  Random random(5);
  draw_lines(random, scene, 1);
  const Config c = lines_config(LineForm::exact);
  const auto model = make_model(c);
  const auto ideal = make_ideal(c);
  for (Engine* engine : {model.get(), ideal.get()}) {
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
  }
  int others = 0;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < model->frame().triangle.size(); ++i) {
    const bool of_model = model->frame().triangle[i] >= 0, of_ideal = ideal->frame().triangle[i] >= 0;
    EXPECT_EQ(of_model, of_ideal) << i;
    seen += of_model ? 1 : 0;
    others += model->frame().triangle[i] != ideal->frame().triangle[i] ? 1 : 0;
  }
  EXPECT_GT(seen, 800U);
  EXPECT_LE(others, 4);  // depths that are as near
  EXPECT_EQ(model->counters().fragments, ideal->counters().fragments);
}

TEST(LineWalk, WhatHasNoLinesSaysSo) {
  Scene scene = worked_scene();
  scene.triangles = {line(vertex(1, 1), vertex(9, 5))};
  const Config none = shipped_config("depth16");
  for (const auto& make :
       {+[](const Config& c) { return make_golden(c); }, +[](const Config& c) { return make_model(c); },
        +[](const Config& c) { return make_ideal(c); }}) {
    const auto engine = make(none);
    engine->begin(scene);
    EXPECT_EQ(input_error([&] { engine->draw(scene.triangles, 0, nullptr); }),
              "triangle 0 is a line, and line.walk = none draws no lines; legal: line.walk = exact, dda");
  }
  const auto violation = [](auto set) {
    Config c = lines_config(LineForm::exact);
    set(c);
    const auto v = first_violation(c);
    return v && v->key == "line.walk" ? v->text : "";
  };
  EXPECT_EQ(violation([](Config& c) { c.perspective = Perspective::const_depth_rows; }),
            "is exact, and a line has no rows of constant depth; legal: none, or perspective.mode = delta_f, "
            "hyperbolic, affine");
  EXPECT_EQ(violation([](Config& c) { c.row_slope = RowSlope::plane; }),
            "is exact, and a line has no plane; legal: none, or slope.row = divide, reciprocal");
  EXPECT_EQ(
      violation([](Config& c) {
        c.mip = MipMode::nearest;
        c.lod = LodMode::gradient;
      }),
      "is exact, and a line has no gradients; legal: none, or a depth.code other than float_dz and lod.mode "
      "none, zone_s, zone_d");
  EXPECT_EQ(violation([](Config& c) { c.fog = FogMode::vertex; }),
            "is exact, and a line has no channels; legal: none, or a configuration without channels");
}

}  // namespace
}  // namespace bitspan
