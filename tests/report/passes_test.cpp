// SPDX-License-Identifier: Apache-2.0
// Views, copies and plans in all engines: what a pass drew, and what a later one sees of it.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/draw_pass.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/engine_override.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/lockstep.hpp"
#include "scene/demo.hpp"
#include "scene/plan.hpp"
#include "scene/random.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using Engines = std::vector<std::unique_ptr<Engine>>;

Engines engines_of(const Config& config) {
  Engines out;
  out.push_back(make_golden(config, true));
  out.push_back(make_model(config));
  out.push_back(make_model(config, {.form = ModelForm::scalar}));
  out.push_back(make_overridden_model(config, {}));
  out.push_back(make_systemc(config));
  SystemcOptions spans;
  spans.mode = TimedMode::span;
  out.push_back(make_systemc(config, spans));
  return out;
}

// Two triangles over a whole picture at distance s, each texel on a pixel.
std::vector<Triangle> whole_picture(const View& view, double s, int texture) {
  const auto corner = [&](double x, double y) {
    Vertex v;
    v.x = x * view.width;
    v.y = y * view.height;
    v.s = s;
    v.u = v.x;
    v.v = v.y;
    return v;
  };
  std::vector<Triangle> out(2);
  out[0].v = {corner(0, 0), corner(1, 0), corner(1, 1)};
  out[1].v = {corner(0, 0), corner(1, 1), corner(0, 1)};
  for (Triangle& t : out) t.texture = texture;
  return out;
}

// The random triangles of a seed on target 1 of 64 x 32 pixels, with a view of its own, and a copy of it over
// the picture.
Scene reading_scene(std::uint64_t seed, CopyPlane plane, bool fog = true) {
  RandomOptions options;
  options.width = 64;
  options.height = 32;
  options.triangles = 24;
  options.size_max = 40;
  options.textures = 2;
  options.texture_size_max = 32;
  options.depth_ratio_max = 8;
  options.mip_chains = true;
  Scene scene = random_scene(seed, options);
  const auto texture = static_cast<int>(scene.textures.size());
  scene.textures.push_back({"copied", 64, 32, std::vector<std::uint8_t>(4 * 64 * 32, 9)});
  const std::vector<Triangle> drawn = std::exchange(scene.triangles, {});
  const View own = scene;
  scene.width = 80;
  scene.height = 48;
  const double far = 2 * own.s_max;
  scene.s_max = far;
  scene.fog.reset();
  if (fog) scene.fog = Fog{{1, 2, 3}, far};
  const Pass first{.name = "first",
                   .target = 1,
                   .view = ViewChange{.width = 64, .height = 32, .s_max = own.s_max, .fog = own.fog},
                   .triangles = drawn};
  const Pass second{
      .name = "second", .copies = {{1, plane, texture}}, .triangles = whole_picture(own, own.s_min, texture)};
  flatten(std::array{first, second}, scene);
  return scene;
}

TEST(Passes, EnginesAgree) {
  std::uint64_t texels = 0;
  for (const char* name : {"depth16", "depth20", "narrow"}) {
    for (const MipMode mip : {MipMode::none, MipMode::linear}) {
      Config config = shipped_config(name);
      config.mip = mip;
      if (mip != MipMode::none) config.lod = LodMode::gradient;
      const Engines engines = engines_of(config);
      for (const std::uint64_t seed : {1, 2}) {
        const CopyPlane plane = seed == 1 ? CopyPlane::color : CopyPlane::depth;
        const LockStepResult result = run_lock_step(engines, reading_scene(seed, plane), {});
        for (const Comparison& pair : result.pairs) {
          EXPECT_TRUE(pair.held()) << name << ", seed " << seed << ", " << pair.other << ": " << pair.fault;
          texels += pair.stages[static_cast<std::size_t>(RecordType::texture)].non_trivial;
          EXPECT_EQ(pair.stages[static_cast<std::size_t>(RecordType::constants)].records, 2U);
        }
      }
    }
  }
  EXPECT_GT(texels, 50000U);
}

