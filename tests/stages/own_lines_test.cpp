// SPDX-License-Identifier: Apache-2.0
// The channels that stand for fields of a fragment: shade_* of perspective.shades, z of depth.line, u2 and v2
// of texture.second. docs/numeric-spec.md, "Channels".
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "config/check.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "engine/drawn_scene.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "scene/plan.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"

namespace bitspan {
namespace {

using F = FormatId;

struct Drawn {
  Trace trace;
  Counters counters;
  Frame frame;
};
Drawn drawn(Engine& engine, const Scene& scene) {
  Drawn out;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &out.trace);
  out.counters = engine.counters();
  out.frame = engine.frame();
  return out;
}
Drawn by_golden(const Config& c, const Scene& scene) { return drawn(*make_golden(c, true), scene); }
Drawn by_model(const Config& c, const Scene& scene) { return drawn(*make_model(c), scene); }

Scene random_picture(std::uint64_t seed) {
  RandomOptions options;
  options.width = 60;
  options.height = 44;
  options.triangles = 60;
  options.size_max = 60;
  options.depth_ratio_max = 30;
  options.fog_probability = 0;
  Scene scene = random_scene(seed, options);
  // Two textures, and none on each second triangle.
  scene.textures.resize(1);
  scene.textures.front() = {"stripes", 4, 8, {}};
  for (int i = 0; i < 32; ++i) {
    for (const int code : {8 * i, 255 - i, 7 * i, 255}) {
      scene.textures.front().rgba.push_back(static_cast<std::uint8_t>(code));
    }
  }
  scene.textures.push_back(scene.textures.front());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) scene.triangles[i].texture = i % 2 == 0 ? 0 : -1;
  return scene;
}

// The value of a channel of a fragment.
double channel(const Config& c, const Trace& t, std::size_t fragment, LineId line) {
  const std::size_t in_use = t.fragment_channel.size() / t.fragment.size();
  for (std::size_t i = fragment * in_use; i < (fragment + 1) * in_use; ++i) {
    const FragmentChannelRecord& r = t.fragment_channel[i];
    if (channel_line(r.channel) != line) continue;
    return decoded(r.w, c.format(line_of(line, c.perspective).row.kept));
  }
  ADD_FAILURE() << "no channel " << line_of(line, c.perspective).name;
  return 0;
}

std::vector<Config> dividing() {
  std::vector<Config> out;
  for (const Perspective p : {Perspective::delta_f, Perspective::hyperbolic}) {
    for (const RowSlope row : {RowSlope::divide, RowSlope::reciprocal, RowSlope::plane}) {
      Config c = shipped_config("depth20");
      c.perspective = p;
      c.row_slope = row;
      c.name = std::string(to_string(p)) + " " + std::string(to_string(row));
      out.push_back(c);
    }
  }
  return out;
}

TEST(OwnLines, ADepthThatNoVertexGivesIsThatOfTheDistance) {
  const Scene scene = random_picture(3);
  for (const Perspective p : all_perspectives) {
    if (has_plane_rows(p)) continue;  // there h is one value per row, and z is a line along it
    for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
      Config c = shipped_config("depth20");
      c.perspective = p;
      c.depth_code = code;
      const Drawn by_h = by_model(c, scene);
      c.depth_line = DepthLine::z;
      for (const Drawn& by_z : {by_golden(c, scene), by_model(c, scene)}) {
        ASSERT_GT(by_z.trace.depth.size(), 900U);
        EXPECT_TRUE(std::ranges::equal(by_z.trace.depth, by_h.trace.depth)) << to_string(p);
        EXPECT_EQ(by_z.frame.color, by_h.frame.color);
        for (std::size_t i = 0; i < by_z.trace.fragment.size(); ++i) {
          ASSERT_EQ(by_z.trace.fragment_channel[i].w, by_z.trace.fragment[i].h);
        }
      }
    }
  }
}

