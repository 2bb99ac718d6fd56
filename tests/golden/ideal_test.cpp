// SPDX-License-Identifier: Apache-2.0
// ideal: the closed form against a ray and a plane in space, exact coverage on hand cases and on meshes.
#include "golden/ideal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "golden/engine_golden.hpp"
#include "golden/mip_chain.hpp"
#include "tests/golden/golden_support.hpp"

namespace bitspan::test {
namespace {

struct Vec {
  long double x = 0, y = 0, z = 0;
};
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(Vec a, long double k) { return {a.x * k, a.y * k, a.z * k}; }
long double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

// Vertices on the snap's grid, so that the triangle in space is the one that ideal sees.
Triangle on_grid(Triangle t) {
  for (Vertex& v : t.v) {
    v.x = std::floor(v.x * 16) / 16;
    v.y = std::floor(v.y * 16) / 16;
  }
  return t;
}

TEST(Ideal, EqualsRayAndPlaneInSpace) {
  const Config c = shipped_config("depth16");
  Scene scene = test_scene();
  Draw draw(51);
  int compared = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle in = on_grid(random_triangle(draw, scene));
    const auto t = ideal_triangle(c, in);
    if (!t) continue;
    // The eye at the origin looks along z; a pixel's ray is (x - W/2, y - H/2, F).
    const auto ray = [&](long double x, long double y) {
      return Vec{x - scene.width / 2.0L, y - scene.height / 2.0L, scene.focal};
    };
    std::array<Vec, 3> p;
    for (std::size_t j = 0; j < 3; ++j) p[j] = ray(in.v[j].x, in.v[j].y) * (in.v[j].s / scene.focal);
    const Vec normal = cross(p[1] - p[0], p[2] - p[0]);
    const long double nn = dot(normal, normal);
    const std::int64_t x = draw.integer(0, scene.width - 1);
    const std::int64_t y = draw.integer(0, scene.height - 1);
    if (!ideal_covers(c, *t, x, y)) continue;
    const Vec r = ray(static_cast<long double>(x) + 0.5L, static_cast<long double>(y) + 0.5L);
    const Vec hit = r * (dot(normal, p[0]) / dot(normal, r));
    const long double l0 = dot(cross(p[1] - hit, p[2] - hit), normal) / nn;
    const long double l1 = dot(cross(p[2] - hit, p[0] - hit), normal) / nn;
    const long double l2 = 1 - l0 - l1;
    const IdealFragment f = ideal_at(c, scene, *t, x, y);
    const auto s = static_cast<double>(hit.z);
    ASSERT_NEAR(f.point.s, s, 1e-9 * s);
    const auto in_space = [&](auto member) {
      return static_cast<double>(l0 * in.v[0].*member + l1 * in.v[1].*member + l2 * in.v[2].*member);
    };
    ASSERT_NEAR(f.point.u, in_space(&Vertex::u), 1e-7);
    ASSERT_NEAR(f.point.v, in_space(&Vertex::v), 1e-7);
    const double a = 65535.0 * scene.s_min / (scene.s_max - scene.s_min) * scene.s_max;
    const double b = 65535.0 * scene.s_min / (scene.s_max - scene.s_min);
    ASSERT_NEAR(f.point.h, a / s - b, 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

TEST(Ideal, DepthCodeAtItsEnds) {
  const Config c = shipped_config("depth16");
  const Scene scene = test_scene();
  Triangle in;
  in.v[0] = {{1, 1, scene.s_min}, {}};
  in.v[1] = {{30, 2, scene.s_max}, {}};
  in.v[2] = {{3, 40, scene.s_min}, {}};
  const auto t = ideal_triangle(c, in);
  ASSERT_TRUE(t);
  EXPECT_NEAR(ideal_at_vertex(c, scene, *t, 0).h, 65535, 1e-9);
  EXPECT_NEAR(ideal_at_vertex(c, scene, *t, 1).h, 0, 1e-9);
  EXPECT_EQ(ideal_at_vertex(c, scene, *t, 2).x, 3);
  EXPECT_EQ(ideal_at_vertex(c, scene, *t, 2).y, 40);
}

TEST(Ideal, EdgeVertexAndPlaneAgree) {
  const Config c = shipped_config("depth20");
  const Scene scene = test_scene();
  Draw draw(52);
  int edges = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto t = ideal_triangle(c, random_triangle(draw, scene));
    if (!t) continue;
    const double unit = std::ldexp(1.0, -t->subpixel_bits);
    for (int edge = 0; edge < 3; ++edge) {
      const auto& a = t->v[edge == 2 ? 1 : 0];
      const auto& b = t->v[edge == 1 ? 1 : 2];
      const auto y = static_cast<std::int64_t>(std::ceil(static_cast<double>(a.y) * unit - 0.5));
      if (static_cast<double>(y) + 0.5 > static_cast<double>(b.y) * unit || a.y == b.y) continue;
      const IdealPoint on = ideal_on_edge(c, scene, *t, edge, y);
      const long double whole =
          std::fabs(static_cast<long double>(t->v[1].x - t->v[0].x) * (t->v[2].y - t->v[0].y) -
                    static_cast<long double>(t->v[2].x - t->v[0].x) * (t->v[1].y - t->v[0].y));
      if (whole < 4096) continue;  // a sliver: the crossing, rounded to double, is far off its plane
      const IdealPoint plane = ideal_point(c, scene, *t, on.x, on.y);
      ASSERT_NEAR(on.h, plane.h, 1e-3);
      ASSERT_NEAR(on.u, plane.u, 1e-3);
      ASSERT_NEAR(on.shade[3], plane.shade[3], 1e-6);
      ++edges;
    }
  }
  EXPECT_GT(edges, 1000);
}

int covered_pixels(const Config& c, const Triangle& in, std::int64_t size) {
  const auto t = ideal_triangle(c, in);
  int count = 0;
  for (std::int64_t y = 0; t && y < size; ++y) {
    for (std::int64_t x = 0; x < size; ++x) count += ideal_covers(c, *t, x, y) ? 1 : 0;
  }
  return count;
}

Triangle corners(double x0, double y0, double x1, double y1, double x2, double y2) {
  Triangle t;
  t.v[0] = {{x0, y0}, {}};
  t.v[1] = {{x1, y1}, {}};
  t.v[2] = {{x2, y2}, {}};
  return t;
}

TEST(Ideal, CoverageByHand) {
  Config c = shipped_config("depth16");
  c.fill_rule = FillRule::top_left;
  // Half of a square of 4 pixels through centres: left and top edges are in, the diagonal (a right edge) is
  // out.
  const Triangle half = corners(0.5, 0.5, 4.5, 0.5, 0.5, 4.5);
  EXPECT_EQ(covered_pixels(c, half, 8), 4 + 3 + 2 + 1);
  const Triangle other = corners(4.5, 0.5, 4.5, 4.5, 0.5, 4.5);
  EXPECT_EQ(covered_pixels(c, other, 8), 6);  // the diagonal is its left edge; right and bottom are out
  c.fill_rule = FillRule::inclusive;
  EXPECT_EQ(covered_pixels(c, half, 8), 5 + 4 + 3 + 2 + 1);
  EXPECT_EQ(covered_pixels(c, other, 8), 15);
  // No centre inside, no area, and the smallest triangle around one centre.
  c.fill_rule = FillRule::top_left;
  EXPECT_EQ(covered_pixels(c, corners(1.6, 1.6, 2.4, 1.6, 1.6, 2.4), 8), 0);
  EXPECT_FALSE(ideal_triangle(c, corners(1, 1, 3, 3, 2, 2)));
  EXPECT_FALSE(ideal_triangle(c, corners(1, 1, 1.01, 1, 1, 1.01)));  // snaps to one point
  EXPECT_EQ(covered_pixels(c, corners(2.4375, 2.4375, 2.625, 2.5, 2.5, 2.625), 8), 1);
}

// A fan that closes around a point in the middle of a square covers each pixel of the square once.
TEST(Ideal, SharedEdgesHitOnce) {
  Config c = shipped_config("depth16");
  c.fill_rule = FillRule::top_left;
  Draw draw(53);
  constexpr int size = 24;
  for (int i = 0; i < 200; ++i) {
    const double mx = std::floor(draw.real(1, size - 1) * 2) / 2;
    const double my = std::floor(draw.real(1, size - 1) * 2) / 2;
    const std::array<std::array<double, 2>, 4> square{{{0, 0}, {size, 0}, {size, size}, {0, size}}};
    std::array<int, size * size> hits{};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& a = square[k];
      const auto& b = square[(k + 1) % 4];
      const auto t = ideal_triangle(c, corners(a[0], a[1], b[0], b[1], mx, my));
      ASSERT_TRUE(t);
      for (std::size_t p = 0; p < hits.size(); ++p) {
        const auto at = static_cast<std::int64_t>(p);
        if (ideal_covers(c, *t, at % size, at / size)) ++hits[p];
      }
    }
    for (const int hit : hits) ASSERT_EQ(hit, 1);
  }
}

TEST(Ideal, FogAndTextureByHand) {
  Config c = shipped_config("depth16");
  c.filter = TextureFilter::bilinear;
  c.wrap = TextureWrap::clamp;
  c.transparent.reset();
  c.fog = FogMode::linear;
  Scene scene = test_scene();
  scene.textures[0] = {.name = "two", .width = 2, .height = 1, .rgba = {0, 100, 200, 255, 200, 100, 0, 51}};
  Triangle in = corners(-50, -50, 300, -50, -50, 300);
  for (Vertex& v : in.v) v.s = 15;  // fog distance 60: a quarter of the way
  for (Vertex& v : in.v) v.u = 1;   // half way between the two texels
  for (Vertex& v : in.v) v.v = 0.5;
  in.texture = 0;
  auto t = ideal_triangle(c, in);
  ASSERT_TRUE(t);
  IdealFragment f = ideal_at(c, scene, *t, 5, 6);
  EXPECT_NEAR(f.texel[0], 100, 1e-9);
  EXPECT_NEAR(f.texel[3], 0.6, 1e-12);
  EXPECT_NEAR(f.fog_factor, 0.75, 1e-12);
  EXPECT_NEAR(f.fogged[0], 90 + (100 - 90) * 0.75, 1e-9);
  EXPECT_FALSE(f.killed);
  const auto texel_at = [&](double u, TextureWrap wrap) {
    c.wrap = wrap;
    for (Vertex& v : in.v) v.u = u;
    t = ideal_triangle(c, in);
    return ideal_at(c, scene, *t, 5, 6).texel;
  };
  c.border = {40, 0, 0, 102};
  EXPECT_NEAR(texel_at(2.25, TextureWrap::mirror)[0], 200, 1e-9);
  EXPECT_NEAR(texel_at(3.25, TextureWrap::mirror)[0], 50, 1e-9);
  EXPECT_NEAR(texel_at(-0.75, TextureWrap::mirror)[0], 50, 1e-9);
  EXPECT_NEAR(texel_at(2, TextureWrap::border)[0], 120, 1e-9);
  EXPECT_NEAR(texel_at(-9, TextureWrap::border)[0], 40, 1e-9);
  EXPECT_NEAR(texel_at(-9, TextureWrap::border)[3], 0.4, 1e-12);
  texel_at(1, TextureWrap::clamp);
  c.fog = FogMode::table;
  const double x = 5.5 - scene.width / 2.0;
  const double y = 6.5 - scene.height / 2.0;
  const double distance = 15 * std::sqrt(1 + (x * x + y * y) / (scene.focal * scene.focal));
  EXPECT_NEAR(ideal_at(c, scene, *t, 5, 6).fog_factor, std::exp(-distance / 60), 1e-12);
  // Transparent: nearest to u = 1 is the second texel; replaced by nothing when the first is reserved.
  c.transparent = {200, 100, 0};
  EXPECT_TRUE(ideal_at(c, scene, *t, 5, 6).killed);
  c.transparent = {0, 100, 200};
  f = ideal_at(c, scene, *t, 5, 6);
  EXPECT_FALSE(f.killed);
  EXPECT_NEAR(f.texel[0], 200, 1e-9);
}

// Two textures of one size and of a format whose texels are not in `rgba`.
TEST(Ideal, EachTextureHasItsOwnLevels) {
  Config c = plain_config();
  c.filter = TextureFilter::nearest;
  c.mip = MipMode::nearest;
  c.lod_bias = 16;  // level 1: one texel
  Scene scene = test_scene();
  scene.textures.clear();
  for (const int code : {40, 200}) {
    Texture t;
    t.width = 2;
    t.height = 2;
    t.format = TexelFormat::i8;
    t.raw.assign(4, static_cast<std::uint8_t>(code));
    scene.textures.push_back(t);
  }
  Triangle in = corners(-50, -50, 300, -50, -50, 300);
  for (const int texture : {0, 1, 0}) {
    in.texture = texture;
    const auto t = ideal_triangle(c, in);
    ASSERT_TRUE(t);
    const golden::SceneLevels levels = golden::scene_levels(c, scene);
    const double expected = texture == 0 ? 40 : 200;
    EXPECT_EQ(ideal_at(c, scene, *t, 5, 6).texel[0], expected);
    EXPECT_EQ(ideal_at(c, scene, *t, 5, 6, &levels).texel[0], expected);
  }
}

// Columns of 10, 20, 40, 80 and, in the levels above, 15, 60 and 38. At u = 1 one texel is 20, four weigh 15.
TEST(Ideal, RegistersChooseLevelsAndFilters) {
  Config c = plain_config();
  c.mip = MipMode::linear;
  c.lod_bias = 8;  // level 1/2
  Scene scene = test_scene();
  scene.textures = {{"row", 4, 1, {}}};
  scene.textures[0].rgba = {10, 0, 0, 255, 20, 0, 0, 255, 40, 0, 0, 255, 80, 0, 0, 255};
  Triangle in = corners(-50, -50, 300, -50, -50, 300);
  in.texture = 0;
  for (Vertex& v : in.v) {
    v.s = in.v[0].s;
    v.u = 1;
    v.v = 0.5;
    v.c = {1, 1, 1, 1};
  }
  scene.triangles = {in};
  scene.fog.reset();
  const auto ideal = make_ideal(c);
  const auto red = [&](std::vector<std::pair<std::string, std::int64_t>> registers) {
    StateChange change;
    for (const auto& [key, value] : registers) change.settings.push_back({*find_state_register(key), value});
    scene.commands = {{0, change}};
    ideal->begin(scene);
    draw_scene(*ideal, scene, 0, 1, nullptr);
    return int{ideal->frame().color[0]};
  };
  EXPECT_EQ(red({}), 18);                          // of 20 and 15: 17.5
  EXPECT_EQ(red({{"texture.lod.bias", 4}}), 19);   // 18.75
  EXPECT_EQ(red({{"texture.lod.bias", 20}}), 21);  // 15 and 38: 20.75
  EXPECT_EQ(red({{"texture.lod.bias", -9}}), 20);
  EXPECT_EQ(red({{"texture.level.least", 1}}), 15);
  EXPECT_EQ(red({{"texture.level.least", 9}}), 38);  // the last one
  EXPECT_EQ(red({{"texture.level.greatest", 0}}), 20);
  EXPECT_EQ(red({{"texture.level.least", 2}, {"texture.level.greatest", 1}}), 38);
  EXPECT_EQ(red({{"texture.lod.bias", 32}, {"texture.level.greatest", 1}}), 15);
  EXPECT_EQ(red({{"texture.magnify", 2}}), 18);
  EXPECT_EQ(red({{"texture.magnify", 2}, {"texture.lod.bias", 0}}), 15);
  EXPECT_EQ(red({{"texture.magnify", 2}, {"texture.lod.bias", 1}}), 20);  // 19.69
  EXPECT_EQ(red({{"texture.magnify", 2}, {"texture.level.greatest", 0}}), 15);
  EXPECT_EQ(red({{"texture.magnify", 2}, {"texture.lod.bias", -9}, {"texture.level.least", 1}}), 15);
  EXPECT_EQ(red({{"texture.magnify", 1}, {"texture.filter", 1}, {"texture.lod.bias", 0}}), 20);
  // The second unit puts its texel in place of the first one's.
  const std::vector<std::pair<std::string, std::int64_t>> second{{"texture1", 0}, {"texture1.op", 0}};
  const auto red1 = [&](std::vector<std::pair<std::string, std::int64_t>> registers) {
    registers.insert(registers.end(), second.begin(), second.end());
    return red(std::move(registers));
  };
  EXPECT_EQ(red1({}), 18);
  EXPECT_EQ(red1({{"texture.lod.bias", -20}, {"texture.level.least", 2}, {"texture.magnify", 2}}), 18);
  EXPECT_EQ(red1({{"texture1.lod.bias", 4}}), 19);
  EXPECT_EQ(red1({{"texture1.lod.bias", 20}, {"texture.lod.bias", 31}}), 21);
  EXPECT_EQ(red1({{"texture1.level.least", 1}}), 15);
  EXPECT_EQ(red1({{"texture1.lod.bias", 32}, {"texture1.level.greatest", 1}}), 15);
  EXPECT_EQ(red1({{"texture1.magnify", 2}, {"texture1.lod.bias", 0}, {"texture.lod.bias", 9}}), 15);
}

// The engine writes what ideal_at says, wherever one triangle alone is drawn; golden is near it.
TEST(Ideal, EngineDrawsIt) {
  Config c = shipped_config("depth16");
  c.perspective = Perspective::delta_f;
  Scene scene = test_scene();
  Draw draw(54);
  const auto ideal = make_ideal(c);
  const auto golden = make_golden(c, false);
  int pixels = 0;
  double worst_depth = 0;
  for (int i = 0; i < 60; ++i) {
    Triangle in = random_triangle(draw, scene);
    for (Vertex& v : in.v) {
      v.s = draw.real(40, 60);
      v.c[3] = 1;
    }
    scene.triangles = {in};
    ideal->begin(scene);
    ideal->draw(scene.triangles, 7, nullptr);
    golden->begin(scene);
    golden->draw(scene.triangles, 7, nullptr);
    EXPECT_EQ(ideal->counters().covered, golden->counters().covered);
    const auto t = ideal_triangle(c, in);
    const Frame& frame = ideal->frame();
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const auto at = static_cast<std::size_t>(y * scene.width + x);
        if (frame.triangle[at] < 0) {
          ASSERT_EQ(frame.depth[at], 0U);
          ASSERT_EQ(frame.color[4 * at], scene.background[0]);
          continue;
        }
        ASSERT_EQ(frame.triangle[at], 7);
        ASSERT_TRUE(t && ideal_covers(c, *t, x, y));
        const IdealFragment f = ideal_at(c, scene, *t, x, y);
        ASSERT_EQ(frame.u[at], f.point.u);
        ASSERT_EQ(frame.depth[at], static_cast<std::uint32_t>(std::floor(f.point.h + 0.5)));
        ++pixels;
        if (golden->frame().triangle[at] == 7) {
          worst_depth = std::fmax(worst_depth, std::fabs(golden->frame().depth[at] - f.point.h));
        }
      }
    }
  }
  EXPECT_GT(pixels, 2000);
  EXPECT_LT(worst_depth, 3);
  EXPECT_GT(worst_depth, 0);
}

}  // namespace
}  // namespace bitspan::test
