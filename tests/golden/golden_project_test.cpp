// SPDX-License-Identifier: Apache-2.0
// The homogeneous channels of a projector, the stage project and a projected texture in golden: on values
// worked by hand, and against exact rationals. docs/numeric-spec.md, "project" and "A projected texture".
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "engine/counters.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "golden/precision.hpp"
#include "report/error.hpp"
#include "tests/golden/golden_support.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::test {
namespace {

using F = FormatId;
using Texel = std::pair<std::int64_t, std::int64_t>;  // column and row

Config projecting(Perspective perspective = Perspective::delta_f, RowSlope slope = RowSlope::divide) {
  Config c = plain_config();
  c.perspective = perspective;
  c.row_slope = slope;
  c.project = ProjectUnit::reciprocal;
  return c;
}
// Each mode, with each way to start a row that it has.
std::vector<Config> every_mode() {
  std::vector<Config> out;
  for (const Perspective p : all_perspectives) {
    out.push_back(projecting(p, RowSlope::divide));
    if (!has_plane_rows(p)) out.push_back(projecting(p, RowSlope::plane));
  }
  return out;
}

StateSetting setting(std::string_view key, std::int64_t value) { return {*find_state_register(key), value}; }
DrawCommand change_in_front_of(std::size_t triangle, std::vector<StateSetting> settings) {
  return {triangle, StateChange{false, std::move(settings)}};
}

constexpr int texture_width = 6, texture_height = 4;

// A shadow map of one code.
Texture shadow_map(std::uint32_t word) {
  Texture out;
  out.name = "map";
  out.width = texture_width;
  out.height = texture_height;
  out.format = TexelFormat::depth;
  for (int i = 0; i < texture_width * texture_height; ++i) {
    for (int at = 0; at < 32; at += 8) out.raw.push_back(static_cast<std::uint8_t>(word >> at));
  }
  return out;
}
// Texel (i, j) has the colour 10 i, 10 j, 7.
Texture picture() {
  Texture out;
  out.name = "picture";
  out.width = texture_width;
  out.height = texture_height;
  for (int j = 0; j < texture_height; ++j) {
    for (int i = 0; i < texture_width; ++i) {
      for (const int code : {10 * i, 10 * j, 7, 255}) out.rgba.push_back(static_cast<std::uint8_t>(code));
    }
  }
  return out;
}

// s goes from 1 to 65536 = 2^16 for both eyes, so that B, B_p and A_p are 1. At a pixel's centre (x, y):
// h + B = 61.5 - 2 x - 3 y, and W (h + B) = 1/2, X (h + B) = (1.5 + x) / 4, Y (h + B) = (4.5 + y) / 4, all in
// units of 2^16.
Scene worked() {
  Scene scene;
  scene.width = 64;
  scene.height = 48;
  scene.s_min = 1;
  scene.s_max = 65536;
  scene.projector = Projector{1, 65536};
  Triangle t;
  t.v[0] = {{0, 0, 1024}, {.c = {1, 1, 1, 1}, .project_x = 256, .project_y = 1024, .project_w = 512}};
  t.v[1] = {{16, 0, 2048}, {.c = {1, 1, 1, 1}, .project_x = 8704, .project_y = 2048, .project_w = 1024}};
  t.v[2] = {{0, 16, 4096}, {.c = {1, 1, 1, 1}, .project_x = 1024, .project_y = 20480, .project_w = 2048}};
  scene.triangles = {t};
  scene.textures = {picture(), shadow_map(0)};
  scene.commands = {change_in_front_of(0, {setting("texture1", 0), setting("texture1.coordinates", 1),
                                           setting("texture1.op", static_cast<int>(TextureOp::replace))})};
  return scene;
}
Scene with_settings(Scene scene, const std::vector<StateSetting>& settings) {
  scene.commands.push_back(change_in_front_of(0, settings));
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
  draw_scene(*engine, scene, 0, scene.triangles.size(), &out.trace);
  out.counters = engine->counters();
  out.frame = engine->frame();
  return out;
}
double value(std::int64_t raw, const Config& c, F id) { return decoded(raw, c.format(id)); }

template <class Record>
const Record& at(const std::vector<Record>& records, std::int64_t x, std::int64_t y) {
  const auto found = std::ranges::find_if(records, [&](const Record& r) { return r.x == x && r.y == y; });
  EXPECT_NE(found, records.end()) << x << ", " << y;
  return *found;
}

TEST(GoldenProject, SetupAndRowsByHand) {
  const Config c = projecting();
  const Drawn run = drawn(c, worked());
  ASSERT_EQ(run.trace.setup_channel.size(), 3U);
  const std::array<std::array<double, 3>, 3> w{
      {{1 / 256.0, 17 / 128.0, 1 / 64.0}, {1 / 64.0, 1 / 32.0, 5 / 16.0}, {1 / 128.0, 1 / 64.0, 1 / 32.0}}};
  const std::array<std::array<double, 3>, 3> f{{{0.25, 4.25, 0.25}, {1, 1, 5}, {0.5, 0.5, 0.5}}};
  // Edge 1 has no height.
  const std::array<std::array<double, 3>, 3> step{{{0, 0, -0.25}, {0.25, 0, 0.25}, {0, 0, 0}}};
  for (std::size_t k = 0; k < 3; ++k) {
    const SetupChannelRecord& s = run.trace.setup_channel[k];
    EXPECT_EQ(s.channel, static_cast<std::int64_t>(k) + 1);
    EXPECT_EQ((std::array{value(s.w0, c, F::project_vertex), value(s.w1, c, F::project_vertex),
                          value(s.w2, c, F::project_vertex)}),
              w[k]);
    EXPECT_EQ((std::array{value(s.f0, c, F::project_acc), value(s.f1, c, F::project_acc),
                          value(s.f2, c, F::project_acc)}),
              f[k]);
    EXPECT_EQ((std::array{value(s.step0, c, F::project_step), value(s.step1, c, F::project_step),
                          value(s.step2, c, F::project_step)}),
              step[k]);
    EXPECT_EQ(s.w_x | s.w_y, 0);
  }
  ASSERT_EQ(run.trace.row_channel.size(), 3 * run.trace.row.size());
  ASSERT_EQ(run.trace.span_channel.size(), 3 * run.trace.span.size());
  // Row 2: X from 1/4 at x = 0 to 1/4 + 13.5/4, Y 1.625 throughout.
  const RowChannelRecord& x = run.trace.row_channel.at(6);
  EXPECT_EQ(x.channel, 1);
  EXPECT_EQ(value(x.l_acc, c, F::project_acc), 0.25);
  EXPECT_EQ(value(x.r_acc, c, F::project_acc), 0.25 + 13.5 / 4);
  EXPECT_EQ(std::pair(x.l, x.r), std::pair(x.l_acc, x.r_acc));
  EXPECT_EQ(value(run.trace.row_channel.at(7).l, c, F::project_acc), 1.625);
  EXPECT_EQ(value(run.trace.span_channel.at(6).w_step0, c, F::project_step), 0.25);
  EXPECT_EQ(value(run.trace.span_channel.at(6).w, c, F::project_acc), 0.375);
}

TEST(GoldenProject, PlanesByHand) {
  for (const auto& [perspective, slope] : {std::pair(Perspective::hyperbolic, RowSlope::plane),
                                           std::pair(Perspective::const_depth_rows, RowSlope::divide)}) {
    const Config c = projecting(perspective, slope);
    const Drawn run = drawn(c, worked());
    ASSERT_EQ(run.trace.setup_channel.size(), 3U);
    const SetupChannelRecord& x = run.trace.setup_channel[0];
    EXPECT_EQ(std::pair(value(x.w_x, c, F::project_grad), value(x.w_y, c, F::project_grad)),
              std::pair(0.25, 0.0));
    const SetupChannelRecord& y = run.trace.setup_channel[1];
    EXPECT_EQ(std::pair(value(y.w_x, c, F::project_grad), value(y.w_y, c, F::project_grad)),
              std::pair(0.0, 0.25));
    EXPECT_EQ(x.step0 | x.step1 | x.step2, 0);
    EXPECT_EQ(value(x.f1, c, F::project_acc), 4.25);
    EXPECT_TRUE(run.trace.row_channel.empty());
  }
}

// One reciprocal: R_pixel(1/2) = 1 2^1. So s = 2 X (h + B), t likewise, ratio = 2 (h + B), and with A_p = B_p
// = 1 the code is ratio - 1.
TEST(GoldenProject, DividesByWInEveryMode) {
  for (Config c : every_mode()) {
    for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
      c.depth_code = code;
      SCOPED_TRACE(std::string(to_string(c.perspective)) + " " + std::string(to_string(c.row_slope)) + " " +
                   std::string(to_string(code)));
      const Drawn run = drawn(c, worked());
      ASSERT_EQ(run.trace.project.size(), 120U);  // 15 + 14 + ... + 1
      ASSERT_EQ(run.trace.texture_second.size(), 120U);
      ASSERT_EQ(run.trace.fragment_channel.size(), 3 * run.trace.fragment.size());
      for (std::size_t i = 0; i < run.trace.project.size(); ++i) {
        const ProjectRecord& p = run.trace.project[i];
        const TextureSecondRecord& second = run.trace.texture_second[i];
        ASSERT_EQ(std::pair(p.x, p.y), std::pair(second.x, second.y));
        const auto x = static_cast<double>(p.x), y = static_cast<double>(p.y);
        EXPECT_EQ(p.triangle, 0);
        EXPECT_EQ(decoded(p.recip_m, c.pixel_reciprocal.output), 1);
        EXPECT_EQ(p.recip_e, -1);
        EXPECT_EQ(value(p.s, c, F::span_uv), 0.75 + x / 2);
        EXPECT_EQ(value(p.t, c, F::span_uv), 2.25 + y / 2);
        // The h of a row of constant depth is not the one of the pixel's centre.
        const double sum = value(at(run.trace.fragment, p.x, p.y).h, c, F::span_h) + 1;
        if (!has_plane_rows(c.perspective)) {
          EXPECT_EQ(sum, 61.5 - 2 * x - 3 * y);
        }
        EXPECT_EQ(value(p.ratio, c, F::project_ratio), 2 * sum);
        EXPECT_EQ(value(p.h, c, F::project_h), 2 * sum - 1);
        const double z = std::floor(2 * sum - 1 + 0.5);
        if (!has_plane_rows(c.perspective)) {
          EXPECT_EQ(p.z, static_cast<std::int64_t>(code == DepthCode::inverse ? z : 65535 - z));
        }
        const bool inside = x <= 10 && y <= 3;  // s below 6, t below 4
        EXPECT_EQ(p.inside, inside ? 1 : 0);
        EXPECT_EQ(second.i, inside ? static_cast<std::int64_t>(0.75 + x / 2) : 0);
        EXPECT_EQ(second.j, inside ? static_cast<std::int64_t>(2.25 + y / 2) : 0);
        EXPECT_EQ(value(second.r, c, F::texture_color), inside ? 10.0 * static_cast<double>(second.i) : 255);
        EXPECT_EQ(value(second.a, c, F::texture_alpha), 1);
      }
    }
  }
}

