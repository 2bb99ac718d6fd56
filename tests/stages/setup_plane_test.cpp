// SPDX-License-Identifier: Apache-2.0
// slope.row = plane: setup.plane, edge_walk and span_setup by values worked by hand, and both engines against
// exact rationals and each other.
#include "model/stages/setup_plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "engine/rows.hpp"
#include "golden/engine_golden.hpp"
#include "golden/setup_plane.hpp"
#include "golden/span_setup.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "scene/random.hpp"
#include "tests/golden/golden_support.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

Config plane_config(Perspective perspective = Perspective::delta_f) {
  Config c = plain_config();
  c.perspective = perspective;
  c.row_slope = RowSlope::plane;
  return c;
}

// One triangle through the model, and through golden, which must say the same.
struct Planed {
  Planed(const Config& c, const Triangle& t) : config(c) {
    const Scene scene = worked_scene();
    const model::Pipeline pipeline = model::make_pipeline(c, scene);
    EXPECT_TRUE(model::setup(pipeline.setup, t, 3, setup));
    plane = model::setup_plane(pipeline.setup_plane, setup);
    const golden::Constants constants = golden::make_constants(c, scene);
    EXPECT_EQ(golden::make_setup_plane({golden::Width::quad, true}, c, constants)(setup, {}), plane.record);
    model::Rows rows;
    model::PlaneWalkState walk;
    Trace trace;
    EXPECT_TRUE(model::triangle_to_rows(pipeline, t, 3, walk, rows, counters, &trace));
    EXPECT_EQ(trace.setup_plane, std::vector{plane.record});
    edges = trace.edge;
    this->rows = trace.row;
    const auto span = golden::make_triangle_span_setup({golden::Width::quad, true}, c, constants);
    std::vector<SpanChannelRecord> channels;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      spans.push_back(model::row_to_span(pipeline, rows, i, counters));
      EXPECT_EQ(span(rows.rows[i], setup, plane.record, {}, channels), spans.back());
    }
  }
  double value(std::int64_t raw, FormatId id) const { return decoded(raw, config.format(id)); }
  Config config;
  SetupRecord setup;
  model::TrianglePlane plane;
  std::vector<EdgeRecord> edges;
  std::vector<RowRecord> rows;
  std::vector<SpanRecord> spans;
  Counters counters;
};

// s = 2, where h = 0 and q = B = 65535; u = 3 x + 5 y + 7, v = x; red rises by 1/64 along x.
Triangle slanted() {
  const auto at = [](double x, double y) {
    Vertex v = vertex(x, y, 2, 3 * x + 5 * y + 7, x);
    v.c = {x / 64, 0.5, 1, 1};
    return v;
  };
  return triangle(at(8, 4), at(40, 20), at(8, 36));
}

