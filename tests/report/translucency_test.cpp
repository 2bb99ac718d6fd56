// SPDX-License-Identifier: Apache-2.0
// Translucency by passes against lists of layers per pixel, in all engines and orders; and what the order of
// the source loses. [T6, H8]
#include "engine/translucency.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "golden/abuffer.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/lockstep.hpp"
#include "scene/plan.hpp"
#include "scene/random.hpp"
#include "scene/shadow.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr int side = 48;

// Triangles that cover the whole picture, each tilted its own way so that they cut each other.
Scene layers_of(std::uint64_t seed, int most) {
  Random random(seed);
  Scene scene;
  scene.name = "layers";
  scene.width = scene.height = side;
  scene.s_min = 1;
  scene.s_max = 100;
  scene.background = {30, 60, 90};
  const auto count = random.integer(1, most);
  for (std::int64_t i = 0; i < count; ++i) {
    Triangle& t = scene.triangles.emplace_back();
    const std::array<std::array<double, 2>, 3> at{{{-1, -1}, {4.0 * side, -1}, {-1, 4.0 * side}}};
    const double alpha = random.chance(0.3) ? 1 : random.uniform(0.05, 0.95);
    for (std::size_t k = 0; k < 3; ++k) {
      t.v[k].x = at[k][0];
      t.v[k].y = at[k][1];
      t.v[k].s = random.log_uniform(1.5, 90);
      t.v[k].c = {random.unit(), random.unit(), random.unit(), alpha};
    }
  }
  return scene;
}

std::vector<std::uint8_t> drawn(Engine& engine, const Scene& scene) {
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), nullptr);
  return engine.frame().color;
}

// How many pixels of a picture are those of the lists, are not, or have layers of one code.
struct Judged {
  std::size_t equal = 0, different = 0, tied = 0, deepest = 0;
};
void judge(const Config& config, const Scene& scene, const std::vector<std::uint8_t>& picture, Judged& out) {
  golden::ABuffer lists = golden::make_abuffer(config, scene);
  for (std::size_t i = 0; i < lists.pixels.size(); ++i) {
    const bool is_tied = golden::sort_layers(config, lists.pixels[i]);
    const auto expected = golden::blended(config, lists.pixels[i], scene.background);
    const bool is_equal =
        std::equal(expected.begin(), expected.end(), picture.begin() + 4 * static_cast<std::ptrdiff_t>(i));
    ++(is_tied ? out.tied : is_equal ? out.equal : out.different);
    out.deepest = std::max(out.deepest, lists.pixels[i].size());
  }
}

std::size_t passes_of(const Scene& plan) {
  return static_cast<std::size_t>(std::ranges::count_if(
      plan.commands, [](const DrawCommand& c) { return std::holds_alternative<StateChange>(c.what); }));
}

TEST(Translucency, EqualsTheListsOfLayers) {
  // 10^6 pixels in all in the long form.
  const std::uint64_t seeds = is_long_run() ? 450 : 12;
  Judged all;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Config config = shipped_config(seed % 2 == 0 ? "depth20" : "depth16");
    const Scene scene = layers_of(seed, 16);
    const auto model = make_model(config);
    const Scene plan = in_translucency_passes(scene, *model);
    judge(config, scene, drawn(*model, plan), all);
    ASSERT_EQ(all.different, 0U) << "seed " << seed;
    EXPECT_LE(passes_of(plan), scene.triangles.size() + 2) << "seed " << seed;
  }
  EXPECT_GT(all.equal, 20U * all.tied);
  EXPECT_GE(all.deepest, 12U);
  RecordProperty("tied", static_cast<int>(all.tied));
}

// With few bits of depth, layers of one code are lost, and only they.
TEST(Translucency, LosesLayersOfOneCodeAlone) {
  Config config = shipped_config("depth16");
  config.depth_bits = 8;
  Judged all;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = layers_of(seed, 12);
    const auto model = make_model(config);
    judge(config, scene, drawn(*model, in_translucency_passes(scene, *model)), all);
  }
  EXPECT_EQ(all.different, 0U);
  EXPECT_GT(all.tied, 200U);
}