// E_p and E are of two ranges: with s_max = 3 for the projector, X, Y and W are divided by 4.
TEST(GoldenProject, TakesTheRangeOfItsProjector) {
  const Config c = projecting();
  Scene scene = worked();
  scene.projector = Projector{1, 3};
  const auto w = [](const Drawn& run, std::size_t k) { return run.trace.setup_channel.at(k).w1; };
  Drawn run = drawn(c, scene);
  EXPECT_EQ(value(w(run, 2), c, F::project_vertex), 256);
  scene.projector = Projector{1, 4};
  EXPECT_EQ(w(drawn(c, scene), 2), w(run, 2));
  scene.projector = Projector{1, 4.5};
  EXPECT_EQ(value(w(drawn(c, scene), 2), c, F::project_vertex), 128);
  // s_min' = 1/4 and s_max' = 1: B_p = A_p = 65535 / 3. W = 2 is ratio 2.
  scene = worked();
  scene.projector = Projector{1, 4};
  for (Vertex& v : scene.triangles[0].v) v.project_w = v.s / 2048;
  run = drawn(c, scene);
  const ProjectRecord& p = at(run.trace.project, 4, 2);
  // W (h + B) = 1/2048 s/4 65536/s = 8, and h + B = 47.5.
  EXPECT_EQ(p.recip_e, 3);
  EXPECT_EQ(value(p.ratio, c, F::project_ratio), 47.5 / 8);
  EXPECT_EQ(value(p.h, c, F::project_h), 21845 * (47.5 / 8 - 1));
  EXPECT_EQ(value(p.s, c, F::span_uv), 16384 * (1.5 + 4) / 4 / 8);  // X is divided by 4, not 2^16
}