TEST(SetupPlane, GradientsAndStartsAreThoseOfThePlane) {
  for (const bool mirrored : {false, true}) {  // vertex 1 right of edge 0-2, and left of it
    Triangle t = slanted();
    if (mirrored) {
      for (Vertex& v : t.v) v.x = 48 - v.x;
    }
    const double sign = mirrored ? -1 : 1;
    const Planed p(plane_config(), t);
    const SetupPlaneRecord& r = p.plane.record;
    EXPECT_EQ(r.triangle, 3);
    EXPECT_EQ(r.recip_m, 0);
    EXPECT_EQ(r.recip_e, 0);
    // Vertex 0 is (8, 4), or (40, 4).
    EXPECT_EQ(p.value(r.u1, FormatId::edge_uv), 51);
    EXPECT_EQ(p.value(r.v1, FormatId::edge_uv), 8);
    EXPECT_EQ(r.fu0, 0);
    EXPECT_EQ(p.value(r.fu1, FormatId::plane_g), 176 * 65535.0);
    EXPECT_EQ(p.value(r.fu2, FormatId::plane_g), 160 * 65535.0);
    EXPECT_EQ(r.h_x, 0);
    EXPECT_EQ(r.h_y, 0);
    EXPECT_EQ(p.value(r.fu_x, FormatId::plane_g_grad), sign * 3 * 65535);
    EXPECT_EQ(p.value(r.fu_y, FormatId::plane_g_grad), 5 * 65535);
    EXPECT_EQ(p.value(r.fv_x, FormatId::plane_g_grad), sign * 65535);
    EXPECT_EQ(r.fv_y, 0);
    EXPECT_EQ(p.value(r.r_x, FormatId::plane_shade_grad), sign / 64);
    EXPECT_EQ(r.r_y, 0);
    EXPECT_EQ(r.g_x, 0);
    ASSERT_EQ(p.spans.size(), 32U);
    for (const SpanRecord& s : p.spans) {
      const double x = static_cast<double>(s.x) + 0.5 - (mirrored ? 40 : 8);
      const double y = static_cast<double>(s.y) + 0.5 - 4;
      EXPECT_EQ(s.h, 0);
      EXPECT_EQ(s.h_step, 0);
      EXPECT_EQ(s.u1, r.u1);
      EXPECT_EQ(p.value(s.fu, FormatId::span_f), (sign * 3 * x + 5 * y) * 65535);
      EXPECT_EQ(p.value(s.fu_step0, FormatId::span_f_step), sign * 3 * 65535);
      EXPECT_EQ(s.fu_step1, s.fu_step0);
      EXPECT_EQ(p.value(s.fv, FormatId::span_f), sign * x * 65535);
      EXPECT_EQ(p.value(s.r, FormatId::span_shade_acc), 0.125 + sign * x / 64);
      EXPECT_EQ(p.value(s.r_step1, FormatId::span_shade_step), sign / 64);
      EXPECT_EQ(p.value(s.g, FormatId::span_shade_acc), 0.5);
      EXPECT_EQ(s.recip_m, 0);
      EXPECT_EQ(s.fu_diff, 0);
    }
    EXPECT_EQ(p.counters.divides_edge, 14U);
    EXPECT_EQ(p.counters.divides_row, 0U);
  }
}

TEST(SetupPlane, NumeratorsGoByThePerspective) {
  const Planed hyperbolic(plane_config(Perspective::hyperbolic), slanted());
  EXPECT_EQ(hyperbolic.plane.record.u1, 0);
  EXPECT_EQ(hyperbolic.value(hyperbolic.plane.record.fu0, FormatId::plane_g), 51 * 65535.0);
  EXPECT_EQ(hyperbolic.value(hyperbolic.spans[0].fu, FormatId::span_f), (51 + 1.5 + 2.5) * 65535);
  const Planed affine(plane_config(Perspective::affine), slanted());
  EXPECT_EQ(affine.value(affine.plane.record.fu0, FormatId::plane_g), 51);
  EXPECT_EQ(affine.value(affine.plane.record.fu_x, FormatId::plane_g_grad), 3);
  EXPECT_EQ(affine.spans[0].u1, 0);
  EXPECT_EQ(affine.value(affine.spans[0].fu, FormatId::span_uv_acc), 55);
  EXPECT_EQ(affine.value(affine.spans[0].fu_step0, FormatId::span_uv_step), 3);
}

// area = 32 32 = 2^10, so R_edge gives m = 1, e = 10 and every product is exact.
TEST(SetupPlane, OneReciprocalOfTheAreaGivesAllGradients) {
  Config c = plane_config();
  c.edge_slope = SlopeForm::reciprocal;
  for (const bool mirrored : {false, true}) {
    Triangle t = slanted();
    if (mirrored) {
      for (Vertex& v : t.v) v.x = 48 - v.x;
    }
    const Planed p(c, t);
    EXPECT_EQ(decoded(p.plane.record.recip_m, c.edge_reciprocal.output), 1);
    EXPECT_EQ(p.plane.record.recip_e, 10);
    EXPECT_EQ(p.value(p.plane.record.fu_x, FormatId::plane_g_grad), (mirrored ? -3 : 3) * 65535);
    EXPECT_EQ(p.value(p.plane.record.fu_y, FormatId::plane_g_grad), 5 * 65535);
    EXPECT_EQ(p.counters.divides_edge, 1U);
  }
  // An area of 3 2^k: m is 1/1.5, rounded. Each gradient takes the rounded one.
  c.edge_reciprocal.output = {5, 1, false, Rounding::rnd, Overflow::sat, false};  // 11/16 for 2/3
  const Triangle third = triangle(vertex(0, 0, 2, 0), vertex(48, 0, 2, 48), vertex(0, 32, 2, 0));
  const Planed coarse(c, third);
  EXPECT_EQ(coarse.plane.record.recip_m, 11);
  EXPECT_EQ(coarse.value(coarse.plane.record.fu_x, FormatId::plane_g_grad), 65535 * 1.5 * 11 / 16);
}