TEST(Translucency, TheOrderOfTheTrianglesDoesNotMatter) {
  const Config config = shipped_config("depth20");
  Scene scene = layers_of(5, 16);
  const auto model = make_model(config);
  const std::vector<std::uint8_t> first = drawn(*model, in_translucency_passes(scene, *model));
  const std::vector<std::uint8_t> in_order = drawn(*model, scene);
  std::ranges::reverse(scene.triangles);
  EXPECT_NE(drawn(*model, scene), in_order);
  std::size_t different = 0;
  const std::vector<std::uint8_t> second = drawn(*model, in_translucency_passes(scene, *model));
  for (std::size_t i = 0; i < first.size(); ++i) different += first[i] != second[i] ? 1 : 0;
  // Where two layers have one code.
  EXPECT_LT(different, first.size() / 50);
}

TEST(Translucency, EveryEngineDrawsThePlan) {
  for (const DepthCode code :
       {DepthCode::inverse, DepthCode::opengl, DepthCode::linear, DepthCode::w_float, DepthCode::float_dz}) {
    Config config = shipped_config("depth16");
    config.depth_code = code;
    std::vector<std::unique_ptr<Engine>> engines;
    engines.push_back(make_golden(config, true));
    engines.push_back(make_model(config));
    engines.push_back(make_systemc(config));
    SystemcOptions spans;
    spans.mode = TimedMode::span;
    engines.push_back(make_systemc(config, spans));
    const Scene plan = in_translucency_passes(layers_of(7, 8), *engines[1]);
    for (const Comparison& pair : run_lock_step(engines, plan, {}).pairs) {
      EXPECT_TRUE(pair.held()) << to_string(code) << ", " << pair.other << ": " << pair.fault;
    }
    EXPECT_GT(engines[0]->counters().candidates, 1000U);
    // The truth blends what is not rounded; a layer that is lost, or in another order, shows.
    const auto ideal = make_ideal(config);
    const std::vector<std::uint8_t> truth = drawn(*ideal, plan);
    const std::vector<std::uint8_t>& picture = engines[0]->frame().color;
    std::size_t far_off = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) far_off += std::abs(truth[i] - picture[i]) > 4 ? 1 : 0;
    EXPECT_LT(far_off, truth.size() / 50) << to_string(code);
    EXPECT_EQ(ideal->counters().triangles, engines[0]->counters().triangles);
  }
}

// A triangle whose fragments all lie behind what is there takes no part in a later pass.
TEST(Translucency, OnlyFacesWithAFlagAreDrawnAgain) {
  const Config config = shipped_config("depth20");
  Scene scene = layers_of(3, 1);
  scene.triangles.resize(1);
  Triangle opaque = scene.triangles[0], behind = opaque, before = opaque;
  const auto stand = [](Triangle& t, double s, double alpha) {
    for (Vertex& v : t.v) {
      v.s = s;
      v.c[3] = alpha;
    }
  };
  stand(opaque, 50, 1);
  stand(behind, 80, 0.5);
  stand(before, 20, 0.5);
  scene.triangles = {before, behind, opaque};
  const auto model = make_model(config);
  const Scene plan = in_translucency_passes(scene, *model);
  // All three twice; then the one in front.
  ASSERT_EQ(plan.triangles.size(), 3U + 3 + 1);
  EXPECT_EQ(plan.triangles.back().v[0].s, 20);
  EXPECT_EQ(passes_of(plan), 3U);
}

TEST(Translucency, AStateInFrontHoldsInAllPasses) {
  const Config config = shipped_config("depth20");
  Scene scene = layers_of(4, 6);
  const StateChange add{.settings = {state_setting("blend.dst", BlendFactor::one)}};
  scene.commands.push_back({0, add});
  const auto model = make_model(config);
  const Scene plan = in_translucency_passes(scene, *model);
  const auto golden = make_golden(config);
  EXPECT_EQ(drawn(*model, plan), drawn(*golden, plan));
  scene.commands.clear();
  EXPECT_NE(drawn(*model, plan), drawn(*model, in_translucency_passes(scene, *model)));
}