TEST(OwnLines, AGivenDepthIsLinearOnTheScreen) {
  Scene scene = worked_scene();
  Triangle t = triangle(vertex(0, 0, 1), vertex(32, 0, 2), vertex(0, 32, 1.25));
  t.v[0].z = 0.25;
  t.v[1].z = 0.75;
  t.v[2].z = 0.5;
  scene.triangles = {t};
  for (const Perspective p : all_perspectives) {
    for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
      Config c = shipped_config("depth16");
      c.perspective = p;
      c.depth_code = code;
      c.depth_line = DepthLine::z;
      for (const Drawn& d : {by_golden(c, scene), by_model(c, scene)}) {
        ASSERT_GT(d.trace.depth.size(), 400U);
        for (const DepthRecord& r : d.trace.depth) {
          const double x = static_cast<double>(r.x) + 0.5, y = static_cast<double>(r.y) + 0.5;
          const double z = 0.25 + x / 64 + y / 128;
          const double code_of = 65535 * (code == DepthCode::inverse ? 1 - z : z);
          ASSERT_NEAR(static_cast<double>(r.z), code_of, 1) << to_string(p) << " " << r.x << " " << r.y;
        }
      }
    }
  }
}

TEST(OwnLines, TheEndsOfADepthAreTheEndsOfTheCodes) {
  Config c = shipped_config("depth16");
  c.depth_line = DepthLine::z;
  for (const double z : {0.0, 1.0, 4.9406564584124654e-324, 0.99999999999999989}) {
    Scene scene = worked_scene();
    Triangle t = triangle(vertex(0, 0, 1), vertex(16, 0, 2), vertex(0, 16, 1.5));
    for (Vertex& v : t.v) v.z = z;
    scene.triangles = {t};
    const std::int64_t code = z < 0.5 ? 65535 : 0;
    for (const Drawn& d : {by_golden(c, scene), by_model(c, scene)}) {
      ASSERT_GT(d.trace.depth.size(), 50U);
      for (const DepthRecord& r : d.trace.depth) ASSERT_EQ(r.z, code) << z;
    }
  }
}

// The truth of ideal, in space. On the screen the same colours are somewhere else.
TEST(OwnLines, ShadesAreLinearInSpace) {
  const Scene scene = random_picture(5);
  for (Config c : dividing()) {
    c.shade_lines = ShadeLines::perspective;
    Config linear = c;
    linear.shade_lines = ShadeLines::linear;
    for (const Drawn& d : {by_golden(c, scene), by_model(c, scene)}) {
      double most = 0, apart = 0;
      std::size_t texels = 0;
      for (std::size_t i = 0; i < d.trace.fragment.size(); ++i) {
        const FragmentRecord& f = d.trace.fragment[i];
        const auto t = ideal_triangle(c, scene.triangles[static_cast<std::size_t>(f.triangle)]);
        const IdealFragment truth = ideal_at(c, scene, *t, f.x, f.y);
        const IdealFragment on_screen = ideal_at(linear, scene, *t, f.x, f.y);
        for (int k = 0; k < 4; ++k) {
          const auto at = static_cast<std::size_t>(k);
          const auto line = static_cast<LineId>(static_cast<int>(LineId::shade_r) + k);
          most = std::max(most, std::abs(channel(c, d.trace, i, line) - truth.point.shade[at]));
          apart = std::max(apart, std::abs(truth.point.shade[at] - on_screen.point.shade[at]));
        }
      }
      EXPECT_LT(most, 1.0 / 512) << c.name;
      EXPECT_GT(apart, 0.1) << c.name;
      for (const TextureRecord& r : d.trace.texture) {
        const auto t = ideal_triangle(c, scene.triangles[static_cast<std::size_t>(r.triangle)]);
        if (t->texture >= 0 || r.killed != 0) continue;
        const IdealFragment truth = ideal_at(c, scene, *t, r.x, r.y);
        ASSERT_NEAR(decoded(r.g, c.format(F::texture_color)), truth.color[1], 1) << c.name;
        ++texels;
      }
      EXPECT_GT(texels, 300U);
    }
  }
}

// At a vertex of one colour the quotient is that colour: white stays white, and nothing becomes transparent.
TEST(OwnLines, OneColourStaysWhatItIs) {
  Scene scene = random_picture(6);
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.c = {1, 0.5, 0, 1};
  }
  for (Config c : dividing()) {
    c.shade_lines = ShadeLines::perspective;
    const Drawn d = by_model(c, scene);
    for (std::size_t i = 0; i < d.trace.fragment.size(); ++i) {
      ASSERT_NEAR(channel(c, d.trace, i, LineId::shade_r), 1, 1.0 / 4096) << c.name;
      ASSERT_NEAR(channel(c, d.trace, i, LineId::shade_g), 0.5, 1.0 / 4096) << c.name;
      ASSERT_EQ(channel(c, d.trace, i, LineId::shade_b), 0) << c.name;
    }
  }
}

