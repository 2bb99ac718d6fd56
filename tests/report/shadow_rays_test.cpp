// SPDX-License-Identifier: Apache-2.0
// Shadow maps against rays from the light, with the bias that each triangle's slope asks for. [SH2]
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "config/modes.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/shadow.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Config with_projector(const std::string& name, TextureFilter filter) {
  Config config = shipped_config(name);
  config.project = ProjectUnit::reciprocal;
  config.filter = filter;
  return config;
}

// A box or an ellipsoid of facets, turned, with its middle at `at`. All are convex.
std::vector<Face> convex_body(Random& random, const Vec3& at) {
  const auto columns = random.integer(3, 24);
  const auto rows = random.integer(2, 12);
  const Vec3 size{random.uniform(0.3, 3), random.uniform(0.3, 3), random.uniform(0.3, 3)};
  Viewpoint turn;
  look_at(turn, {}, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)},
          {0.3, random.uniform(0.5, 1), 0.1});
  const auto place = [&](std::int64_t column, std::int64_t row) {
    const double around =
        2 * std::numbers::pi * static_cast<double>(column % columns) / static_cast<double>(columns);
    const double down = std::numbers::pi * static_cast<double>(row) / static_cast<double>(rows);
    const double out = row == 0 || row == rows ? 0 : std::sin(down);
    const Vec3 p{size.x * std::cos(around) * out, size.y * std::cos(down), size.z * std::sin(around) * out};
    return at + turn.right * p.x + turn.down * p.y + turn.forward * p.z;
  };
  std::vector<Face> faces;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    Face& face = faces.emplace_back();
    face.corner[0].position = a;
    face.corner[1].position = b;
    face.corner[2].position = c;
    for (Corner& corner : face.corner) corner.c = {0.8, 0.8, 0.8, 1};
  };
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      const Vec3 a = place(column, row), b = place(column + 1, row);
      const Vec3 c = place(column + 1, row + 1), d = place(column, row + 1);
      if (row + 1 < rows) add(a, c, d);
      if (row > 0) add(a, b, c);
    }
  }
  return faces;
}

// A scene and the same in the light of a lamp.
struct Shadowed {
  Shadowed(const Config& config_, const Scene& scene_, std::vector<Face> faces_, const ShadowOptions& lamp_)
      : config(config_), scene(scene_), faces(std::move(faces_)), lamp(lamp_), light(view_of(faces, lamp)) {
    plain = drawn(config, scene, "model");
    const Scene plan = shadowed(scene, faces, lamp);
    const auto engine = make_engine("model", config);
    engine->begin(plan);
    Trace trace;
    draw_scene(*engine, plan, 0, plan.triangles.size(), &trace);
    shaded = engine->frame();
    record.resize(plain.triangle.size());
    for (const ProjectRecord& r : trace.project)
      record[static_cast<std::size_t>(r.y * scene.width + r.x)] = r;
  }
  bool is_dark(std::size_t at) const { return shaded.color[4 * at + 1] != plain.color[4 * at + 1]; }
  // A triangle that the viewer sees nearly edge on may have slopes that its registers do not hold. Then the
  // record's code is not that of the triangle's plane at the record's place, by more codes than are reckoned.
  bool is_off_its_plane(std::size_t at, const Face& face, const ShadowBias& bias) const {
    const ProjectRecord& r = record[at];
    const double texel = std::ldexp(1.0, -config.format(FormatId::span_uv).fraction());
    const Vec3 a = in_view(face.corner[0].position, light);
    const Vec3 normal =
        cross(in_view(face.corner[1].position, light) - a, in_view(face.corner[2].position, light) - a);
    const Vec3 to{(static_cast<double>(r.s) * texel - lamp.size / 2.0) / light.focal,
                  (static_cast<double>(r.t) * texel - lamp.size / 2.0) / light.focal, 1};
    const double inverse = dot(normal, to) / dot(normal, a) / (1 - bias.nearer);
    const double codes = (std::exp2(lamp.depth_bits) - 1) / (1 / light.s_min - 1 / light.s_max);
    // As scene/shadow.cpp reckons, with the eighth of a texel that is left for the place.
    const double slope = (std::abs(normal.x) + std::abs(normal.y)) / (std::abs(dot(normal, a)) * light.focal);
    const double reckoned = 2 + codes * (0.125 * slope + inverse * (2 * std::exp2(-lamp.depth_bits) +
                                                                    0x1p-22 * light.s_max * inverse));
    const double expected = std::min(codes * (inverse - 1 / light.s_max), std::exp2(lamp.depth_bits) - 1);
    const double largest = std::exp2(lamp.depth_bits) - 1;
    const auto z = static_cast<double>(r.z);
    return std::abs(expected - (lamp.depth_code == DepthCode::opengl ? largest - z : z)) > reckoned;
  }