TEST(GoldenProject, FollowsTheLookupOfItsTexture) {
  Config c = projecting();
  // Pixel (0, 0): s = 0.75, t = 2.25.
  const Drawn near = drawn(c, worked());
  const TextureSecondRecord& texel = at(near.trace.texture_second, 0, 0);
  EXPECT_EQ(std::pair(texel.i, texel.j), Texel(0, 2));
  EXPECT_EQ(value(texel.g, c, F::texture_color), 20);
  // Bilinear: i' = 0, j' = 1, Ex = 1/4, Ey = 3/4.
  const Drawn smooth = drawn(
      c, with_settings(worked(), {setting("texture1.filter", static_cast<int>(TextureFilter::bilinear))}));
  const TextureSecondRecord& mixed = at(smooth.trace.texture_second, 0, 0);
  EXPECT_EQ(std::pair(mixed.i, mixed.j), Texel(0, 1));
  EXPECT_EQ(std::pair(value(mixed.ex, c, F::texture_frac), value(mixed.ey, c, F::texture_frac)),
            std::pair(0.25, 0.75));
  EXPECT_EQ(value(mixed.texel_r, c, F::texture_mix), 2.5);
  EXPECT_EQ(value(mixed.texel_g, c, F::texture_mix), 17.5);
}

TEST(GoldenProject, IsLitOrDarkOutside) {
  const Config c = projecting();
  const std::vector<StateSetting> constant{setting("texture1.red", 11), setting("texture1.green", 22),
                                           setting("texture1.blue", 33)};
  const auto outside = [&](const Scene& scene) {
    return at(drawn(c, scene).trace.texture_second, 12, 0);  // s = 6.75
  };
  Scene scene = with_settings(worked(), constant);
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    scene = with_settings(scene, {setting("texture1.filter", static_cast<int>(filter)),
                                  setting("texture1.outside", static_cast<int>(ProjectOutside::lit))});
    TextureSecondRecord r = outside(scene);
    EXPECT_EQ(r.i | r.j | r.ex | r.ey | r.level | r.f, 0);
    EXPECT_EQ(value(r.texel_r, c, F::texture_mix), 255);
    EXPECT_EQ(value(r.texel_b, c, F::texture_mix), 255);
    EXPECT_EQ(value(r.texel_a, c, F::texture_alpha), 1);
    r = outside(with_settings(scene, {setting("texture1.outside", static_cast<int>(ProjectOutside::dark))}));
    EXPECT_EQ(r.i | r.j | r.ex | r.ey, 0);
    EXPECT_EQ(value(r.texel_r, c, F::texture_mix), 11);
    EXPECT_EQ(value(r.texel_g, c, F::texture_mix), 22);
    EXPECT_EQ(value(r.texel_b, c, F::texture_mix), 33);
    EXPECT_EQ(value(r.texel_a, c, F::texture_alpha), 1);
  }
}

// The ends of the texture, by floor: s = 0 is inside and what is below it is not; W_t is not, and what is
// below it is.
TEST(GoldenProject, InsideIsWhatFloorSays) {
  const Config c = projecting();
  const auto inside = [&](double s, double t) {
    Scene scene = worked();
    for (Vertex& v : scene.triangles[0].v) {
      v.project_x = s * v.project_w;
      v.project_y = t * v.project_w;
    }
    const ProjectRecord p = at(drawn(c, scene).trace.project, 3, 3);
    EXPECT_EQ(value(p.s, c, F::span_uv), s);
    EXPECT_EQ(value(p.t, c, F::span_uv), t);
    return p.inside == 1;
  };
  EXPECT_TRUE(inside(0, 0));
  EXPECT_FALSE(inside(-1 / 64.0, 0));
  EXPECT_FALSE(inside(0, -1 / 64.0));
  EXPECT_TRUE(inside(5 + 63 / 64.0, 3 + 63 / 64.0));
  EXPECT_FALSE(inside(6, 3));
  EXPECT_FALSE(inside(5, 4));
}

// Which of less, equal, lequal, greater, notequal, gequal pass in front of, at and behind the stored code.
TEST(GoldenProject, ComparesWithTheStoredCode) {
  Config c = projecting();
  const auto lit = [&](DepthFunc func, std::uint32_t stored, std::int64_t bias = 0) {
    Scene scene = worked();
    // The low 16 bits of a word are below a code of 16 bits.
    scene.textures[1] = shadow_map((stored << 16) + 0xffff);
    scene = with_settings(
        scene, {setting("texture1", 1), setting("texture1.compare", 1),
                setting("texture1.func", static_cast<int>(func)), setting("texture1.bias", bias),
                setting("texture1.red", 40), setting("texture1.green", 50), setting("texture1.blue", 60)});
    const TextureSecondRecord r = at(drawn(c, scene).trace.texture_second, 0, 0);
    EXPECT_EQ(std::pair(r.i, r.j), Texel(0, 2));
    EXPECT_EQ(value(r.texel_a, c, F::texture_alpha), 1);
    const bool white = value(r.texel_r, c, F::texture_mix) == 255;
    EXPECT_EQ(value(r.texel_r, c, F::texture_mix), white ? 255 : 40);
    EXPECT_EQ(value(r.texel_g, c, F::texture_mix), white ? 255 : 50);
    EXPECT_EQ(value(r.texel_b, c, F::texture_mix), white ? 255 : 60);
    return white;
  };
  struct Row {
    DepthFunc func;
    bool nearer, as_far, farther;
  };
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    c.depth_code = code;
    const std::uint32_t own = code == DepthCode::inverse ? 122 : 65535 - 122;
    const std::int64_t nearer = code == DepthCode::inverse ? 1 : -1;  // in codes
    for (const Row& row :
         {Row{DepthFunc::never, false, false, false}, Row{DepthFunc::less, true, false, false},
          Row{DepthFunc::equal, false, true, false}, Row{DepthFunc::lequal, true, true, false},
          Row{DepthFunc::greater, false, false, true}, Row{DepthFunc::notequal, true, false, true},
          Row{DepthFunc::gequal, false, true, true}, Row{DepthFunc::always, true, true, true}}) {
      SCOPED_TRACE(std::string(to_string(code)) + " " + std::string(to_string(row.func)));
      // The fragment in front of the map.
      EXPECT_EQ(lit(row.func, static_cast<std::uint32_t>(own - nearer)), row.nearer);
      EXPECT_EQ(lit(row.func, own), row.as_far);
      EXPECT_EQ(lit(row.func, static_cast<std::uint32_t>(own + nearer)), row.farther);
      EXPECT_EQ(lit(row.func, own, nearer), row.nearer);
      EXPECT_EQ(lit(row.func, own, -nearer), row.farther);
    }
    // The bias stops at the ends.
    EXPECT_TRUE(lit(DepthFunc::equal, 65535, 1 << 30));
    EXPECT_TRUE(lit(DepthFunc::equal, 0, -(1 << 30)));
  }
}