// What is drawn on a target with a view of its own is the picture of a scene with that view; a copy shows it.
TEST(Passes, ByHand) {
  const Config config = shipped_config("depth16");
  Engines engines = engines_of(config);
  engines.push_back(make_ideal(config));
  for (const auto& engine : engines) {
    SCOPED_TRACE(std::string(engine->name()));
    for (const CopyPlane plane : {CopyPlane::color, CopyPlane::depth}) {
      const Scene scene = reading_scene(2, plane, false);
      engine->begin(scene);
      draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
      const Frame shown = engine->frame();
      EXPECT_EQ(shown.width, 80);
      engine->execute({0, Target{1}}, 0, nullptr);
      const Frame first = engine->frame();
      Scene alone = scene;
      static_cast<View&>(alone) = view_at(scene, 0);
      alone.commands.clear();
      alone.triangles.resize(scene.triangles.size() - 2);
      engine->begin(alone);
      draw_scene(*engine, alone, 0, alone.triangles.size(), nullptr);
      expect_same_frame(engine->frame(), first);
      if (engine->name() == "ideal") continue;
      std::size_t other = 0;
      for (std::size_t y = 0; y < 32; ++y) {
        for (std::size_t x = 0; x < 64; ++x) {
          const std::size_t from = 64 * y + x, to = 80 * y + x;
          for (std::size_t c = 0; c < 3; ++c) {
            const int expected = plane == CopyPlane::color ? first.color[4 * from + c]
                                                           : static_cast<int>(first.depth[from] >> 8);
            other += shown.color[4 * to + c] == expected ? 0 : 1;
          }
        }
      }
      EXPECT_EQ(other, 0U);
    }
  }
}

TEST(Passes, TheMirrorAgrees) {
  const Config config = shipped_config("depth16");
  const Engines engines = engines_of(config);
  const Scene scene = mirror_scene(160, 120);
  const LockStepResult result = run_lock_step(engines, scene, {});
  for (const Comparison& pair : result.pairs) EXPECT_TRUE(pair.held()) << pair.other << ": " << pair.fault;
  // The mirror's texels are those of the other picture.
  Engine& model = *engines[1];
  const std::vector<std::uint8_t> with = model.frame().color;
  Scene without = scene;
  std::erase_if(without.commands, [](const DrawCommand& c) { return std::holds_alternative<Copy>(c.what); });
  model.begin(without);
  draw_scene(model, without, 0, without.triangles.size(), nullptr);
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < with.size(); i += 4) pixels += with[i] != model.frame().color[i] ? 1 : 0;
  EXPECT_GT(pixels, 500U);
}

TEST(Passes, WhatCannotBeDone) {
  const Config config = shipped_config("depth16");
  Scene scene = reading_scene(1, CopyPlane::color);
  for (const auto& engine : engines_of(config)) {
    engine->begin(scene);
    const auto refused = [&](const Copy& copy) {
      return error_of([&] { engine->execute({0, copy}, 0, nullptr); });
    };
    const auto last = static_cast<int>(scene.textures.size()) - 1;
    EXPECT_NE(refused({1, CopyPlane::color, last}).find("copy.target: 1 has not been drawn on"),
              std::string::npos);
    EXPECT_NE(refused({0, CopyPlane::color, last}).find("has 64x32 texels, target 0 has 80x48 pixels"),
              std::string::npos);
    EXPECT_NE(refused({0, CopyPlane::color, last + 1}).find("copy.texture"), std::string::npos);
    EXPECT_NE(refused({9, CopyPlane::color, last}).find("target: 9 does not exist"), std::string::npos);
    EXPECT_NE(error_of([&] {
                engine->execute({0, ViewChange{.s_min = -1}}, 0, nullptr);
              }).find("s_min"),
              std::string::npos);
  }
  SystemcOptions ports;
  ports.memory = TimedMemory::ports;
  const auto timed = make_systemc(config, ports);
  timed->begin(scene);
  EXPECT_THROW(timed->execute({0, ViewChange{.width = 8}}, 0, nullptr), InputError);
}

// The depth test lets a pass write once; the second time writes nothing, and ends it.
TEST(Passes, OneIsRepeatedUntilItWritesNothing) {
  const Config config = shipped_config("depth16");
  Scene scene;
  scene.width = scene.height = 16;
  const auto plan = [&](DepthFunc func) {
    const StateChange state{false, {{*find_state_register("depth.func"), static_cast<std::int64_t>(func)}}};
    Pass first{.name = "first", .triangles = whole_picture(scene, 90, -1)};
    Pass again{.name = "again", .states = {state}, .triangles = whole_picture(scene, 9, -1)};
    again.repeat = Repeat{.counter = "written", .limit = 5};
    return std::vector{first, again, first};
  };
  for (const auto& engine : engines_of(config)) {
    Scene flat = scene;
    engine->begin(flat);
    flatten(plan(DepthFunc::less), flat, draw_pass(*engine));
    EXPECT_EQ(flat.triangles.size(), 2U + 2 * 2 + 2);
    const Engines engines = engines_of(config);
    for (const Comparison& pair : run_lock_step(engines, flat, {}).pairs) EXPECT_TRUE(pair.held());
    Scene endless = scene;
    engine->begin(endless);
    EXPECT_EQ(error_of([&] { flatten(plan(DepthFunc::always), endless, draw_pass(*engine)); }),
              "pass 'again': 2 triangles add to written at repetition 5; expected none by then");
  }
  EXPECT_NE(error_of([&] { flatten(plan(DepthFunc::less), scene); }).find("expected an engine"),
            std::string::npos);
}

}  // namespace
}  // namespace bitspan
