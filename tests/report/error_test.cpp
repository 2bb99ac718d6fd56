// SPDX-License-Identifier: Apache-2.0
// Errors against the closed form: zero for records made from it, and coverage by the exact test.
#include "report/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/engine_model.hpp"
#include "report/metrics.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Config config() { return shipped_config("depth16"); }

// A quad of two triangles that share their diagonal, in perspective, on a textured plane.
Scene scene() {
  Scene s;
  s.name = "quad";
  s.width = 64;
  s.height = 48;
  s.s_min = 1;
  s.s_max = 100;
  s.fog = Fog{{200, 210, 220}, 80};
  const Vertex a{3.3, 2.7, 4, 0, 0, {1, 0.5, 0.25, 1}};
  const Vertex b{60.1, 5.2, 40, 64, 0, {0.5, 1, 1, 1}};
  const Vertex c{58.4, 44.9, 30, 64, 64, {1, 1, 0, 1}};
  const Vertex d{1.2, 46.6, 3, 0, 64, {0, 1, 1, 1}};
  s.triangles = {{{a, b, c}, -1}, {{a, c, d}, -1}};
  return s;
}

Trace draw(const Scene& s) {
  const auto engine = make_model(config());
  engine->begin(s);
  Trace trace;
  engine->draw(s.triangles, 0, &trace);
  return trace;
}

const ErrorRow& row(const ErrorReport& report, std::string_view stage, std::string_view quantity) {
  for (const ErrorRow& r : report.rows) {
    if (r.stage == stage && r.quantity == quantity) {
      return r;
    }
  }
  throw std::out_of_range("row");
}

TEST(Error, TheModelIsCloseAndCoversExactly) {
  const Scene s = scene();
  const Trace trace = draw(s);
  ErrorMeter meter(config(), s);
  meter.add(s.triangles, 0, trace);
  const ErrorReport& report = meter.report();
  EXPECT_EQ(report.coverage_differences(), 0U);
  EXPECT_EQ(report.covered, trace.fragment.size());
  EXPECT_GT(report.covered, 2000U);
  EXPECT_EQ(row(report, "setup", "h").stat.count, 6U);
  EXPECT_LT(row(report, "setup", "h").stat.max, 0.01);
  EXPECT_LT(row(report, "edge_walk", "h").stat.max, 1.0);
  EXPECT_LT(row(report, "edge_walk", "u").stat.max, 0.1);
  EXPECT_LT(row(report, "edge_walk", "x").stat.max, 0.01);
  EXPECT_LT(row(report, "span", "u").stat.max, 0.25);
  EXPECT_LT(row(report, "span", "shade").stat.max, 0.01);
  EXPECT_LT(row(report, "depth", "z").stat.max, 2.0);
  EXPECT_LT(row(report, "texture", "colour").stat.max, 2.0);
  EXPECT_GT(row(report, "fog", "factor").stat.max, 0.0) << "1024 entries are not the truth";
  EXPECT_LT(row(report, "fog", "factor").stat.max, 0.1);
}

// Rows by the triangle's plane have no values at their ends, and so no error there.
TEST(Error, EndsWithoutValuesAreNotMeasured) {
  const Scene s = scene();
  Config c = config();
  c.row_slope = RowSlope::plane;
  const auto engine = make_model(c);
  engine->begin(s);
  Trace trace;
  engine->draw(s.triangles, 0, &trace);
  ErrorMeter meter(c, s);
  meter.add(s.triangles, 0, trace);
  const ErrorReport& report = meter.report();
  EXPECT_GT(row(report, "edge_walk", "x").stat.count, 0U);
  EXPECT_EQ(row(report, "edge_walk", "h").stat.count, 0U);
  EXPECT_EQ(row(report, "edge_walk", "u").stat.count, 0U);
  EXPECT_LT(row(report, "span", "h").stat.max, 0.01);
  EXPECT_LT(row(report, "span", "u").stat.max, 0.01);
  const auto raw = raw_values(trace.row[0]);
  EXPECT_TRUE(ideal_value(RecordType::row, "l_x", raw, c, s, s.triangles[0]));
  EXPECT_FALSE(ideal_value(RecordType::row, "l_h", raw, c, s, s.triangles[0]));
}

// Where the light works, the parts of a brightness are close to the truth, and a change of one of them shows
// in its own row alone.
TEST(Error, EachPartOfALightIsMeasured) {
  Scene s = scene();
  s.light = Light{.is_point = true, .place = {-10, -20, -5}, .ambient = 0.2, .specular = 0.3, .exponent = 32};
  for (Triangle& t : s.triangles) {
    for (Vertex& v : t.v) v.nx = 0.4, v.ny = -0.3, v.nz = -0.8;
  }
  Config c = config();
  c.light_source = LightSource::point;
  for (const LightAt at : {LightAt::face, LightAt::vertex, LightAt::pixel}) {
    c.light = at;
    const auto engine = make_model(c);
    engine->begin(s);
    Trace trace;
    engine->draw(s.triangles, 0, &trace);
    ASSERT_GT(trace.light.size(), 1000U);
    const auto measured = [&] {
      ErrorMeter meter(c, s);
      meter.add(s.triangles, 0, trace);
      return meter.report();
    };
    const ErrorReport before = measured();
    const bool at_pixels = at == LightAt::pixel;
    for (const auto* part : {"normal", "direction", "cosine", "specular"}) {
      const ErrorStat& stat = row(before, "light", part).stat;
      EXPECT_EQ(stat.count != 0, at_pixels) << part;
      EXPECT_LT(stat.max, 1e-3) << part;
      EXPECT_EQ(stat.power > 0, at_pixels) << part;
    }
    EXPECT_EQ(row(before, "light", "value").stat.count, trace.light.size());
    EXPECT_LT(row(before, "light", "value").stat.max, 1e-3);
    EXPECT_LT(row(before, "light", "colour").stat.max, 0.25);
    for (LightRecord& r : trace.light) r.value += 4, r.cosine += 8;
    const ErrorReport after = measured();
    for (std::size_t i = 0; i < after.rows.size(); ++i) {
      const ErrorRow& r = after.rows[i];
      const bool is_moved =
          r.stage == "light" && (r.quantity == "value" || (at_pixels && r.quantity == "cosine"));
      const double by = is_moved ? (r.quantity == "value" ? 4 : 8) * r.ulp : 0;
      EXPECT_NEAR(r.stat.mean(), before.rows[i].stat.mean() + by, 1e-12) << r.stage << "." << r.quantity;
    }
  }
}

