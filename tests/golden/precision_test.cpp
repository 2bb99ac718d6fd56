// SPDX-License-Identifier: Apache-2.0
// The choice of floating-point types: enough bits, never needlessly refused, and too few ones are noticed.
#include "golden/precision.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "golden/engine_golden.hpp"
#include "golden/setup.hpp"
#include "golden/span_setup.hpp"
#include "report/random_config.hpp"
#include "tests/golden/golden_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan::test {
namespace {

using namespace bitspan::golden;

int bits_of(const Precision& p, const std::string& stage, const std::string& expression) {
  for (const PrecisionRow& row : p.rows) {
    if (row.stage == stage && row.expression == expression) return row.bits;
  }
  ADD_FAILURE() << "no row " << stage << ": " << expression;
  return 0;
}

Precision all_in(Width width) {
  Precision p;
  for (Width* stage : {&p.setup, &p.edge_setup, &p.edge_walk, &p.plane_walk, &p.span_setup, &p.span, &p.depth,
                       &p.texture, &p.fog, &p.merge}) {
    *stage = width;
  }
  return p;
}

template <class R>
void expect_equal(const std::vector<R>& a, const std::vector<R>& b) {
  ASSERT_EQ(a.size(), b.size()) << stage_name<R>;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(a[i] == b[i]) << stage_name<R> << " record " << i;
}
void expect_equal(const Trace& a, const Trace& b) {
#define BITSPAN_TEST_EQUAL(Record, LIST, stage, member) expect_equal(a.member, b.member);
  BITSPAN_RECORDS(BITSPAN_TEST_EQUAL)
#undef BITSPAN_TEST_EQUAL
}

Trace trace_of(Engine& engine, const Scene& scene) {
  Trace trace;
  engine.begin(scene);
  engine.draw(scene.triangles, 0, &trace);
  return trace;
}

TEST(Precision, ShippedConfigurationsKeepPixelsOffQuad) {
  for (const std::string& name : shipped_names) {
    Config c = shipped_config(name);
    for (int mode = 0; mode < 4; ++mode) {
      c.perspective = static_cast<Perspective>(mode);
      const Precision p = choose_precision(c);
      EXPECT_NE(p.span, Width::quad) << name << " mode " << mode;
      for (const Width w : {p.depth, p.texture, p.fog, p.merge})
        EXPECT_EQ(w, Width::f64) << name << " mode " << mode;
    }
  }
}

TEST(Precision, RowsNameTheirStageAndType) {
  const Precision p = choose_precision(shipped_config("depth16"));
  for (const PrecisionRow& row : p.rows) {
    EXPECT_GE(significant_bits(row.width), row.held) << row.stage << ": " << row.expression;
    EXPECT_LE(row.bits, 113) << row.stage << ": " << row.expression;
    EXPECT_GE(row.bits, row.held) << row.stage << ": " << row.expression;
    EXPECT_FALSE(row.expression.empty());
  }
  EXPECT_GE(bits_of(p, "edge_walk", "X for edge.x"), 40);  // 2 * 16 integer and 8 fraction bits at least
}

TEST(Precision, GrowsWithTheFormats) {
  Config c = shipped_config("depth16");
  const int before = bits_of(choose_precision(c), "setup", "B (s_max - s)");
  c.format(FormatId::setup_s).word += 10;
  EXPECT_EQ(bits_of(choose_precision(c), "setup", "B (s_max - s)"), before + 10);
}

TEST(Precision, RefusesMoreThanQuadHolds) {
  Config c = shipped_config("depth16");
  c.format(FormatId::setup_s) = {57, 1, false, Rounding::rnd, Overflow::sat, false};
  c.format(FormatId::setup_b) = {60, 40, false, Rounding::rnd, Overflow::sat, false};
  const std::string text = input_error([&c] { make_golden(c); });
  for (const char* part : {"setup: ", "B (s_max - s)", "113"}) EXPECT_TRUE(names(text, part)) << text;
}

// B (s_max - s) needs 73 bits and is held as a pair of doubles. Against the rational of the definition, over
// vertices for most of which one double does not hold it, in every type.
TEST(Precision, ConstructedWorstCaseOfTheVertexDepth) {
  Config c = shipped_config("depth16");
  c.format(FormatId::setup_h).rounding = Rounding::trn;
  ASSERT_EQ(choose_precision(c).setup, Width::f64);
  ASSERT_GT(bits_of(choose_precision(c), "setup", "B (s_max - s)"), 64);
  Draw draw(31);
  int inexact = 0;
  for (int i = 0; i < 1000; ++i) {
    Scene scene = test_scene();
    scene.s_max = draw.real(1.5, 2.0);
    scene.s_min = draw.real(1.0, 1.4);
    const Constants k = make_constants(c, scene);
    Triangle t = random_triangle(draw, scene);
    t.v[0].x = 3;
    t.v[1].x = 50;
    t.v[2].y += 7;
    const auto& f = c.format(FormatId::setup_s);
    const Rational b = value_of(c.format(FormatId::setup_b), k.record.b);
    const Rational s_max = value_of(f, k.record.s_max);
    std::array<Int, 3> h;
    for (std::size_t j = 0; j < 3; ++j) {
      const Rational s = oracle_q(f, scale(rational_of(t.v[j].s), -k.s_exponent));
      h[j] = oracle_raw(c.format(FormatId::setup_h), b * (s_max - s) / s);
      const auto as_double = [](const Rational& x) { return static_cast<double>(x); };
      if (exact_product(as_double(b), as_double(s_max - s)).low != 0) ++inexact;
    }
    std::sort(h.begin(), h.end());
    for (const Width width : {Width::f64, Width::x87, Width::quad}) {
      for (const bool checked : {false, true}) {
        std::vector<SetupChannelRecord> channels;
        const auto record = make_setup({width, checked}, c, k)(t, 0, channels);
        if (!record) continue;
        std::array<Int, 3> got{record->h0, record->h1, record->h2};
        std::sort(got.begin(), got.end());
        ASSERT_EQ(got, h) << to_string(width);
      }
    }
  }
  EXPECT_GT(inexact, 2000);
}

// Coordinates so wide that x1 dy + dx t passes 53 bits: double loses pixels, the chosen type does not.
TEST(Precision, ConstructedWorstCaseOfTheExactEdge) {
  Config c = shipped_config("depth16");
  c.perspective = Perspective::affine;
  c.coordinate_bits = 24;  // vertices to 2^23 pixels
  c.subpixel_bits = 8;
  ASSERT_NE(choose_precision(c).edge_walk, Width::f64);
  Precision narrow = choose_precision(c);
  narrow.edge_walk = Width::f64;
  Draw draw(32);
  int differ = 0;
  int caught = 0;
  for (int i = 0; i < 60; ++i) {
    Scene scene = test_scene();
    Triangle t;
    // A long left edge through the centre of a pixel, which is therefore inside: x1 dy and dx t have more
    // than 61 bits, and all but 45 of them cancel.
    const std::int64_t a = (draw.flip() ? 2 : -2) * draw.integer(600000000, 1000000000) + 1;
    const std::int64_t b = 2 * draw.integer(600000000, 1000000000) + 1;
    const std::int64_t cx = 256 * draw.integer(0, scene.width - 1) + 128;
    const std::int64_t cy = 256 * draw.integer(0, scene.height - 1) + 128;
    t.v[0].x = static_cast<double>(cx - a) / 256;
    t.v[0].y = static_cast<double>(cy - b) / 256;
    t.v[1].x = static_cast<double>(cx + a) / 256;
    t.v[1].y = static_cast<double>(cy + b) / 256;
    t.v[2].x = 8000000;
    t.v[2].y = 0;
    for (Vertex& v : t.v) v.s = 50;
    scene.triangles = {t};
    const Trace exact = trace_of(*make_golden(c, true), scene);
    for (const RowRecord& row : exact.row) {
      const auto inside = [&](std::int64_t x) {
        // The exact side of the centre against the left edge, from the snapped vertices.
        const SetupRecord& s = exact.setup[0];
        const std::array<std::array<std::int64_t, 2>, 3> p{{{s.x0, s.y0}, {s.x1, s.y1}, {s.x2, s.y2}}};
        const std::size_t from = row.l_edge == 2 ? 1 : 0;
        const std::size_t to = row.l_edge == 1 ? 1 : 2;
        const Int px = Int(2 * x + 1) * 128;
        const Int py = Int(2 * row.y + 1) * 128;
        return (Int(p[to][1]) - p[from][1]) * (px - p[from][0]) -
                   (Int(p[to][0]) - p[from][0]) * (py - p[from][1]) >=
               0;
      };
      ASSERT_TRUE(inside(row.x_first));
      if (row.x_first > 0) {
        ASSERT_FALSE(inside(row.x_first - 1));
      }
    }
    Trace wrong = trace_of(*make_golden(c, narrow, false), scene);
    if (!(wrong.row == exact.row)) ++differ;
    try {
      trace_of(*make_golden(c, narrow, true), scene);
    } catch (const InexactError&) {
      ++caught;
    }
  }
  EXPECT_GT(differ, 0) << "no case showed that double is too narrow";
  EXPECT_GE(caught, differ);
}

// Vertices at the ends of double's range: scaling them loses neither their sign nor their size.
TEST(Precision, ExtremeInputs) {
  Config c = shipped_config("depth16");
  c.format(FormatId::setup_uv) = {8, 12, true, Rounding::trn, Overflow::sat, false};  // ulp 16
  Scene scene = test_scene();
  const Constants k = make_constants(c, scene);
  Triangle t;
  t.v[0] = {{0, 0, 2}, {-1e-310, 5e-324}};
  t.v[1] = {{1e308, 0, 2}, {1e308, -1e308}};
  t.v[2] = {{0, 9, 2}, {-1e-10, -5e-324}};
  for (const Width width : {Width::f64, Width::x87, Width::quad}) {
    std::vector<SetupChannelRecord> channels;
    const auto r = make_setup({width, false}, c, k)(t, 0, channels);
    ASSERT_TRUE(r);
    EXPECT_EQ(r->u0, -1) << to_string(width);
    EXPECT_EQ(r->v0, 0);
    EXPECT_EQ(r->x1, (std::int64_t{1} << (c.coordinate_format().word - 1)) - 1);
    EXPECT_EQ(r->u1, 127);
    EXPECT_EQ(r->v1, -128);
    EXPECT_EQ(r->u2, -1);
    EXPECT_EQ(r->v2, -1);
  }
}

// Random configurations and scenes: every sum and product of the chosen types is verified, and the records
// are those of quadruple precision throughout.
TEST(Precision, ChosenTypesAreExactOverRandomConfigurations) {
  Draw draw(33);
  int run = 0;
  std::size_t fragments = 0;
  std::array<int, 4> modes{};
  const std::vector<Config> bases = shipped_configs();
  RandomConfigOptions options;
  options.check = [](const Config& c) { static_cast<void>(choose_precision(c)); };
  for (int i = 0; i < 150; ++i) {
    const Config c = random_config(static_cast<std::uint64_t>(i), bases, options);
    Scene scene = test_scene();
    for (int j = 0; j < 6; ++j) scene.triangles.push_back(random_triangle(draw, scene));
    Trace chosen;
    try {
      chosen = trace_of(*make_golden(c, true), scene);
    } catch (const InputError&) {
      continue;
    }
    const Trace plain = trace_of(*make_golden(c, false), scene);
    expect_equal(chosen, plain);
    if (i % 3 == 0) expect_equal(chosen, trace_of(*make_golden(c, all_in(Width::quad), false), scene));
    if (HasFatalFailure()) {
      FAIL() << "case " << i << "\n" << to_toml(c);
    }
    ++run;
    ++modes[static_cast<std::size_t>(c.perspective)];
    fragments += chosen.fragment.size();
  }
  EXPECT_GT(run, 100);
  EXPECT_GT(fragments, 100000U);
  for (const int count : modes) EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace bitspan::test