TEST(SetupPlane, EdgesHaveAPositionAlone) {
  for (const EdgeWalk walk : {EdgeWalk::exact, EdgeWalk::dda}) {
    for (const SlopeForm form : {SlopeForm::divide, SlopeForm::reciprocal}) {
      Config c = plane_config();
      c.edge_walk = walk;
      c.edge_slope = form;
      c.start_offset.edge_h = c.start_offset.edge_f = c.start_offset.edge_shade = {true, 0};
      Triangle t = slanted();
      for (Vertex& v : t.v) v.s = 1.5 + v.x / 100;
      const Planed p(c, t);
      const bool dda = walk == EdgeWalk::dda;
      for (const EdgeRecord& e : p.edges) {
        EdgeRecord rest = e;
        rest.triangle = rest.edge = rest.recip_m = rest.recip_e = rest.x_step = 0;
        EXPECT_EQ(rest, EdgeRecord{});
        EXPECT_EQ(e.recip_m != 0, dda && form == SlopeForm::reciprocal);
        EXPECT_EQ(e.x_step != 0, dda && e.edge != 0);
      }
      for (const RowRecord& r : p.rows) {
        RowRecord rest;
        rest.triangle = r.triangle;
        rest.y = r.y;
        rest.x_first = r.x_first;
        rest.x_last = r.x_last;
        rest.l_edge = r.l_edge;
        rest.r_edge = r.r_edge;
        rest.l_x_acc = r.l_x_acc;
        rest.r_x_acc = r.r_x_acc;
        rest.l_x = r.l_x;
        rest.r_x = r.r_x;
        EXPECT_EQ(rest, r);
        EXPECT_NE(r.r_x, 0);
      }
      EXPECT_EQ(p.counters.divides_edge, (form == SlopeForm::divide ? 14U : 1U) + (dda ? 3U : 0U));
    }
  }
}

// A span of one pixel at a sliver's tip has the plane's value, where a row's ends lie an ulp of edge.x apart.
TEST(SetupPlane, OffsetsAreAddedOnce) {
  Config c = plane_config();
  c.format(FormatId::span_h) = {20, 18, true, Rounding::trn, Overflow::sat, false};
  c.start_offset.span_h = {false, 3};
  c.start_offset.span_shade = {false, 0.25};
  c.start_offset.span_f = {false, -2};
  const Planed p(c, slanted());
  EXPECT_EQ(p.value(p.spans[0].h, FormatId::span_h), 3);
  EXPECT_EQ(p.value(p.spans[0].g, FormatId::span_shade_acc), 0.75);
  EXPECT_EQ(p.value(p.spans[0].fu, FormatId::span_f), (1.5 + 2.5) * 65535 - 2);
}