// Four comparisons are weighed; the ring of the border, and another format, are not compared.
TEST(GoldenProject, WeighsComparisons) {
  const Config c = [] {
    Config out = projecting();
    out.border = {9, 8, 7, 255};
    return out;
  }();
  Scene scene =
      with_settings(worked(), {setting("texture1", 1), setting("texture1.compare", 1),
                               setting("texture1.filter", static_cast<int>(TextureFilter::bilinear)),
                               setting("texture1.wrap.u", static_cast<int>(TextureWrap::border))});
  // The fragment's code is 122. Of the texels (0, 1), (1, 1), (0, 2), (1, 2) only the first is farther away.
  scene.textures[1] = shadow_map(123U << 16);
  scene.textures[1].raw[4 * texture_width + 2] = 121;
  const TextureSecondRecord r = at(drawn(c, scene).trace.texture_second, 0, 0);
  EXPECT_EQ(value(r.texel_r, c, F::texture_mix), 47.8125);  // 255 (1 - 1/4) (1 - 3/4), of 4 fraction bits
  // Pixel (10, 0): s = 5.75, and the texel right of (5, j) is the border's, lit or not.
  const TextureSecondRecord edge = at(drawn(c, scene).trace.texture_second, 10, 0);
  EXPECT_EQ(std::pair(edge.i, edge.j), Texel(5, 1));
  EXPECT_EQ(value(edge.texel_r, c, F::texture_mix), 2.25);  // 9/4
  EXPECT_EQ(value(edge.texel_g, c, F::texture_mix), 2);
  // With compare off a texel is its code's top byte; a picture is a picture.
  scene = with_settings(worked(), {setting("texture1", 1)});
  scene.textures[1] = shadow_map(0x12345678);
  EXPECT_EQ(value(at(drawn(c, scene).trace.texture_second, 0, 0).texel_r, c, F::texture_mix), 0x12);
  const Drawn plain = drawn(c, worked());
  const Drawn compared = drawn(c, with_settings(worked(), {setting("texture1.compare", 1)}));
  EXPECT_EQ(compared.trace.texture_second, plain.trace.texture_second);
}

TEST(GoldenProject, TakesLevelZero) {
  Config c = projecting();
  c.mip = MipMode::linear;
  c.lod = LodMode::none;
  c.lod_bias = 24;  // 1.5 levels
  Scene scene = worked();
  Texture square = picture();
  square.width = 8;
  square.height = 4;
  square.rgba.assign(4 * 32, 200);
  std::fill(square.rgba.begin() + 4 * 16, square.rgba.begin() + 4 * 17, 100);  // texel (0, 2)
  scene.textures = {square};
  const TextureSecondRecord r = at(drawn(c, scene).trace.texture_second, 0, 0);
  EXPECT_EQ(r.level | r.f, 0);
  EXPECT_EQ(std::pair(r.i, r.j), Texel(0, 2));
  EXPECT_EQ(value(r.texel_r, c, F::texture_mix), 100);
  scene = with_settings(scene, {setting("texture1.coordinates", 0)});
  const TextureSecondRecord own = at(drawn(c, scene).trace.texture_second, 0, 0);
  EXPECT_EQ(own.level, 1);
}

void expect_nothing(const ProjectRecord& p) {
  EXPECT_EQ(p.recip_m | p.recip_e | p.s | p.t | p.ratio | p.h | p.z | p.inside, 0);
}

TEST(GoldenProject, IsNothingBehindTheProjector) {
  Config c = projecting();
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    c.depth_code = code;
    Scene scene = with_settings(worked(), {setting("texture1.outside", 1), setting("texture1.red", 5)});
    for (const double w : {0.0, -1.0}) {
      for (Vertex& v : scene.triangles[0].v) v.project_w = w;
      const Drawn run = drawn(c, scene);
      ASSERT_EQ(run.trace.project.size(), 120U);
      for (const ProjectRecord& p : run.trace.project) expect_nothing(p);
      EXPECT_EQ(value(run.trace.texture_second.at(0).r, c, F::texture_color), 5);
    }
    // Without a projector there is no channel either.
    scene.projector.reset();
    const Drawn run = drawn(c, scene);
    ASSERT_EQ(run.trace.project.size(), 120U);
    for (const ProjectRecord& p : run.trace.project) expect_nothing(p);
    EXPECT_TRUE(run.trace.setup_channel.empty() && run.trace.fragment_channel.empty());
    EXPECT_EQ(value(run.trace.texture_second.at(0).r, c, F::texture_color), 5);
  }
  // One ulp of W in front of it: W (h + B) = 2^-20.
  Scene scene = worked();
  c = projecting();
  c.format(F::project_vertex) = {48, 8, true, Rounding::rnd, Overflow::sat, false};
  for (Vertex& v : scene.triangles[0].v) v.project_w = v.s * 0x1p-20;
  const ProjectRecord p = at(drawn(c, scene).trace.project, 0, 0);
  EXPECT_EQ(p.recip_e, -20);
  EXPECT_EQ(value(p.s, c, F::span_uv), 0.375 * 0x1p20);
}

// Nothing of a fragment that the first unit killed, and in late order of those that depth kills later.
TEST(GoldenProject, StandsInFrontOfTheSecondUnit) {
  const Config c = projecting();
  Scene scene = worked();
  scene.triangles.push_back(scene.triangles[0]);  // as far, so that it fails
  const auto records = [&](int late) {
    const Drawn run = drawn(c, with_settings(scene, {setting("depth.when", late)}));
    EXPECT_EQ(run.trace.project.size(), run.trace.texture_second.size());
    EXPECT_EQ(run.counters.written, 120U);
    return run.trace.project.size();
  };
  EXPECT_EQ(records(static_cast<int>(DepthWhen::early)), 120U);
  EXPECT_EQ(records(static_cast<int>(DepthWhen::late)), 240U);
  // Masked: the left half alone goes on, with the channels of its own pixels.
  const Drawn part = drawn(c, with_settings(scene, {setting("scissor.left", 5)}));
  EXPECT_EQ(part.trace.project.size(), 55U);  // 10 + 9 + ... + 1
  EXPECT_EQ(value(at(part.trace.project, 5, 0).s, c, F::span_uv), 3.25);
  // Off, or by u and v: no record.
  EXPECT_TRUE(drawn(c, with_settings(scene, {setting("texture1", -1)})).trace.project.empty());
  EXPECT_TRUE(drawn(c, with_settings(scene, {setting("texture1.coordinates", 0)})).trace.project.empty());
}