  const Config& config;
  const Scene& scene;
  std::vector<Face> faces;  // casters
  ShadowOptions lamp;
  Viewpoint light;
  Frame plain, shaded;
  std::vector<ProjectRecord> record;  // per pixel, of its last fragment
};

TEST(ShadowRays, ConvexBodiesDoNotShadeWhatTheLightSees) {
  Random random(20261128);
  std::size_t lit = 0, behind = 0, dark_behind = 0, inside = 0, off = 0, wrong = 0;
  for (int turn = 0; turn < 40; ++turn) {
    const std::array names{"depth16", "depth20", "narrow"};
    Config config = with_projector(names[static_cast<std::size_t>(turn % 3)],
                                   turn % 2 == 0 ? TextureFilter::nearest : TextureFilter::bilinear);
    if (turn % 5 == 0) config.depth_code = DepthCode::opengl;
    const Vec3 middle{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(6, 12)};
    const std::vector<Face> faces = convex_body(random, middle);
    const ShadowOptions lamp{
        .light = {random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-4, 40)},
        .size = static_cast<int>(random.integer(64, 512)),
        .depth_bits = config.depth_bits,
        .depth_code = config.depth_code};
    const Scene scene = seen_scene(faces);
    const std::vector<Face> shown = faces_of(scene);
    const Shadowed in(config, scene, faces, lamp);
    for (std::size_t at = 0; at < in.plain.triangle.size(); ++at) {
      if (in.plain.triangle[at] < 0) continue;
      const auto triangle = static_cast<std::size_t>(in.plain.triangle[at]);
      const ShadowBias bias = bias_of(scene.triangles[triangle], scene, in.light, lamp.depth_bits);
      // At the outline a corner's rounding may show the inside of a face.
      if (!is_lit_from_behind(shown[triangle], middle)) {
        ++inside;
      } else if (is_lit_from_behind(shown[triangle], lamp.light)) {
        ++behind;
        dark_behind += in.is_dark(at) ? 1U : 0U;
      } else if (in.is_off_its_plane(at, shown[triangle], bias)) {
        ++off;
      } else {
        ++lit;
        wrong += in.is_dark(at) ? 1U : 0U;
      }
    }
  }
  std::printf(
      "%zu lit pixels, %zu that the light does not face, of which %zu are dark, %zu off their plane\n", lit,
      behind, dark_behind, off);
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(lit, 20000U);
  EXPECT_LT(off + inside, lit / 500);
  // But for some at the outline, where the map shows no body.
  EXPECT_GT(dark_behind, behind * 99 / 100);
}

struct Judged {
  std::size_t equal = 0, near_edge = 0, within_bias = 0, off = 0, wrong_dark = 0, wrong_lit = 0;
};