// A map that a lamp sees stays in front of the passes. A floor, and panes from the farthest to the nearest:
// in that order a picture without passes is right.
TEST(Translucency, InTheLightOfALamp) {
  Config config = shipped_config("depth20");
  config.project = ProjectUnit::reciprocal;
  Scene scene = layers_of(6, 1);
  scene.triangles.resize(1);
  scene.focal = scene.width;
  const Triangle one = scene.triangles[0];
  scene.triangles.clear();
  for (const double s : {60.0, 50.0, 40.0, 30.0}) {
    Triangle t = one;
    t.v[0].x = t.v[0].y = t.v[1].y = t.v[2].x = 2;
    t.v[1].x = s > 50 ? 3.0 * scene.width : s + 10;
    t.v[2].y = s > 50 ? 3.0 * scene.height : s + 10;
    for (Vertex& v : t.v) {
      v.s = s;
      v.c[3] = s > 50 ? 1 : 0.5;
    }
    scene.triangles.push_back(t);
  }
  const std::vector<Face> casters = faces_of(scene);
  const Scene shaded = shadowed(scene, casters, {.light = {-20, -20, 5}, .size = 64, .bias = 2});
  ASSERT_GT(shaded.triangles.size(), scene.triangles.size());
  const auto model = make_model(config);
  const Scene plan = in_translucency_passes(shaded, *model);
  const std::vector<std::uint8_t> picture = drawn(*model, plan);
  EXPECT_EQ(picture, drawn(*make_golden(config), plan));
  EXPECT_EQ(picture, drawn(*model, shaded));
  EXPECT_NE(picture, drawn(*model, in_translucency_passes(scene, *model)));
  Scene reversed = scene;
  std::ranges::reverse(reversed.triangles);
  const Scene back = shadowed(reversed, casters, {.light = {-20, -20, 5}, .size = 64, .bias = 2});
  EXPECT_EQ(drawn(*model, in_translucency_passes(back, *model)), picture);
  EXPECT_NE(drawn(*model, back), picture);
}

TEST(Translucency, WhatHasNoPasses) {
  const Config config = shipped_config("depth16");
  const auto model = make_model(config);
  Scene scene = layers_of(2, 4);
  const std::string expected =
      "layers: translucency by passes is for a picture in one draw state; expected no triangle on its target "
      "in front of its last command, and no clear or resolve there";
  const auto refused = [&](auto what, std::size_t before) {
    scene.commands = {{before, what}};
    EXPECT_EQ(error_of([&] { in_translucency_passes(scene, *model); }), expected);
    EXPECT_NE(error_of([&] { golden::make_abuffer(config, scene); }).find("one draw state"),
              std::string::npos);
  };
  Clear clear;
  clear.depth = true;
  refused(clear, 0);
  refused(Resolve{}, 0);
  refused(StateChange{}, 1);
  refused(StateChange{}, scene.triangles.size());
  // Back on a target that has a triangle.
  scene.commands = {{1, Target{1}}, {2, Target{0}}};
  EXPECT_EQ(error_of([&] { in_translucency_passes(scene, *model); }), expected);
  // Nothing becomes nearer, so that no pass is the last one.
  scene.commands = {{0, StateChange{.settings = {state_setting("depth.write", 0)}}}};
  EXPECT_NE(error_of([&] { in_translucency_passes(scene, *model); }).find("pass 'translucent': "),
            std::string::npos);
  Scene empty = scene;
  empty.triangles.clear();
  EXPECT_TRUE(in_translucency_passes(empty, *model).triangles.empty());
}

TEST(ABuffer, CountsThePartsOfAPixelThatASurfaceCovers) {
  Config config = shipped_config("depth16");
  for (const int bits : {0, 4}) {
    config.subpixel_bits = bits;
    Scene scene = layers_of(1, 1);
    scene.triangles.resize(1);
    Triangle& t = scene.triangles[0];
    const std::array<std::array<double, 2>, 3> at{{{0, 0}, {8, 0}, {0, 8}}};
    for (std::size_t k = 0; k < 3; ++k) {
      t.v[k].x = at[k][0];
      t.v[k].y = at[k][1];
    }
    const golden::ABuffer lists = golden::make_abuffer(config, scene);
    const auto parts_at = [&](std::size_t x, std::size_t y) {
      const auto& list = lists.pixels[y * side + x];
      return list.empty() ? -1 : std::popcount(list[0].coverage);
    };
    EXPECT_EQ(parts_at(1, 2), 16);
    // x + y = 8 runs through the pixel's diagonal: its middle is on a right edge, so not inside.
    EXPECT_EQ(parts_at(4, 3), -1);
    EXPECT_EQ(parts_at(3, 3), 16);
  }
  // Half of a pixel and a quarter of one row more.
  Scene scene = layers_of(1, 1);
  scene.triangles.resize(1);
  Triangle& t = scene.triangles[0];
  const std::array<std::array<double, 2>, 3> at{{{10.25, 0}, {100, 0}, {10.25, 100}}};
  for (std::size_t k = 0; k < 3; ++k) {
    t.v[k].x = at[k][0];
    t.v[k].y = at[k][1];
  }
  config.subpixel_bits = 4;
  const golden::ABuffer lists = golden::make_abuffer(config, scene);
  ASSERT_EQ(lists.pixels[10].size(), 1U);
  EXPECT_EQ(lists.pixels[10][0].coverage, 0b1110111011101110);
}