// A projector comes and goes with the view.
TEST(GoldenProject, FollowsTheView) {
  const Config c = projecting();
  Scene scene = worked();
  const Triangle t = scene.triangles[0];
  scene.projector.reset();
  scene.triangles = {t, t, t};
  scene = with_settings(scene, {setting("depth.func", static_cast<int>(DepthFunc::always))});
  ViewChange with, without;
  with.projector.emplace(Projector{1, 65536});
  without.projector.emplace();
  scene.commands.push_back({1, with});
  scene.commands.push_back({2, without});
  const Drawn run = drawn(c, scene);
  EXPECT_EQ(run.trace.constants.size(), 3U);
  EXPECT_EQ(run.trace.setup_channel.size(), 3U);
  ASSERT_EQ(run.trace.project.size(), 360U);
  for (std::size_t i = 0; i < 360; ++i) {
    EXPECT_EQ(run.trace.project[i].recip_m != 0, i / 120 == 1) << i;
  }
}

TEST(GoldenProject, StandsBesideTheChannelOfFog) {
  Config c = projecting();
  const Drawn alone = drawn(c, worked());
  c.fog = FogMode::vertex;
  Scene scene = worked();
  EXPECT_EQ(drawn(c, scene).trace.project, alone.trace.project);  // without fog in the scene
  scene.fog = Fog{{200, 100, 0}, 4};
  for (Vertex& v : scene.triangles[0].v) v.fog = 0.25;
  const Drawn both = drawn(c, scene);
  EXPECT_EQ(both.trace.setup_channel.size(), 4U);
  EXPECT_EQ(both.trace.project, alone.trace.project);
  for (const FogRecord& f : both.trace.fog) EXPECT_EQ(value(f.factor, c, F::fog_factor), 0.25);
}

TEST(GoldenProject, RefusesARangeThatItsFormatsDoNotHold) {
  Config c = projecting();
  Scene scene = worked();
  scene.projector = Projector{1e-30, 1};
  const auto error = input_error([&] { make_golden(c, true)->begin(scene); });
  EXPECT_NE(error.find("projector"), std::string::npos) << error;
  c.project = ProjectUnit::none;  // then nobody asks for it
  scene.commands.clear();
  make_golden(c, true)->begin(scene);
}

TEST(GoldenProject, CountsNoDivision) {
  const auto more = [](const Config& c, const Scene& scene) {
    Config none = c;
    none.project = ProjectUnit::none;
    Scene plain = scene;
    plain.commands = {change_in_front_of(0, {setting("texture1", 0)})};
    const Drawn with = drawn(c, scene), without = drawn(none, plain);
    EXPECT_EQ(with.trace.fragment, without.trace.fragment);
    EXPECT_EQ(with.counters.divides_pixel, without.counters.divides_pixel);
    return std::pair(with.counters.divides_edge - without.counters.divides_edge,
                     with.counters.divides_row - without.counters.divides_row);
  };
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  Config c = projecting();
  EXPECT_EQ(more(c, worked()), Pair(3 * 2, 3 * 15));  // edges with height, rows
  c.edge_slope = SlopeForm::reciprocal;
  c.row_slope = RowSlope::reciprocal;
  EXPECT_EQ(more(c, worked()), Pair(0, 0));
  EXPECT_EQ(more(projecting(Perspective::const_depth_rows), worked()), Pair(3 * 2, 0));
}

// ---- Against exact rationals

Rational value_of(const Config& c, F id, std::int64_t raw) { return test::value_of(c.format(id), raw); }

// B of a range, and s_max'.
struct Eye {
  int exponent;
  Rational s_max, b;
};
Eye eye_of(const Config& c, double s_min, double s_max) {
  int e = -1080;
  while (Rational(rational_of(s_max)) > scale(Rational(1), e)) ++e;
  const Rational low = oracle_q(c.format(F::setup_s), scale(rational_of(s_min), -e));
  const Rational high = oracle_q(c.format(F::setup_s), scale(rational_of(s_max), -e));
  const Rational hmax = Rational(power_of_two(c.depth_bits) - 1);
  return {e, high, oracle_q(c.format(F::setup_b), hmax * low / (high - low))};
}
// R(d) for d > 0, by exact quotients: m 2^-e.
Rational reciprocal_of(const Reciprocal& unit, const Rational& d, std::int64_t m, std::int64_t e) {
  int log2 = 0;
  while (scale(Rational(1), log2) > d) --log2;
  while (scale(Rational(1), log2 + 1) <= d) ++log2;
  const Rational n = unit.normalize ? scale(d, -log2) : d;
  EXPECT_EQ(Int(m), oracle_raw(unit.output, 1 / n));
  EXPECT_EQ(e, unit.normalize ? log2 : 0);
  return scale(test::value_of(unit.output, m), -static_cast<int>(e));
}

Config random_project_config(Draw& draw) {
  Config c = shipped_config(shipped_names[static_cast<std::size_t>(draw.integer(0, 2))]);
  const Perspective modes[] = {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine,
                               Perspective::const_depth_rows};
  c.perspective = modes[draw.integer(0, 3)];
  c.project = ProjectUnit::reciprocal;
  c.depth_code = draw.flip() ? DepthCode::inverse : DepthCode::opengl;
  c.edge_slope = draw.flip() ? SlopeForm::divide : SlopeForm::reciprocal;
  c.row_slope = has_plane_rows(c.perspective) ? RowSlope::divide : static_cast<RowSlope>(draw.integer(0, 2));
  c.pixel_reciprocal.kind = ReciprocalKind::restoring;
  c.fog = FogMode::none;
  c.mip = MipMode::none;
  for (Format& f : c.formats) f.rounding = static_cast<Rounding>(draw.integer(0, 6));
  const auto shape = [&](F id, int integer, bool is_signed) {
    const auto overflow = static_cast<Overflow>(draw.integer(0, is_signed ? 4 : 3));
    const int fraction = static_cast<int>(draw.integer(2, 20));
    c.format(id) = {integer + fraction, integer, is_signed, static_cast<Rounding>(draw.integer(0, 6)),
                    overflow,           false};
  };
  shape(F::project_vertex, 8, true);
  shape(F::project_step, static_cast<int>(draw.integer(12, 24)), true);
  shape(F::project_grad, static_cast<int>(draw.integer(12, 24)), true);
  shape(F::project_acc, static_cast<int>(draw.integer(16, 26)), true);
  shape(F::project_value, static_cast<int>(draw.integer(16, 26)), true);
  shape(F::project_ratio, static_cast<int>(draw.integer(4, 16)), false);
  shape(F::project_h, static_cast<int>(draw.integer(10, 20)), true);
  return c;
}