TEST(Error, AnOffsetIsMeasuredAsItself) {
  const Scene s = scene();
  Trace trace = draw(s);
  ErrorMeter before(config(), s);
  before.add(s.triangles, 0, trace);
  const double ulp = std::ldexp(1.0, -config().format(FormatId::span_uv).fraction());
  for (FragmentRecord& f : trace.fragment) {
    f.u += 1000;
  }
  ErrorMeter after(config(), s);
  after.add(s.triangles, 0, trace);
  EXPECT_NEAR(row(after.report(), "span", "u").stat.mean() - row(before.report(), "span", "u").stat.mean(),
              1000 * ulp, 1e-6);
}

TEST(Error, CoverageFindsMissedSurplusAndDoubledPixels) {
  const Scene s = scene();
  Trace trace = draw(s);
  trace.fragment.front().x = 0;  // one missed, one surplus
  trace.fragment.front().y = 0;
  trace.fragment[10].covered = 0;           // missed
  trace.fragment[20] = trace.fragment[21];  // one missed, one doubled
  ErrorMeter meter(config(), s);
  meter.add(s.triangles, 0, trace);
  EXPECT_EQ(meter.report().missed, 3U);
  EXPECT_EQ(meter.report().surplus, 1U);
  EXPECT_EQ(meter.report().doubled, 1U);
}

TEST(Error, PicturesGivePsnrOrderAndMaximum) {
  const Scene s = scene();
  Frame a;
  a.width = 2;
  a.height = 1;
  a.color = {10, 20, 30, 255, 0, 0, 0, 255};
  a.depth = {5, 6};
  a.u = a.v = {1, 2};
  a.triangle = {0, 1};
  ErrorMeter equal(config(), s);
  equal.add_pictures(a, a);
  EXPECT_TRUE(std::isinf(*picture_value(equal.report(), "picture.psnr_db")));
  Frame b = a;
  b.color[0] = 13;
  b.triangle[1] = 0;
  ErrorMeter meter(config(), s);
  meter.add_pictures(a, b);
  EXPECT_EQ(picture_value(meter.report(), "picture.color_max"), 3);
  EXPECT_EQ(picture_value(meter.report(), "picture.wrong_order"), 1);
  EXPECT_EQ(picture_value(meter.report(), "picture.drawn"), 2);
  EXPECT_NEAR(*picture_value(meter.report(), "picture.psnr_db"), 10 * std::log10(255.0 * 255.0 * 6 / 9),
              1e-9);
}

TEST(Error, PicturesErrWhereTheSameTriangleWon) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  // Same triangle twice, another one, none in one, none in both.
  const Frame engine{5, 1, {}, {10, 9, 7, 0, 0}, {1, 2, 3, nan, nan}, {5, 6, 7, nan, nan}, {0, 3, 2, -1, -1}};
  const Frame ideal{5, 1, {}, {13, 9, 5, 4, 0}, {4, 2, 3, 8, nan}, {1, 6.5, 7, 9, nan}, {0, 3, 1, 1, -1}};
  const PictureErrors errors = picture_errors(engine, ideal);
  ASSERT_EQ(errors.depth.size(), 5U);
  ASSERT_EQ(errors.texture.size(), 5U);
  EXPECT_EQ(errors.depth[0], 3);
  EXPECT_EQ(errors.texture[0], 5);
  EXPECT_EQ(errors.depth[1], 0);
  EXPECT_EQ(errors.texture[1], 0.5);
  for (std::size_t i = 2; i < 5; ++i) {
    EXPECT_TRUE(std::isnan(errors.depth[i])) << i;
    EXPECT_TRUE(std::isnan(errors.texture[i])) << i;
  }
}

TEST(Error, TheIdealOfARecordIsTheSurfaceAtItsPixel) {
  const Scene s = scene();
  const Trace trace = draw(s);
  const FragmentRecord& f = trace.fragment[trace.fragment.size() / 2];
  const auto raw = raw_values(f);
  const auto& triangle = s.triangles[static_cast<std::size_t>(f.triangle)];
  const auto u = ideal_value(RecordType::fragment, "u", raw, config(), s, triangle);
  ASSERT_TRUE(u);
  const double ulp = std::ldexp(1.0, -config().format(FormatId::span_uv).fraction());
  EXPECT_NEAR(*u, static_cast<double>(f.u) * ulp, 0.25);
  EXPECT_FALSE(ideal_value(RecordType::fragment, "recip_m", raw, config(), s, triangle));
}

}  // namespace
}  // namespace bitspan
