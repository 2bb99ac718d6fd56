// SPDX-License-Identifier: Apache-2.0
// The stages of golden by hand-computed cases and by properties that hold for every configuration.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "golden/depth.hpp"
#include "golden/engine_golden.hpp"
#include "golden/fog.hpp"
#include "golden/ideal.hpp"
#include "golden/merge.hpp"
#include "golden/texture.hpp"
#include "tests/golden/golden_support.hpp"

namespace bitspan::test {
namespace {

using namespace bitspan::golden;

constexpr Arithmetic checked_double{Width::f64, true};     // a record at a time
constexpr Arithmetic unchecked_double{Width::f64, false};  // in columns

// One fragment through a stage that takes many.
TextureRecord textured(Arithmetic arithmetic, const Config& c, const FragmentRecord& f, const Texture& t) {
  const FragmentRecord* one = &f;
  std::vector<TextureRecord> out;
  make_texture(arithmetic, c)({&one, 1}, &t, first_state(c), out);
  return out.at(0);
}
FogRecord fogged(Arithmetic arithmetic, const Config& c, const Constants& k, const Scene& scene,
                 const FragmentRecord& f, const TextureRecord& t) {
  const FragmentRecord* fragment = &f;
  const TextureRecord* texture = &t;
  std::vector<FogRecord> out;
  make_fog(arithmetic, c, k, scene)({&fragment, 1}, {&texture, 1}, {}, {}, out);
  return out.at(0);
}
MergeRecord merged_onto(const std::array<std::uint8_t, 3>& stored, Arithmetic arithmetic, const Config& c,
                        const FogRecord& fog, const TextureRecord& t, const DepthRecord& d) {
  const TextureRecord* texture = &t;
  const DepthRecord* depth = &d;
  const std::size_t pixels = static_cast<std::size_t>(fog.x) + 1;
  std::vector<std::uint8_t> picture(4 * pixels);
  std::copy(stored.begin(), stored.end(), picture.end() - 4);
  std::vector<MergeRecord> out;
  std::vector<MergeAlphaRecord> alphas;
  make_merge(arithmetic, c)({&fog, 1}, {&texture, 1}, {&depth, 1}, first_state(c), picture,
                            {static_cast<int>(pixels)}, out, alphas);
  EXPECT_TRUE(alphas.empty());
  return out.at(0);
}

Trace trace_of(const Config& c, const Scene& scene, Counters* counters = nullptr) {
  const auto engine = make_golden(c, true);
  Trace trace;
  engine->begin(scene);
  engine->draw(scene.triangles, 0, &trace);
  if (counters != nullptr) *counters = engine->counters();
  return trace;
}

Config exact_config(const char* name, Perspective perspective, FillRule rule) {
  Config c = shipped_config(name);
  c.perspective = perspective;
  c.fill_rule = rule;
  c.edge_walk = EdgeWalk::exact;
  return c;
}

// Every mode covers exactly the pixels of the independent test of each centre, and none twice.
TEST(GoldenStage, CoverageIsExact) {
  Draw draw(41);
  std::size_t pixels = 0;
  for (const Perspective perspective :
       {Perspective::delta_f, Perspective::const_depth_rows, Perspective::affine}) {
    for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
      const Config c = exact_config("narrow", perspective, rule);
      for (int i = 0; i < 150; ++i) {
        Scene scene = test_scene(48, 40);
        scene.triangles = {random_triangle(draw, scene)};
        const Trace trace = trace_of(c, scene);
        std::set<std::array<std::int64_t, 2>> got;
        for (const DepthRecord& d : trace.depth) {
          ASSERT_TRUE(got.insert({d.x, d.y}).second) << "pixel " << d.x << "," << d.y << " twice";
        }
        const auto ideal = ideal_triangle(c, scene.triangles[0]);
        std::set<std::array<std::int64_t, 2>> want;
        for (std::int64_t y = 0; ideal && y < scene.height; ++y) {
          for (std::int64_t x = 0; x < scene.width; ++x) {
            if (ideal_covers(c, *ideal, x, y)) want.insert({x, y});
          }
        }
        ASSERT_EQ(got, want) << "mode " << static_cast<int>(perspective) << " case " << i;
        pixels += got.size();
      }
    }
  }
  EXPECT_GT(pixels, 20000U);
}

// Edge and span values against rationals formed directly from the specification's text.
TEST(GoldenStage, EdgesAndSpansEqualTheSpecification) {
  Draw draw(42);
  int rows = 0;
  int spans = 0;
  for (int i = 0; i < 60; ++i) {
    Config c = exact_config(i % 2 == 0 ? "depth16" : "narrow", Perspective::delta_f, FillRule::top_left);
    c.edge_slope = i % 3 == 0 ? SlopeForm::reciprocal : SlopeForm::divide;
    c.row_slope = i % 3 == 1 ? RowSlope::divide : RowSlope::reciprocal;
    c.pixel_reciprocal.kind = ReciprocalKind::restoring;
    for (Format& f : c.formats) f.rounding = static_cast<Rounding>(draw.integer(0, rounding_modes - 1));
    const auto f = [&](FormatId id) -> const Format& { return c.format(id); };
    const auto val = [&](FormatId id, std::int64_t raw) { return value_of(f(id), raw); };
    Scene scene = test_scene();
    scene.triangles = {random_triangle(draw, scene)};
    const Trace t = trace_of(c, scene);
    if (t.setup.empty()) continue;
    const SetupRecord& s = t.setup[0];
    const Rational b = val(FormatId::setup_b, t.constants.at(0).b);
    const Format xy = c.coordinate_format();
    for (const EdgeRecord& e : t.edge) {
      const bool from1 = e.edge == 2;
      const bool to1 = e.edge == 1;
      const Rational dy = value_of(xy, to1 ? s.y1 : s.y2) - value_of(xy, from1 ? s.y1 : s.y0);
      const Rational h2 = val(FormatId::setup_h, to1 ? s.h1 : s.h2);
      const Rational dh = h2 - val(FormatId::setup_h, from1 ? s.h1 : s.h0);
      const Rational du =
          val(FormatId::setup_uv, to1 ? s.u1 : s.u2) - val(FormatId::setup_uv, from1 ? s.u1 : s.u0);
      ASSERT_EQ(Int(e.fu_diff), oracle_raw(f(FormatId::edge_f_diff), du * (h2 + b)));
      Rational inverse = 1 / dy;
      if (c.edge_slope == SlopeForm::reciprocal) {
        inverse = scale(value_of(c.edge_reciprocal.output, e.recip_m), -static_cast<int>(e.recip_e));
      }
      ASSERT_EQ(Int(e.h_step), oracle_raw(f(FormatId::edge_h_step), dh * inverse));
      ASSERT_EQ(Int(e.fu_step),
                oracle_raw(f(FormatId::edge_f_step), val(FormatId::edge_f_diff, e.fu_diff) * inverse));
    }
    // The first row of edge 0, and each step after it.
    const RowRecord* previous = nullptr;
    for (const RowRecord& r : t.row) {
      const std::int64_t h_step = t.edge[0].h_step;
      const std::int64_t acc = s.mid_right == 1 ? r.l_h_acc : r.r_h_acc;
      if (previous != nullptr && previous->y + 1 == r.y) {
        const std::int64_t before = s.mid_right == 1 ? previous->l_h_acc : previous->r_h_acc;
        ASSERT_EQ(Int(acc), oracle_raw(f(FormatId::edge_h_acc), val(FormatId::edge_h_acc, before) +
                                                                    val(FormatId::edge_h_step, h_step)));
      }
      previous = &r;
      const Rational u1 = val(FormatId::setup_uv, r.l_edge == 2 ? s.u1 : s.u0);
      const Rational inverse =
          scale(value_of(c.pixel_reciprocal.output, r.l_recip_m), -static_cast<int>(r.l_recip_e));
      ASSERT_EQ(Int(r.l_u), oracle_raw(f(FormatId::edge_uv), u1 + val(FormatId::edge_f, r.l_fu) * inverse));
      // X from the vertices, exactly.
      const Rational x1 = value_of(xy, r.l_edge == 2 ? s.x1 : s.x0);
      const Rational y1 = value_of(xy, r.l_edge == 2 ? s.y1 : s.y0);
      const Rational x2 = value_of(xy, r.l_edge == 1 ? s.x1 : s.x2);
      const Rational y2 = value_of(xy, r.l_edge == 1 ? s.y1 : s.y2);
      const Rational x = x1 + (x2 - x1) * (Rational(Int(2 * r.y + 1), Int(2)) - y1) / (y2 - y1);
      ASSERT_EQ(Int(r.l_x), oracle_raw(f(FormatId::edge_x), x));
      const Int first = -test::floor_of(-(x - Rational(1, 2)));
      ASSERT_EQ(Int(r.x_first), first < 0 ? Int(0) : first);
      ++rows;
    }
    ASSERT_EQ(t.span.size(), t.row.size());
    std::size_t next = 0;
    for (std::size_t j = 0; j < t.span.size(); ++j) {
      const SpanRecord& p = t.span[j];
      const RowRecord& r = t.row[j];
      const Rational length = val(FormatId::edge_x, r.r_x) - val(FormatId::edge_x, r.l_x);
      const Rational pre = Rational(Int(2 * r.x_first + 1), Int(2)) - val(FormatId::edge_x, r.l_x);
      const Rational h_l = val(FormatId::edge_h, r.l_h);
      const Rational h_r = val(FormatId::edge_h, r.r_h);
      Rational h_step = 0;
      if (length > 0) {
        const Rational inverse =
            c.row_slope == RowSlope::divide
                ? Rational(1 / length)
                : scale(value_of(c.row_reciprocal.output, p.recip_m), -static_cast<int>(p.recip_e));
        ASSERT_EQ(Int(p.h_step), oracle_raw(f(FormatId::span_h_step), (h_r - h_l) * inverse));
        h_step = val(FormatId::span_h_step, p.h_step);
      } else {
        ASSERT_EQ(p.h_step, 0);
        ASSERT_EQ(p.fu_step0, 0);
        ASSERT_EQ(p.recip_m, 0);
      }
      ASSERT_FALSE(c.start_offset.span_h.half_ulp);
      const Rational offset = rational_of(c.start_offset.span_h.value);
      ASSERT_EQ(Int(p.h), oracle_raw(f(FormatId::span_h), h_l + h_step * pre + offset));
      for (std::int64_t k = 0; k < p.count; ++k) {
        const FragmentRecord& fragment = t.fragment.at(next++);
        ASSERT_EQ(fragment.x, p.x + k);
        ASSERT_EQ(fragment.last, k == p.count - 1 ? 1 : 0);
        const Rational inverse =
            scale(value_of(c.pixel_reciprocal.output, fragment.recip_m), -static_cast<int>(fragment.recip_e));
        const Rational sum = val(FormatId::span_h, fragment.h) + b;
        const Rational scaled = sum / scale(Rational(1), static_cast<int>(fragment.recip_e));
        ASSERT_TRUE(scaled >= 1 && scaled < 2);
        ASSERT_EQ(Int(fragment.recip_m), oracle_raw(c.pixel_reciprocal.output, 1 / scaled));
        ASSERT_EQ(Int(fragment.u),
                  oracle_raw(f(FormatId::span_uv),
                             val(FormatId::edge_uv, p.u1) + val(FormatId::span_f, fragment.fu) * inverse));
        ++spans;
      }
    }
  }
  EXPECT_GT(rows, 300);
  EXPECT_GT(spans, 2000);
}

// const_depth_rows: rows partition the plane, the step pattern is D(m), and the divides saved are counted.
TEST(GoldenStage, RowsOfConstantDepth) {
  Draw draw(43);
  std::array<int, 2> majors{};
  for (int i = 0; i < 150; ++i) {
    Config c = exact_config("depth16", Perspective::const_depth_rows, FillRule::top_left);
    c.numerator = i % 2 == 0 ? Numerator::ideal_line : Numerator::pixel_centre;
    Scene scene = test_scene();
    scene.triangles = {random_triangle(draw, scene)};
    Counters counters;
    const Trace t = trace_of(c, scene, &counters);
    ASSERT_EQ(counters.rows, t.plane_row.size());
    ASSERT_EQ(counters.divides_row, t.plane_row.size());
    ASSERT_EQ(counters.divides_saved,
              static_cast<std::int64_t>(t.depth.size()) - static_cast<std::int64_t>(t.plane_row.size()));
    if (t.plane.empty()) continue;
    const PlaneRecord& plane = t.plane[0];
    ++majors[static_cast<std::size_t>(plane.major)];
    const Rational k = value_of(c.format(FormatId::plane_k), plane.k);
    ASSERT_LE(abs(k), 1);
    std::size_t next = 0;
    for (const PlaneRowRecord& row : t.plane_row) {
      ASSERT_EQ(t.fragment.at(next).covered, 1);
      ASSERT_EQ(t.fragment.at(next + static_cast<std::size_t>(row.count) - 1).covered, 1);
      for (std::int64_t j = 0; j < row.count; ++j) {
        const FragmentRecord& fragment = t.fragment.at(next++);
        const std::int64_t m = plane.major == 0 ? fragment.x : fragment.y;
        const std::int64_t n = plane.major == 0 ? fragment.y : fragment.x;
        ASSERT_EQ(m, row.major_first + j);
        ASSERT_EQ(Int(n),
                  row.row + test::floor_of(k * Rational(Int(m - plane.major_first)) + Rational(1, 2)));
        ASSERT_EQ(fragment.h, row.h);  // constant depth
      }
    }
    ASSERT_EQ(next, t.fragment.size());
  }
  EXPECT_GT(majors[0], 20);
  EXPECT_GT(majors[1], 20);
}

Config unit_config() {
  Config c = shipped_config("depth16");
  const auto set = [&](FormatId id, int word, int integer, bool is_signed) {
    c.format(id) = {word, integer, is_signed, Rounding::rnd, Overflow::sat, false};
  };
  set(FormatId::span_h, 24, 16, false);
  set(FormatId::setup_b, 24, 16, false);
  set(FormatId::span_uv, 20, 12, true);
  set(FormatId::span_shade, 9, 1, false);
  set(FormatId::texture_frac, 4, 0, false);
  set(FormatId::texture_mix, 12, 8, false);
  set(FormatId::texture_color, 12, 8, false);
  set(FormatId::texture_alpha, 9, 1, false);
  set(FormatId::fog_factor, 9, 1, false);
  set(FormatId::fog_color, 12, 8, false);
  c.wrap = TextureWrap::cyclic;
  c.filter = TextureFilter::nearest;
  c.transparent.reset();
  return c;
}

FragmentRecord fragment_at(double u, double v, double shade, double alpha) {
  FragmentRecord out;
  out.u = std::llround(u * 256);
  out.v = std::llround(v * 256);
  out.r = out.g = out.b = std::llround(shade * 256);
  out.a = std::llround(alpha * 256);
  return out;
}

void texture_by_hand(Arithmetic arithmetic) {
  Config c = unit_config();
  const Texture t{.name = "t",
                  .width = 2,
                  .height = 2,
                  .rgba = {0, 16, 32, 255, 64, 80, 96, 255, 10, 20, 30, 255, 200, 210, 220, 51}};
  TextureRecord r = textured(arithmetic, c, fragment_at(3.25, -0.5, 0.5, 1), t);
  EXPECT_EQ(r.i, 1);  // 3 mod 2
  EXPECT_EQ(r.j, 1);  // -1 mod 2
  EXPECT_EQ(r.texel_r, 200 * 16);
  EXPECT_EQ(r.r, 100 * 16);
  EXPECT_EQ(r.a, 51);  // 51/255 = 0.2 = 51.2/256
  EXPECT_EQ(r.killed, 0);
  c.wrap = TextureWrap::mirror;
  for (const auto& [u, i] :
       {std::pair{-2.5, 1}, {-1.5, 1}, {-0.5, 0}, {0.5, 0}, {2.5, 1}, {3.5, 0}, {4.5, 0}}) {
    EXPECT_EQ(textured(arithmetic, c, fragment_at(u, 0.5, 1, 1), t).i, i) << u;
    EXPECT_EQ(textured(arithmetic, c, fragment_at(0.5, u, 1, 1), t).j, i) << u;
  }
  c.wrap = TextureWrap::border;
  c.border = {40, 50, 60, 51};
  r = textured(arithmetic, c, fragment_at(-9.5, 0.5, 1, 1), t);
  EXPECT_EQ(r.i, -1);
  EXPECT_EQ(r.j, 0);
  EXPECT_EQ(r.texel_r, 40 * 16);
  EXPECT_EQ(r.texel_a, 51);
  c.filter = TextureFilter::bilinear;
  r = textured(arithmetic, c, fragment_at(1.75, 0.5, 1, 1), t);
  EXPECT_EQ(r.i, 1);
  EXPECT_EQ(r.texel_r, 58 * 16);  // 64 * 3/4 + 40 / 4
  r = textured(arithmetic, c, fragment_at(0.5, 9.0, 1, 1), t);
  EXPECT_EQ(r.j, 2);
  EXPECT_EQ(r.texel_r, 40 * 16);
  c.filter = TextureFilter::nearest;
  c.wrap = TextureWrap::clamp;
  r = textured(arithmetic, c, fragment_at(3.25, -0.5, 1, 0), t);
  EXPECT_EQ(r.i, 1);
  EXPECT_EQ(r.j, 0);
  EXPECT_EQ(r.killed, 1);  // alpha 0
  c.filter = TextureFilter::bilinear;
  r = textured(arithmetic, c, fragment_at(0.75, 1.0, 1, 1), t);
  EXPECT_EQ(r.i, 0);
  EXPECT_EQ(r.j, 0);
  EXPECT_EQ(r.ex, 4);         // 1/4
  EXPECT_EQ(r.ey, 8);         // 1/2
  EXPECT_EQ(r.texel_r, 588);  // V5 = 0 + 64/4 = 16, V6 = 10 + 190/4 = 57.5, V = 36.75 = 588/16
}

TEST(GoldenStage, TextureByHand) { texture_by_hand(checked_double); }
TEST(GoldenStage, TextureByHandInColumns) { texture_by_hand(unchecked_double); }

void depth_codes_by_hand(Arithmetic arithmetic) {
  Config c = unit_config();
  Constants k;
  k.record.b = 100 * 256;
  FragmentRecord f;
  f.covered = 1;
  f.h = 1000 * 256 + 128;
  GradientRecord gradient;
  const auto run = [&](DepthCode code, std::int64_t stored) {
    c.depth_code = code;
    c.depth_rounding = Rounding::rnd;
    const auto code_stored = static_cast<std::uint32_t>(stored);
    std::vector<DepthRecord> out;
    make_depth(arithmetic, c, k)({&f, 1}, gradient, first_state(c), {&code_stored, 1}, {1}, out);
    return out.at(0);
  };
  EXPECT_EQ(run(DepthCode::inverse, 1000).z, 1001);
  EXPECT_EQ(run(DepthCode::inverse, 1000).pass, 1);
  EXPECT_EQ(run(DepthCode::inverse, 1001).pass, 0);          // equal does not pass
  EXPECT_EQ(run(DepthCode::opengl, 65535).z, 65535 - 1000);  // 64534.5 rounds up
  EXPECT_EQ(run(DepthCode::opengl, 64536).pass, 1);
  EXPECT_EQ(run(DepthCode::opengl, 64535).pass, 0);
  // hmax + B = 65635: K = 17; q = 1100.5 lies in octave 6: 4096 (8 - 1100.5 / 1024) = 28366
  EXPECT_EQ(run(DepthCode::w_float, 28367).z, 28366);
  EXPECT_EQ(run(DepthCode::w_float, 28367).pass, 1);
  EXPECT_EQ(run(DepthCode::w_float, 28366).pass, 0);
  EXPECT_EQ(clear_depth(c), 65535);
  // z = 64535, 6 ones and 23 above them: 512 * 6 + 23; dz 4, of |-1.25| + |2| in the gradients' format.
  gradient.h_x = std::llround(std::ldexp(-1.25, c.format(FormatId::plane_h_grad).fraction()));
  gradient.h_y = std::llround(std::ldexp(2, c.format(FormatId::plane_h_grad).fraction()));
  EXPECT_EQ(run(DepthCode::float_dz, 49600).z, 16 * 3095 + 2);
  EXPECT_EQ(run(DepthCode::float_dz, 16 * 3096).pass, 1);
  EXPECT_EQ(run(DepthCode::float_dz, 16 * 3095).pass, 0);
  EXPECT_EQ(clear_depth(c), 65520);
  c.depth_code = DepthCode::inverse;
  EXPECT_EQ(clear_depth(c), 0);
}

TEST(GoldenStage, DepthCodesByHand) { depth_codes_by_hand({Width::x87, true}); }
TEST(GoldenStage, DepthCodesByHandInColumns) { depth_codes_by_hand(unchecked_double); }

void fog_table_is_monotone(int depth_bits, int zone_bits) {
  Config c = shipped_config("depth16");
  c.fog_depth_bits = depth_bits;
  c.fog_zone_bits = zone_bits;
  const int depth_steps = 1 << depth_bits;
  const int zones = 1 << zone_bits;
  const Scene scene = test_scene();
  const Constants k = make_constants(c, scene);
  const auto table = fog_table(c, k, scene);
  ASSERT_EQ(table.size(), static_cast<std::size_t>(depth_steps * zones));
  std::set<std::int64_t> values;
  for (int hi = 0; hi < depth_steps; ++hi) {
    for (int zone = 0; zone < zones; ++zone) {
      const auto at = static_cast<std::size_t>(zones * hi + zone);
      values.insert(table[at]);
      if (zone > 0) {
        EXPECT_LE(table[at], table[at - 1]);  // farther from the axis: more fog
      }
      if (hi > 0) {
        EXPECT_GE(table[at], table[at - static_cast<std::size_t>(zones)]);  // nearer: less fog
      }
      const double b =
          static_cast<double>(k.record.b) * std::ldexp(1.0, -c.format(FormatId::setup_b).fraction());
      const double s = b * scene.s_max / ((hi + 0.5) * 65536 / depth_steps + b);
      const double r2 = (zone + 0.5) / zones * (48.0 * 48 + 40 * 40);
      const double factor = std::exp(-s * std::sqrt(1 + r2 / (70.0 * 70)) / 60);
      EXPECT_NEAR(static_cast<double>(table[at]),
                  factor * std::ldexp(1.0, c.format(FormatId::fog_factor).fraction()), 0.5 + 1e-9);
    }
  }
  EXPECT_GT(values.size(), 50U);
}

TEST(GoldenStage, FogTableIsMonotone) {
  fog_table_is_monotone(6, 4);
  fog_table_is_monotone(7, 3);
  fog_table_is_monotone(8, 2);
  fog_table_is_monotone(5, 5);
}

void fog_and_merge_by_hand(Arithmetic fog_arithmetic, Arithmetic merge_arithmetic) {
  Config c = unit_config();
  c.fog = FogMode::linear;
  c.format(FormatId::fog_scale) = {24, 16, false, Rounding::rnd, Overflow::sat, false};
  c.pixel_reciprocal.kind = ReciprocalKind::restoring;
  Scene scene = test_scene();
  scene.fog = Fog{{100, 0, 255}, 60};
  Constants k;
  k.record.b = 24 * 256;
  k.record.fog_scale = 256 * 256;
  FragmentRecord fragment;
  fragment.h = 1000 * 256;  // h + B = 1024; factor 1 - 256/1024
  TextureRecord texture;
  texture.r = texture.g = texture.b = 20 * 16;
  texture.a = 128;  // one half
  const FogRecord fog = fogged(fog_arithmetic, c, k, scene, fragment, texture);
  EXPECT_EQ(fog.factor, 192);
  EXPECT_EQ(fog.index, -1);
  EXPECT_EQ(fog.r, 40 * 16);  // 100 - 80 * 3/4
  EXPECT_EQ(fog.g, 15 * 16);  // 20 * 3/4
  EXPECT_EQ(fog.b, 1260);     // 255 - 235 * 3/4 = 78.75
  EXPECT_EQ(fog.recip_e, 10);
  DepthRecord depth;
  depth.z = 77;
  MergeRecord merged = merged_onto({10, 20, 30}, merge_arithmetic, c, fog, texture, depth);
  EXPECT_EQ(merged.r, 25);  // 10 + 30/2
  EXPECT_EQ(merged.g, 18);  // 20 - 5/2 = 17.5
  EXPECT_EQ(merged.b, 54);  // 30 + 48.75/2 = 54.375
  EXPECT_EQ(merged.z, 77);
  texture.a = 256;
  merged = merged_onto({10, 20, 30}, merge_arithmetic, c, fog, texture, depth);
  EXPECT_EQ(merged.r, 40);
  EXPECT_EQ(merged.b, 79);
  scene.fog.reset();
  const FogRecord none = fogged(fog_arithmetic, c, k, scene, fragment, texture);
  EXPECT_EQ(none.factor, 256);
  EXPECT_EQ(none.r, 20 * 16);
  EXPECT_EQ(none.recip_m, 0);
}

TEST(GoldenStage, FogAndMergeByHand) { fog_and_merge_by_hand({Width::x87, true}, checked_double); }
TEST(GoldenStage, FogAndMergeByHandInColumns) { fog_and_merge_by_hand(unchecked_double, unchecked_double); }

// A batch drawn in pieces gives the same records, frame and counters.
TEST(GoldenStage, PiecesEqualTheWhole) {
  Draw draw(44);
  const Config c = shipped_config("depth16");
  Scene scene = test_scene();
  for (int i = 0; i < 12; ++i) scene.triangles.push_back(random_triangle(draw, scene));
  Counters whole_counters;
  const Trace whole = trace_of(c, scene, &whole_counters);
  const auto engine = make_golden(c, true);
  engine->begin(scene);
  Trace pieces;
  const std::span<const Triangle> all = scene.triangles;
  for (std::size_t i = 0; i < all.size(); i += 5) {
    engine->draw(all.subspan(i, std::min<std::size_t>(5, all.size() - i)), static_cast<std::int64_t>(i),
                 &pieces);
  }
  EXPECT_EQ(pieces.constants.size(), 1U);
  EXPECT_TRUE(whole.fragment == pieces.fragment);
  EXPECT_TRUE(whole.merge == pieces.merge);
  EXPECT_TRUE(whole_counters == engine->counters());
  EXPECT_EQ(whole_counters.covered, whole.depth.size());
  EXPECT_EQ(whole_counters.depth_passed, whole.texture.size());
  EXPECT_EQ(whole_counters.killed + whole_counters.written, whole.texture.size());
  EXPECT_EQ(whole_counters.divides_pixel, whole.fragment.size());
  EXPECT_GT(whole.merge.size(), 100U);
  // The frame holds what the last merge at each pixel wrote.
  std::map<std::array<std::int64_t, 2>, MergeRecord> last;
  for (const MergeRecord& m : whole.merge) last[{m.x, m.y}] = m;
  for (const auto& [at, m] : last) {
    const auto i = static_cast<std::size_t>(at[1] * scene.width + at[0]);
    ASSERT_EQ(engine->frame().depth[i], m.z);
    ASSERT_EQ(engine->frame().color[4 * i], m.r);
    ASSERT_EQ(engine->frame().triangle[i], m.triangle);
  }
}

TEST(GoldenStage, RefusesScenesOutOfRange) {
  const auto engine = make_golden(shipped_config("depth16"));
  Scene scene = test_scene();
  scene.s_min = scene.s_max;
  EXPECT_THROW(engine->begin(scene), InputError);
  scene = test_scene();
  scene.s_min = 1e-30;
  EXPECT_THROW(engine->begin(scene), InputError);
}

}  // namespace
}  // namespace bitspan::test