Scene random_project_scene(Draw& draw) {
  Scene scene = test_scene(48, 40);
  scene.fog.reset();
  const double s_min = std::exp2(draw.real(-3, 3));
  scene.projector = Projector{s_min, s_min * std::exp2(draw.real(1, 8))};
  scene.triangles = {random_triangle(draw, scene)};
  for (Vertex& v : scene.triangles[0].v) {
    v.project_w = draw.real(-0.3, 1.5) * scene.projector->s_max;
    v.project_x = draw.real(-4, 12) * v.project_w;
    v.project_y = draw.real(-2, 6) * v.project_w;
  }
  scene.commands = {change_in_front_of(0, {setting("texture1", 0), setting("texture1.coordinates", 1)})};
  return scene;
}

// Each record of a channel from those in front of it, and each of project from those of its pixel.
TEST(GoldenProject, EqualsTheSpecificationInRationals) {
  Draw draw(71);
  int legal = 0, in_front = 0, behind = 0, inside = 0, rows = 0, fragments = 0;
  for (int i = 0; i < 400; ++i) {
    const Config c = random_project_config(draw);
    const Scene scene = random_project_scene(draw);
    if (first_violation(c)) continue;
    ++legal;
    const Trace t = drawn(c, scene).trace;
    if (t.setup.empty()) continue;
    SCOPED_TRACE("case " + std::to_string(i) + " " + std::string(to_string(c.perspective)));
    const auto& [record] = std::array{t.setup[0]};
    const SetupRecord& s = record;
    const Format xy = c.coordinate_format();
    const Eye eye = eye_of(c, scene.projector->s_min, scene.projector->s_max);
    const Rational b = value_of(c, F::setup_b, t.constants.at(0).b);
    const std::array<std::int64_t, 3> h{s.h0, s.h1, s.h2}, xs{s.x0, s.x1, s.x2}, ys{s.y0, s.y1, s.y2};
    const bool planes = has_plane_rows(c.perspective), by_plane = has_setup_plane(c);

    // The vertices in the order of setup.
    std::array<const Vertex*, 3> sorted{};
    for (std::size_t v = 0; v < 3; ++v) sorted[v] = &scene.triangles[0].v[v];
    std::ranges::stable_sort(sorted, [&](const Vertex* p, const Vertex* q) {
      const auto key = [&](const Vertex* v) {
        return std::pair(oracle_raw(xy, rational_of(v->y)), oracle_raw(xy, rational_of(v->x)));
      };
      return key(p) < key(q);
    });
    ASSERT_EQ(t.setup_channel.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const SetupChannelRecord& r = t.setup_channel[k];
      ASSERT_EQ(r.channel, static_cast<std::int64_t>(k) + 1);
      const std::array<std::int64_t, 3> w{r.w0, r.w1, r.w2}, f{r.f0, r.f1, r.f2};
      std::array<Rational, 3> g;
      for (std::size_t v = 0; v < 3; ++v) {
        const double in = k == 0   ? sorted[v]->project_x
                          : k == 1 ? sorted[v]->project_y
                                   : sorted[v]->project_w;
        ASSERT_EQ(Int(w[v]), oracle_raw(c.format(F::project_vertex), scale(rational_of(in), -eye.exponent)));
        ASSERT_EQ(Int(f[v]), oracle_raw(c.format(F::project_acc), value_of(c, F::project_vertex, w[v]) *
                                                                      (value_of(c, F::setup_h, h[v]) + b)));
        g[v] = value_of(c, F::project_acc, f[v]);
      }
      const auto x = [&](std::size_t v) { return test::value_of(xy, xs[v]); };
      const auto y = [&](std::size_t v) { return test::value_of(xy, ys[v]); };
      const Rational area = (x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0));
      const Rational nx = (g[1] - g[0]) * (y(2) - y(0)) - (g[2] - g[0]) * (y(1) - y(0));
      const Rational ny = (g[2] - g[0]) * (x(1) - x(0)) - (g[1] - g[0]) * (x(2) - x(0));
      if (planes || by_plane) {
        Rational inverse = 1 / area;
        if (by_plane && c.edge_slope == SlopeForm::reciprocal) {
          inverse = scale(test::value_of(c.edge_reciprocal.output, t.setup_plane.at(0).recip_m),
                          -static_cast<int>(t.setup_plane.at(0).recip_e));
          if (area < 0) inverse = -inverse;
        }
        ASSERT_EQ(Int(r.w_x), oracle_raw(c.format(F::project_grad), nx * inverse));
        ASSERT_EQ(Int(r.w_y), oracle_raw(c.format(F::project_grad), ny * inverse));
        ASSERT_EQ(r.step0 | r.step1 | r.step2, 0);
      } else {
        for (const EdgeRecord& e : t.edge) {
          const std::size_t from = e.edge == 2 ? 1 : 0, to = e.edge == 1 ? 1 : 2;
          Rational inverse = 1 / (y(to) - y(from));
          if (c.edge_slope == SlopeForm::reciprocal) {
            inverse =
                scale(test::value_of(c.edge_reciprocal.output, e.recip_m), -static_cast<int>(e.recip_e));
          }
          const std::array<std::int64_t, 3> step{r.step0, r.step1, r.step2};
          ASSERT_EQ(Int(step[static_cast<std::size_t>(e.edge)]),
                    oracle_raw(c.format(F::project_step), (g[to] - g[from]) * inverse));
        }
      }
      // Rows.
      for (std::size_t n = 0; n < t.span.size(); ++n) {
        const SpanRecord& span = t.span[n];
        const SpanChannelRecord& start = t.span_channel.at(3 * n + k);
        ASSERT_EQ(std::pair(start.x, start.y), std::pair(span.x, span.y));
        const Rational right = Rational(Int(2 * span.x + 1), Int(2)) - x(0);
        const Rational down = Rational(Int(2 * span.y + 1), Int(2)) - y(0);
        ++rows;
        if (planes || by_plane) {
          const Rational wx = value_of(c, F::project_grad, r.w_x), wy = value_of(c, F::project_grad, r.w_y);
          ASSERT_EQ(Int(start.w), oracle_raw(c.format(F::project_acc), g[0] + wx * right + wy * down));
          const bool along_y = planes && t.plane.at(0).major == 1;
          const Rational major = along_y ? wy : wx, minor = along_y ? wx : wy;
          const Rational across = planes && t.plane.at(0).k < 0 ? Rational(-minor) : minor;
          ASSERT_EQ(Int(start.w_step0), oracle_raw(c.format(F::project_step), major));
          ASSERT_EQ(Int(start.w_step1),
                    oracle_raw(c.format(F::project_step), planes ? Rational(major + across) : major));
          continue;
        }
        const RowRecord& row = t.row.at(n);
        const RowChannelRecord& ends = t.row_channel.at(3 * n + k);
        ASSERT_EQ(ends.l, ends.l_acc);
        ASSERT_EQ(ends.r, ends.r_acc);
        const Rational left = value_of(c, F::edge_x, row.l_x);
        const Rational length = value_of(c, F::edge_x, row.r_x) - left;
        Rational step = 0;
        if (length > 0) {
          Rational inverse = 1 / length;
          if (c.row_slope == RowSlope::reciprocal) {
            inverse =
                scale(test::value_of(c.row_reciprocal.output, span.recip_m), -static_cast<int>(span.recip_e));
          }
          step =
              oracle_q(c.format(F::project_step),
                       (value_of(c, F::project_acc, ends.r) - value_of(c, F::project_acc, ends.l)) * inverse);
        }
        ASSERT_EQ(value_of(c, F::project_step, start.w_step0), step);
        ASSERT_EQ(start.w_step1, start.w_step0);
        const Rational p = Rational(Int(2 * row.x_first + 1), Int(2)) - left;
        ASSERT_EQ(Int(start.w),
                  oracle_raw(c.format(F::project_acc), value_of(c, F::project_acc, ends.l) + step * p));
      }
      // Fragments.
      std::size_t next = 0;
      for (std::size_t n = 0; n < t.span.size(); ++n) {
        const SpanChannelRecord& start = t.span_channel.at(3 * n + k);
        Rational acc = value_of(c, F::project_acc, start.w);
        for (std::int64_t j = 0; j < t.span[n].count; ++j, ++next) {
          const FragmentChannelRecord& w_at = t.fragment_channel.at(3 * next + k);
          ASSERT_EQ(Int(w_at.w), oracle_raw(c.format(F::project_value), acc));
          ++fragments;
          if (j + 1 == t.span[n].count) continue;
          const FragmentRecord &here = t.fragment[next], &then = t.fragment[next + 1];
          const bool steps = here.x != then.x && here.y != then.y;
          acc = oracle_q(c.format(F::project_acc),
                         acc + value_of(c, F::project_step, steps ? start.w_step1 : start.w_step0));
        }
      }
    }

    const Rational a = oracle_q(c.format(F::distance_a), eye.b * eye.s_max);
    ASSERT_EQ(t.project.size(), t.texture_second.size());
    for (const ProjectRecord& p : t.project) {
      const auto found =
          std::ranges::find_if(t.fragment, [&](const FragmentRecord& f) { return f.x == p.x && f.y == p.y; });
      const auto place = static_cast<std::size_t>(found - t.fragment.begin());
      const auto w_of = [&](std::size_t k) {
        return value_of(c, F::project_value, t.fragment_channel.at(3 * place + k).w);
      };
      const Rational w = w_of(2);
      if (w <= 0) {
        expect_nothing(p);
        ++behind;
        continue;
      }
      ++in_front;
      const Rational inverse = reciprocal_of(c.pixel_reciprocal, w, p.recip_m, p.recip_e);
      const Format& uv = c.format(F::span_uv);
      ASSERT_EQ(Int(p.s), oracle_raw(uv, w_of(0) * inverse));
      ASSERT_EQ(Int(p.t), oracle_raw(uv, w_of(1) * inverse));
      const Rational sum = value_of(c, F::span_h, found->h) + b;
      ASSERT_EQ(Int(p.ratio), oracle_raw(c.format(F::project_ratio), sum * inverse));
      const Rational code = a * value_of(c, F::project_ratio, p.ratio) - eye.b;
      ASSERT_EQ(Int(p.h), oracle_raw(c.format(F::project_h), code));
      const Rational hp = value_of(c, F::project_h, p.h);
      const Rational z_max = Rational(power_of_two(c.depth_bits) - 1);
      ASSERT_EQ(Int(p.z),
                oracle_raw(c.depth_format(), c.depth_code == DepthCode::inverse ? hp : Rational(z_max - hp)));
      const Int i = floor_of(value_of(c, F::span_uv, p.s)), j = floor_of(value_of(c, F::span_uv, p.t));
      ASSERT_EQ(p.inside, i >= 0 && i < 8 && j >= 0 && j < 4 ? 1 : 0);
      inside += static_cast<int>(p.inside);
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(legal, 200);
  EXPECT_GT(rows, 3000);
  EXPECT_GT(fragments, 30000);
  EXPECT_GT(in_front, 5000);
  EXPECT_GT(behind, 1000);
  EXPECT_GT(inside, 500);
}

// ---- Precision

TEST(GoldenProject, PrecisionCountsItsRegisters) {
  const auto chosen = [](F id, int word, int integer) {
    Config c = projecting();
    c.format(id) = {word, integer, true, Rounding::rnd, Overflow::sat, false};
    return golden::choose_precision(c);
  };
  using golden::Width;
  const golden::Precision narrow = golden::choose_precision(projecting());
  EXPECT_EQ(narrow.project, Width::f64);
  EXPECT_NE(chosen(F::project_value, 60, 28).project, Width::f64);
  EXPECT_NE(chosen(F::project_ratio, 60, 28).project, Width::f64);
  EXPECT_NE(chosen(F::project_h, 60, 28).project, Width::f64);
  // The products stand in the accumulator's format, and each stage that starts from them reads it.
  Config c = projecting();
  c.format(F::project_acc) = {60, 28, true, Rounding::rnd, Overflow::sat, false};
  const golden::Precision wide = golden::choose_precision(c);
  EXPECT_NE(wide.setup, Width::f64);
  EXPECT_NE(wide.edge_setup, Width::f64);
  EXPECT_NE(wide.edge_walk, Width::f64);
  EXPECT_NE(wide.span_setup, Width::f64);
  EXPECT_NE(wide.span, Width::f64);
  c.perspective = Perspective::const_depth_rows;
  EXPECT_NE(golden::choose_precision(c).plane_walk, Width::f64);
  c = projecting(Perspective::delta_f, RowSlope::plane);
  c.format(F::project_acc) = {60, 28, true, Rounding::rnd, Overflow::sat, false};
  EXPECT_NE(golden::choose_precision(c).setup_plane, Width::f64);
  // Without the unit nothing of it counts.
  c.project = ProjectUnit::none;
  EXPECT_EQ(golden::choose_precision(c).setup_plane, Width::f64);
  for (const golden::PrecisionRow& row : golden::choose_precision(c).rows) {
    EXPECT_NE(row.stage, "project");
  }
}

// ---- ideal

TEST(GoldenProject, IdealDividesInSpace) {
  Config c = projecting();
  const Scene scene = worked();
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    c.depth_code = code;
    const auto t = ideal_triangle(c, scene.triangles[0]);
    ASSERT_TRUE(t);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(9, 3), std::pair(2, 12)}) {
      const IdealFragment f = ideal_at(c, scene, *t, x, y);
      const auto p = ideal_projection(c, scene, f.point);
      ASSERT_TRUE(p);
      EXPECT_NEAR(p->s, 0.75 + x / 2.0, 1e-12);
      EXPECT_NEAR(p->t, 2.25 + y / 2.0, 1e-12);
      EXPECT_NEAR(p->w, 65536 / (123 - 4.0 * x - 6.0 * y), 1e-9);
      EXPECT_NEAR(p->h, 122 - 4 * x - 6 * y, 1e-9);
      EXPECT_NEAR(p->z, code == DepthCode::inverse ? p->h : 65535 - p->h, 1e-9);
      // What is off is the difference to these.
      const ProjectRecord r = at(drawn(c, scene).trace.project, x, y);
      for (const auto& [field, exact] : {std::pair("s", p->s), std::pair("t", p->t), std::pair("h", p->h),
                                         std::pair("z", p->z), std::pair("ratio", 65536 / p->w)}) {
        EXPECT_EQ(ideal_value(RecordType::project, field, raw_values(r), c, scene, scene.triangles[0]), exact)
            << field;
      }
    }
    Scene behind = scene;
    for (Vertex& v : behind.triangles[0].v) v.project_w = -1;
    const auto far = ideal_triangle(c, behind.triangles[0]);
    EXPECT_FALSE(ideal_projection(c, behind, ideal_at(c, behind, *far, 2, 2).point));
    behind = scene;
    behind.projector.reset();
    EXPECT_FALSE(ideal_projection(c, behind, ideal_at(c, scene, *t, 2, 2).point));
  }
}