// ---------------------------------------------------------------- the source's own order

struct Point {
  int h = 0;  // larger is nearer
  double alpha = 1;
  int v = 0;
};
constexpr int h_max = 1000;

// One pixel, as the source's flow chart has it: its faces in their order, opaque and translucent ones alike,
// in passes. None where the passes do not end.
std::optional<double> by_the_chart(const std::vector<Point>& faces) {
  int h = 0, held_h = h_max;
  double v = 0, held_alpha = 0;
  int held_v = 0;
  std::vector<bool> flag(faces.size(), true);
  for (int pass = 0; pass < 100; ++pass) {
    for (std::size_t j = 0; j < faces.size(); ++j) {
      if (!flag[j]) continue;
      flag[j] = false;
      const Point& f = faces[j];
      if (f.h <= h || f.alpha == 0) continue;
      if (f.alpha == 1) {
        h = f.h;
        v = f.v;
        if (f.h >= held_h) {
          held_h = h_max;
          held_alpha = 0;
        }
        continue;
      }
      flag[j] = true;
      if (f.h < held_h) {
        held_h = f.h;
        held_alpha = f.alpha;
        held_v = f.v;
      }
    }
    if (held_alpha != 0) {
      h = held_h;
      v = v * (1 - held_alpha) + held_v * held_alpha;
      held_alpha = 0;
      held_h = h_max;
    }
    if (std::ranges::none_of(flag, [](bool f) { return f; })) return v;
  }
  return std::nullopt;
}

double by_sorting(std::vector<Point> faces) {
  std::ranges::sort(faces, {}, &Point::h);
  double v = 0;
  for (const Point& f : faces) v = v * (1 - f.alpha) + f.v * f.alpha;
  return v;
}

// What the chart forgets where an opaque face hides the held one: another one in front, which the held one
// had displaced.
TEST(Translucency, TheOrderOfTheSourceLosesLayers) {
  const std::vector<Point> kept{{250, 0.5, 100}, {100, 0.5, 200}, {200, 1, 50}};
  EXPECT_EQ(by_sorting(kept), 75);
  EXPECT_EQ(by_the_chart(kept), 75);  // its flag is still on, so that the next pass finds it
  // Not where a nearer one is held meanwhile.
  std::vector<Point> lost = kept;
  lost.push_back({300, 0.5, 10});
  EXPECT_EQ(by_sorting(lost), 42.5);
  EXPECT_EQ(by_the_chart(lost), 30);
  Random random(1);
  std::size_t wrong = 0;
  const int pixels = 40000;
  for (int i = 0; i < pixels; ++i) {
    std::vector<Point> faces;
    std::vector<int> codes;
    for (auto n = random.integer(2, 8); n > 0; --n) {
      const auto h = static_cast<int>(random.integer(1, h_max - 1));
      if (std::ranges::find(codes, h) != codes.end()) continue;
      codes.push_back(h);
      faces.push_back(
          {h, random.chance(0.3) ? 1 : random.uniform(0.05, 0.95), static_cast<int>(random.integer(0, 255))});
    }
    const std::optional<double> v = by_the_chart(faces);
    ASSERT_TRUE(v);
    wrong += std::abs(*v - by_sorting(faces)) > 1e-9 ? 1 : 0;
  }
  EXPECT_GT(wrong, pixels / 200U);
  EXPECT_LT(wrong, pixels / 10U);
}

// A depth stands for "none", and a face may have it.
TEST(Translucency, TheFlagOfTheSourceMayNeverEnd) {
  EXPECT_EQ(by_the_chart({{h_max, 0.5, 100}}), std::nullopt);
  EXPECT_EQ(by_the_chart({{h_max - 1, 0.5, 100}}), 50);
  // Here the nearest code is a layer as any other.
  const Config config = shipped_config("depth16");
  Scene scene = layers_of(1, 1);
  scene.triangles.resize(1);
  for (Vertex& v : scene.triangles[0].v) {
    v.s = scene.s_min;
    v.c = {1, 1, 1, 0.5};
  }
  const auto model = make_model(config);
  const Scene plan = in_translucency_passes(scene, *model);
  EXPECT_EQ(passes_of(plan), 3U);
  Judged all;
  judge(config, scene, drawn(*model, plan), all);
  EXPECT_EQ(all.equal, static_cast<std::size_t>(side) * side);
  EXPECT_EQ(model->frame().depth[0], 0xffffU);
}

}  // namespace
}  // namespace bitspan