// Each pixel of the picture, by rays from the light to the point that it shows. Within 1.5 texels of a
// shadow's edge, as rays through a grid around the point tell, either is right. A face that the light sees
// from the other side is dark.
Judged judged(const Shadowed& in) {
  const auto& [config, scene, faces, lamp, light, plain, shaded, record] = in;
  Judged out;
  for (std::size_t at = 0; at < plain.triangle.size(); ++at) {
    const std::int32_t shown = plain.triangle[at];
    if (shown < 0) continue;
    const Face& face = faces[static_cast<std::size_t>(shown)];
    const double x = static_cast<double>(at % static_cast<std::size_t>(scene.width)) + 0.5;
    const double y = static_cast<double>(at / static_cast<std::size_t>(scene.width)) + 0.5;
    const Vec3 point = point_at(scene, face, x, y);
    const Vec3 seen = in_view(point, light);
    const double s = seen.x / seen.z * light.focal;
    const double t = seen.y / seen.z * light.focal;
    const double half = lamp.size / 2.0;
    const bool is = in.is_dark(at);
    if (seen.z <= 0 || std::max(std::abs(s), std::abs(t)) > half + 1.5) {
      ++(is ? out.wrong_dark : out.equal);
      continue;
    }
    const bool is_behind = is_lit_from_behind(face, lamp.light);
    // A face that the light sees from behind shades itself.
    const auto truth = [&](const Vec3& p) {
      return faces_between(faces, lamp.light, lamp.light + (p - lamp.light) * (is_behind ? 1 + 1e-6 : 1),
                           is_behind ? -1 : shown) > 0;
    };
    const bool expected = truth(point);
    if (is == expected) {
      ++out.equal;
      continue;
    }
    const Vec3& a = face.corner[0].position;
    const Vec3 normal = cross(face.corner[1].position - a, face.corner[2].position - a);
    // Along the plane, so many texels beside it.
    const auto is_unlike = [&](double ds, double dt) {
      const Vec3 along =
          light.right * ((s + ds) / light.focal) + light.down * ((t + dt) / light.focal) + light.forward;
      const Vec3 p = lamp.light + along * (dot(normal, a - lamp.light) / dot(normal, along));
      return std::abs(s + ds) > half || std::abs(t + dt) > half || truth(p) != expected;
    };
    bool is_near_edge = false;
    for (int i = 0; i < 49 && !is_near_edge; ++i)
      is_near_edge = is_unlike(0.5 * (i % 7 - 3), 0.5 * (i / 7 - 3));
    const ShadowBias bias =
        bias_of(scene.triangles[static_cast<std::size_t>(shown)], scene, light, lamp.depth_bits);
    // What is closer to a caster than the bias, as the texels around the point see the caster.
    const auto is_free = [&](double ds, double dt) {
      const Vec3 along =
          light.right * ((s + ds) / light.focal) + light.down * ((t + dt) / light.focal) + light.forward;
      const double codes = (std::exp2(lamp.depth_bits) - 1) / (1 / light.s_min - 1 / light.s_max);
      const double inverse = 1 / (seen.z * (1 - bias.nearer)) + static_cast<double>(bias.codes) / codes;
      return !truth(lamp.light + along * (1 / inverse));
    };
    bool is_within_bias = false;
    for (int i = 0; i < 9 && !is; ++i) {
      is_within_bias = is_within_bias || is_free(0.5 * (i % 3 - 1), 0.5 * (i / 3 - 1));
    }
    if (is_near_edge) {
      ++out.near_edge;
    } else if (is_within_bias) {
      ++out.within_bias;
    } else if (!lamp.bias && in.is_off_its_plane(at, face, bias)) {
      ++out.off;
    } else {
      ++(is ? out.wrong_dark : out.wrong_lit);
    }
  }
  std::printf(
      "%zu equal, %zu near an edge, %zu nearer to a caster than the bias, %zu off their plane, "
      "%zu wrongly dark, %zu wrongly lit\n",
      out.equal, out.near_edge, out.within_bias, out.off, out.wrong_dark, out.wrong_lit);
  return out;
}

// Without what one may see through: there a pixel shows two surfaces, and a ray does not know of holes.
Scene opaque_demo(int width, int height) {
  Scene scene = demo_scene(width, height);
  std::erase_if(scene.triangles, [&](const Triangle& t) {
    if (std::ranges::any_of(t.v, [](const Vertex& v) { return v.c[3] < 1; })) return true;
    if (t.texture < 0) return false;
    const std::string& name = scene.textures[static_cast<std::size_t>(t.texture)].name;
    return name == "grille.png" || name == "glass.png";
  });
  return scene;
}

TEST(ShadowRays, TheDemoIsRightAwayFromEdges) {
  Config config = with_projector("depth16", TextureFilter::nearest);
  const Scene scene = opaque_demo(160, 120);
  ShadowOptions lamp{.light = {-12, -9, 3}, .at = Vec3{0, 3, 25}, .degrees = 60, .size = 512};
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    config.depth_code = lamp.depth_code = code;
    const Judged found = judged({config, scene, faces_of(scene), lamp});
    EXPECT_GT(found.equal, 12000U);
    EXPECT_LT(found.off + found.within_bias, 20U);
    EXPECT_EQ(found.wrong_dark, 0U);
    EXPECT_EQ(found.wrong_lit, 0U);
  }
  // The same judge finds surfaces that shade themselves.
  lamp.bias = 2;
  EXPECT_GT(judged({config, scene, faces_of(scene), lamp}).wrong_dark, 100U);
}

}  // namespace
}  // namespace bitspan