TEST(GoldenProject, IdealDrawsIt) {
  Config c = projecting();
  const auto red = [&](const Scene& scene, std::int64_t x, std::int64_t y) {
    const auto engine = make_ideal(c);
    engine->begin(scene);
    draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
    return static_cast<int>(engine->frame().color.at(static_cast<std::size_t>(4 * (y * scene.width + x))));
  };
  Scene scene = worked();
  EXPECT_EQ(red(scene, 1, 0), 10);    // s = 1.25
  EXPECT_EQ(red(scene, 12, 0), 255);  // s = 6.75
  EXPECT_EQ(red(scene, 1, 4), 255);   // t = 4.25
  scene = with_settings(scene, {setting("texture1.outside", 1), setting("texture1.red", 5)});
  EXPECT_EQ(red(scene, 12, 0), 5);
  Scene behind = scene;
  for (Vertex& v : behind.triangles[0].v) v.project_w = -1;
  EXPECT_EQ(red(behind, 1, 0), 5);
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    c.depth_code = code;
    const auto lit = [&](std::uint32_t h, DepthFunc func, std::int64_t bias) {
      Scene shadowed =
          with_settings(scene, {setting("texture1", 1), setting("texture1.compare", 1),
                                setting("texture1.func", static_cast<int>(func)),
                                setting("texture1.bias", code == DepthCode::inverse ? bias : -bias)});
      shadowed.textures[1] = shadow_map((code == DepthCode::inverse ? h : 65535 - h) << 16);
      const int code_of_red = red(shadowed, 1, 0);  // h_p = 118
      EXPECT_TRUE(code_of_red == 255 || code_of_red == 5);
      return code_of_red == 255;
    };
    EXPECT_TRUE(lit(117, DepthFunc::less, 0));
    EXPECT_FALSE(lit(119, DepthFunc::lequal, 0));
    EXPECT_TRUE(lit(119, DepthFunc::less, 2));
    EXPECT_TRUE(lit(119, DepthFunc::greater, 0));
    EXPECT_TRUE(lit(65535, DepthFunc::equal, 1 << 30));
  }
}