// Golden against rationals formed directly from the specification's text.
TEST(SetupPlane, GoldenEqualsTheSpecification) {
  using namespace bitspan::test;
  Draw draw(4711);
  int gradients = 0;
  int spans = 0;
  for (int i = 0; i < 60; ++i) {
    Config c = shipped_config(i % 2 == 0 ? "depth16" : "narrow");
    c.row_slope = RowSlope::plane;
    c.edge_slope = i % 3 == 0 ? SlopeForm::divide : SlopeForm::reciprocal;
    c.perspective = std::array{Perspective::delta_f, Perspective::hyperbolic,
                               Perspective::affine}[static_cast<std::size_t>(i / 2 % 3)];
    for (Format& f : c.formats) f.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
    const auto f = [&](FormatId id) -> const Format& { return c.format(id); };
    const auto val = [&](FormatId id, std::int64_t raw) { return value_of(f(id), raw); };
    Scene scene = test_scene();
    scene.triangles = {random_triangle(draw, scene)};
    const auto engine = make_golden(c, true);
    Trace t;
    engine->begin(scene);
    engine->draw(scene.triangles, 0, &t);
    if (t.setup.empty()) continue;
    const SetupRecord& s = t.setup[0];
    const SetupPlaneRecord& p = t.setup_plane.at(0);
    const Format xy = c.coordinate_format();
    using Triple = std::array<Rational, 3>;
    const Triple x{value_of(xy, s.x0), value_of(xy, s.x1), value_of(xy, s.x2)};
    const Triple y{value_of(xy, s.y0), value_of(xy, s.y1), value_of(xy, s.y2)};
    const Triple h{val(FormatId::setup_h, s.h0), val(FormatId::setup_h, s.h1), val(FormatId::setup_h, s.h2)};
    const Triple u{val(FormatId::setup_uv, s.u0), val(FormatId::setup_uv, s.u1),
                   val(FormatId::setup_uv, s.u2)};
    const Triple red{val(FormatId::setup_shade, s.r0), val(FormatId::setup_shade, s.r1),
                     val(FormatId::setup_shade, s.r2)};
    const Rational b = val(FormatId::setup_b, t.constants.at(0).b);
    const Rational area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    Rational inverse = 1 / area;
    if (c.edge_slope == SlopeForm::reciprocal) {
      const Rational n = abs(area) / scale(Rational(1), static_cast<int>(p.recip_e));
      ASSERT_TRUE(n >= 1 && n < 2);
      ASSERT_EQ(Int(p.recip_m), oracle_raw(c.edge_reciprocal.output, 1 / n));
      inverse = scale(value_of(c.edge_reciprocal.output, p.recip_m), -static_cast<int>(p.recip_e));
      if (area < 0) inverse = -inverse;
    }
    Triple fu;
    const std::array<std::int64_t, 3> raw{p.fu0, p.fu1, p.fu2};
    for (std::size_t k = 0; k < 3; ++k) {
      fu[k] = val(FormatId::plane_g, raw[k]);
      const Rational want = c.perspective == Perspective::affine ? u[k]
                            : c.perspective == Perspective::hyperbolic
                                ? Rational(u[k] * (h[k] + b))
                                : Rational((u[k] - val(FormatId::edge_uv, p.u1)) * (h[k] + b));
      ASSERT_EQ(Int(raw[k]), oracle_raw(f(FormatId::plane_g), want));
    }
    const auto check = [&](const Triple& w, FormatId id, std::int64_t w_x, std::int64_t w_y) {
      const Rational nx = (w[1] - w[0]) * (y[2] - y[0]) - (w[2] - w[0]) * (y[1] - y[0]);
      const Rational ny = (w[2] - w[0]) * (x[1] - x[0]) - (w[1] - w[0]) * (x[2] - x[0]);
      ASSERT_EQ(Int(w_x), oracle_raw(f(id), nx * inverse));
      ASSERT_EQ(Int(w_y), oracle_raw(f(id), ny * inverse));
      ++gradients;
    };
    check(h, FormatId::plane_h_grad, p.h_x, p.h_y);
    check(fu, FormatId::plane_g_grad, p.fu_x, p.fu_y);
    check(red, FormatId::plane_shade_grad, p.r_x, p.r_y);
    const bool affine = c.perspective == Perspective::affine;
    const FormatId start = affine ? FormatId::span_uv_acc : FormatId::span_f;
    const FormatId step = affine ? FormatId::span_uv_step : FormatId::span_f_step;
    const Rational offset_f =
        scale(Rational(1), -f(affine ? FormatId::span_uv : FormatId::span_f).fraction() - 1);
    ASSERT_TRUE(c.start_offset.span_f.half_ulp);
    ASSERT_EQ(c.start_offset.span_h.value, 0);
    for (const SpanRecord& span : t.span) {
      const Rational right = Rational(Int(2 * span.x + 1), Int(2)) - x[0];
      const Rational down = Rational(Int(2 * span.y + 1), Int(2)) - y[0];
      const auto at = [&](const Rational& from, FormatId id, std::int64_t w_x, std::int64_t w_y) {
        return Rational(from + val(id, w_x) * right + val(id, w_y) * down);
      };
      ASSERT_EQ(Int(span.h), oracle_raw(f(FormatId::span_h), at(h[0], FormatId::plane_h_grad, p.h_x, p.h_y)));
      ASSERT_EQ(Int(span.h_step), oracle_raw(f(FormatId::span_h_step), val(FormatId::plane_h_grad, p.h_x)));
      ASSERT_EQ(Int(span.fu),
                oracle_raw(f(start), at(fu[0], FormatId::plane_g_grad, p.fu_x, p.fu_y) + offset_f));
      ASSERT_EQ(Int(span.fu_step0), oracle_raw(f(step), val(FormatId::plane_g_grad, p.fu_x)));
      ++spans;
    }
  }
  EXPECT_GT(gradients, 100);
  EXPECT_GT(spans, 500);
}