TEST(OwnLines, SecondCoordinatesAreThoseOfTheirOwn) {
  Scene scene = random_picture(8);
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) {
      v.u2 = 3 + 0.25 * v.v;
      v.v2 = -v.u;
    }
  }
  scene.commands = {{0, StateChange{.settings = {state_setting("texture1", 1)}}}};
  for (Config c : dividing()) {
    const Drawn first = by_model(c, scene);
    c.second_coordinates = SecondCoordinates::own;
    for (const Drawn& d : {by_golden(c, scene), by_model(c, scene)}) {
      double most = 0;
      for (std::size_t i = 0; i < d.trace.fragment.size(); ++i) {
        const FragmentRecord& f = d.trace.fragment[i];
        const auto t = ideal_triangle(c, scene.triangles[static_cast<std::size_t>(f.triangle)]);
        const IdealPoint p = ideal_at(c, scene, *t, f.x, f.y).point;
        most = std::max({most, std::abs(channel(c, d.trace, i, LineId::u2) - p.u2),
                         std::abs(channel(c, d.trace, i, LineId::v2) - p.v2)});
      }
      EXPECT_LT(most, 0.25) << c.name;
      // The first unit has its own coordinates still, and what is seen is where it was.
      EXPECT_EQ(d.frame.depth, first.frame.depth);
      EXPECT_TRUE(std::ranges::equal(d.trace.texture, first.trace.texture));
      ASSERT_EQ(d.trace.texture_second.size(), first.trace.texture_second.size());
      std::size_t elsewhere = 0;
      for (std::size_t i = 0; i < d.trace.texture_second.size(); ++i) {
        elsewhere += d.trace.texture_second[i].i != first.trace.texture_second[i].i ? 1 : 0;
      }
      EXPECT_GT(2 * elsewhere, d.trace.texture_second.size());
    }
  }
}

// One division more per divided channel, where the mode divides.
TEST(OwnLines, DividesCountPerChannel) {
  const Scene scene = random_picture(9);
  for (Config c : dividing()) {
    const std::uint64_t before = by_model(c, scene).counters.divides_pixel;
    c.shade_lines = ShadeLines::perspective;
    c.second_coordinates = SecondCoordinates::own;
    const Drawn golden = by_golden(c, scene);
    const Drawn model = by_model(c, scene);
    const std::uint64_t more = has_pixel_quotients(c.perspective) ? 6 * model.trace.fragment.size() : 0;
    EXPECT_EQ(model.counters.divides_pixel, before + more);
    EXPECT_TRUE(golden.counters == model.counters);
  }
}

TEST(OwnLines, ModesWithoutAQuotientPerPixelRefuse) {
  const auto refused = [](auto change) {
    Config c = shipped_config("depth16");
    change(c);
    const auto v = first_violation(c);
    return v ? v->key + ": " + v->text : "";
  };
  const std::string why =
      ", and needs a quotient per pixel; legal: another value, or perspective.mode = delta_f, hyperbolic "
      "without "
      "subspan_bits";
  const auto shades = [](Config& c) { c.shade_lines = ShadeLines::perspective; };
  const auto second = [](Config& c) { c.second_coordinates = SecondCoordinates::own; };
  for (const Perspective p : {Perspective::affine, Perspective::const_depth_rows}) {
    EXPECT_EQ(refused([&](Config& c) {
                c.perspective = p;
                shades(c);
              }),
              "perspective.shades: is perspective" + why);
    EXPECT_EQ(refused([&](Config& c) {
                c.perspective = p;
                second(c);
              }),
              "texture.second: is own" + why);
  }
  EXPECT_EQ(refused([&](Config& c) {
              c.subspan_bits = 3;
              shades(c);
            }),
            "perspective.shades: is perspective" + why);
  for (const DepthCode code : {DepthCode::linear, DepthCode::w_float, DepthCode::float_dz}) {
    EXPECT_EQ(refused([&](Config& c) {
                c.depth_code = code;
                c.depth_line = DepthLine::z;
              }),
              "depth.line: is z, and the code takes h + B; legal: h, or depth.code = inverse, opengl");
  }
}

}  // namespace
}  // namespace bitspan