// A shadow map that ideal drew itself: a quad in front of the light keeps it from what lies behind.
TEST(GoldenProject, IdealComparesWithItsOwnCopy) {
  const Config c = projecting();
  Scene scene = worked();
  scene.commands.clear();
  const Triangle seen = scene.triangles[0];
  Triangle caster = seen;
  for (Vertex& v : caster.v) v.s = 1024;  // h = 63 in the map
  scene.textures[1].width = 64;
  scene.textures[1].height = 48;
  scene.textures[1].raw.assign(std::size_t{4} * 64 * 48, 0);
  scene.triangles = {caster, seen};
  scene.commands.push_back({1, Copy{.target = 0, .plane = CopyPlane::depth, .texture = 1}});
  scene.commands.push_back({1, Target{1}});
  scene.commands.push_back(change_in_front_of(
      1, {setting("texture1", 1), setting("texture1.coordinates", 1), setting("texture1.compare", 1),
          setting("texture1.op", static_cast<int>(TextureOp::replace))}));
  for (const bool is_golden : {true, false}) {
    const auto engine = is_golden ? make_golden(c, true) : make_ideal(c);
    engine->begin(scene);
    draw_scene(*engine, scene, 0, 2, nullptr);
    const auto red = [&](std::int64_t x, std::int64_t y) {
      return static_cast<int>(engine->frame().color.at(static_cast<std::size_t>(4 * (y * 64 + x))));
    };
    // h_p = 122 - 4 x - 6 y against 63, wherever a fragment looks.
    EXPECT_EQ(red(0, 0), 255);
    EXPECT_EQ(red(8, 4), 255);  // 66
    EXPECT_EQ(red(9, 4), 0);    // 62
    EXPECT_EQ(red(1, 13), 0);   // 40
  }
}

}  // namespace
}  // namespace bitspan::test