// Every form of the model and golden over random triangles, slivers among them.
TEST(SetupPlane, GoldenEqualsTheModel) {
  std::size_t records = 0;
  std::size_t fragments = 0;
  std::uint64_t seed = 900;
  for (const Config& base : shipped_configs()) {
    for (const Perspective perspective : all_perspectives) {
      for (const EdgeWalk walk : {EdgeWalk::exact, EdgeWalk::dda}) {
        for (const SlopeForm form : {SlopeForm::divide, SlopeForm::reciprocal}) {
          Config c = base;
          c.perspective = perspective;
          c.edge_walk = walk;
          c.edge_slope = form;
          c.row_slope = RowSlope::plane;
          if (first_violation(c)) {
            ASSERT_TRUE(has_plane_rows(perspective)) << first_violation(c)->text;
            ASSERT_EQ(first_violation(c)->key, "slope.row");
            continue;
          }
          const Scene scene = random_scene(
              ++seed,
              {.width = 64, .height = 48, .triangles = 40, .size_min = 0.2, .size_max = 60, .uv_limit = 400});
          Trace want;
          const auto golden = make_golden(c, true);
          golden->begin(scene);
          golden->draw(scene.triangles, 0, &want);
          for (const ModelForm model_form : {ModelForm::scalar, ModelForm::vector}) {
            Trace got;
            const auto model = make_model(c, {.form = model_form});
            model->begin(scene);
            model->draw(scene.triangles, 0, &got);
            ASSERT_EQ(want.setup_plane, got.setup_plane) << "seed " << seed;
            ASSERT_EQ(want.edge, got.edge) << "seed " << seed;
            ASSERT_EQ(want.row, got.row) << "seed " << seed;
            ASSERT_EQ(want.span, got.span) << "seed " << seed;
            ASSERT_EQ(want.fragment, got.fragment) << "seed " << seed;
            ASSERT_EQ(want.merge, got.merge) << "seed " << seed;
            ASSERT_EQ(golden->counters(), model->counters()) << "seed " << seed;
            const auto quiet = make_model(c, {.form = model_form, .threads = 2});
            quiet->begin(scene);
            quiet->draw(scene.triangles, 0, nullptr);
            ASSERT_EQ(quiet->frame().color, golden->frame().color) << "seed " << seed;
            ASSERT_EQ(quiet->frame().depth, golden->frame().depth) << "seed " << seed;
            ASSERT_EQ(quiet->counters(), golden->counters()) << "seed " << seed;
          }
          EXPECT_EQ(want.setup_plane.size(), want.setup.size());
          EXPECT_EQ(golden->counters().divides_row, 0U);
          records += want.setup_plane.size();
          fragments += want.fragment.size();
        }
      }
    }
  }
  EXPECT_GT(records, 500U);
  EXPECT_GT(fragments, 10000U);
}

TEST(SetupPlane, ARowOfEdgeWalkHasNoPlane) {
  const Config c = plane_config();
  const Scene scene = worked_scene();
  for (const auto& engine : {make_model(c, {.form = ModelForm::scalar}), make_golden(c, true)}) {
    engine->begin(scene);
    auto* rows = dynamic_cast<RowEngine*>(engine.get());
    ASSERT_NE(rows, nullptr);
    EXPECT_THROW(rows->draw_row(RowRecord{}, 0, -1, nullptr), InputError);
    SpanRecord span;
    span.count = 1;
    EXPECT_NO_THROW(rows->draw_row(span, 0, -1, nullptr));
    EXPECT_EQ(engine->counters().fragments, 1U);
  }
}

}  // namespace
}  // namespace bitspan
