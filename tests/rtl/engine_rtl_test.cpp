// SPDX-License-Identifier: Apache-2.0
// The engine `rtl` against the engine `model` over random triangles: every record and the frame.
#include "tb/engine_rtl.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "config/rtl_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/engine_model.hpp"
#include "scene/demo.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// The RTL repeats the first texture by itself.
using Sizes = std::array<std::pair<int, int>, 2>;
constexpr Sizes any_sizes{{{16, 8}, {20, 7}}};
// Textures that have levels.
constexpr Sizes powers_of_two{{{64, 8}, {1, 32}}};

Scene random_scene(std::uint64_t seed, int triangles, const Sizes& sizes = any_sizes) {
  Random random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Scene scene;
  scene.width = 96;
  scene.height = 64;
  scene.s_min = 2;
  scene.s_max = 500;
  for (const auto& [width, height] : sizes) {
    Texture texture{"noise", width, height, {}};
    for (int i = 0; i < width * height * 4; ++i) {
      texture.rgba.push_back(static_cast<std::uint8_t>(random() % 256));
    }
    scene.textures.push_back(texture);
  }
  scene.fog = Fog{{200, 190, 180}, 120};
  for (int i = 0; i < triangles; ++i) {
    Triangle t;
    t.texture = i % 3 - 1;
    // From a pixel to more than the screen.
    const double size = std::exp2(unit(random) * 8);
    const double x = unit(random) * scene.width;
    const double y = unit(random) * scene.height;
    for (Vertex& v : t.v) {
      v.x = x + (unit(random) - 0.5) * size;
      v.y = y + (unit(random) - 0.5) * size;
      v.s = scene.s_min * std::pow(scene.s_max / scene.s_min, unit(random));
      v.u = (unit(random) - 0.5) * 200;
      v.v = (unit(random) - 0.5) * 200;
      for (double& c : v.c) c = unit(random);
    }
    scene.triangles.push_back(t);
  }
  return scene;
}

// Returns the records.
Trace compare(const Config& config, const Scene& scene) {
  const auto model = make_model(config);
  const auto rtl = make_rtl(config, {11, 0.2, 0.3});
  Trace expected;
  Trace got;
  const std::size_t all = scene.triangles.size();
  model->begin(scene);
  draw_scene(*model, scene, 0, all, &expected);
  rtl->begin(scene);
  draw_scene(*rtl, scene, 0, all, &got);
#define BITSPAN_COMPARE(Record, LIST, stage, member)             \
  EXPECT_EQ(got.member.size(), expected.member.size()) << stage; \
  EXPECT_TRUE(got.member == expected.member) << stage;
  BITSPAN_RECORDS(BITSPAN_COMPARE)
#undef BITSPAN_COMPARE
  EXPECT_GT(expected.fragment.size(), 1000U);
  EXPECT_GT(expected.merge.size(), 100U);
  EXPECT_LT(expected.merge.size(), std::max(expected.depth.size(), expected.texture.size()));
  expect_same_frame(rtl->frame(), model->frame());
  Counters counters = rtl->counters();
  EXPECT_GT(counters.cycles, counters.fragments);
  counters.cycles = model->counters().cycles;
  EXPECT_EQ(counters, model->counters());

  // In two draws, of a new run, it is the same.
  Trace again;
  rtl->begin(scene);
  draw_scene(*rtl, scene, 0, 10, &again);
  draw_scene(*rtl, scene, 10, all - 10, &again);
  EXPECT_TRUE(again.fragment == expected.fragment);
  EXPECT_TRUE(again.merge == expected.merge);
  return expected;
}

std::uint64_t own_fields(const Config& config, const Scene& scene, RecordType type) {
  return rtl_own(config, scene).fields[static_cast<std::size_t>(type)];
}

TEST(EngineRtl, EqualsTheModel) {
  std::vector<std::pair<std::string, Perspective>> cases;
  for (const std::string& name : shipped_names) {
    for (const Perspective mode : all_perspectives) cases.emplace_back(name, mode);
  }
  for (const auto& [name, mode] : in_gate(cases)) {
    SCOPED_TRACE(name + ", " + std::string(to_string(mode)));
    Config c = shipped_config(name);
    c.perspective = mode;
    compare(c, random_scene(3, 120));
  }
}

TEST(EngineRtl, TakesTheModelsShadesWhereTheRtlHasNone) {
  for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
    Config c = shipped_config("depth16");
    c.perspective = mode;
    c.rtl.shades = false;
    compare(c, random_scene(3, 60));
  }
}

// Every second triangle is a line between two of its vertices.
Scene with_lines(Scene scene) {
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    scene.triangles[i].is_line = true;
    scene.triangles[i].v[2] = scene.triangles[i].v[1];
  }
  return scene;
}

TEST(EngineRtl, WalksLinesByTheirSlope) {
  constexpr std::array cases{Perspective::delta_f, Perspective::hyperbolic, Perspective::affine};
  for (const Perspective mode : in_gate(cases)) {
    SCOPED_TRACE(to_string(mode));
    Config c = shipped_config("narrow");
    c.perspective = mode;
    c.line_walk = LineForm::dda;
    const Scene scene = with_lines(random_scene(5, 160));
    const Trace records = compare(c, scene);
    std::size_t rising = 0, falling = 0, upright = 0;
    for (const LineWalkRecord& r : records.line_walk) {
      rising += r.k > 0 ? 1 : 0;
      falling += r.k < 0 ? 1 : 0;
      upright += r.major == 1 ? 1 : 0;
    }
    EXPECT_GT(std::min({rising, falling, upright}), 10U);
    EXPECT_EQ(own_fields(c, scene, RecordType::fragment),
              own_fields(shipped_config("narrow"), scene, RecordType::fragment) + 1);
  }
  Config c = shipped_config("narrow");
  c.line_walk = LineForm::exact;
  EXPECT_FALSE(has_rtl(c));
}

// A fog's factor per vertex, in every second triangle that of its distance.
TEST(EngineRtl, InterpolatesAChannel) {
  std::vector<std::pair<Perspective, bool>> cases;
  for (const Perspective mode : all_perspectives) {
    for (const bool shades : {true, false}) cases.emplace_back(mode, shades);
  }
  for (const auto& [mode, shades] : in_gate(cases)) {
    SCOPED_TRACE(fmt::format("{}, shades {}", to_string(mode), shades));
    Config c = shipped_config("depth16");
    c.perspective = mode;
    c.fog = FogMode::vertex;
    c.rtl.shades = shades;
    Scene scene = random_scene(8, 120);
    Random random(8);
    for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
      for (Vertex& v : scene.triangles[i].v) v.fog = std::uniform_real_distribution<double>(0, 1)(random);
    }
    EXPECT_TRUE(rtl_draws_pixels(c, scene));
    const Trace trace = compare(c, scene);
    EXPECT_EQ(trace.fragment_channel.size(), trace.fragment.size());
    EXPECT_GT(trace.fog.size(), 1000U);
    EXPECT_EQ(own_fields(c, scene, RecordType::span_channel), 4U);
    EXPECT_EQ(own_fields(c, scene, RecordType::fog), fields<FogRecord>.size() - 1);
    scene.fog.reset();
    EXPECT_TRUE(compare(c, scene).fragment_channel.empty());
  }
}

// The factor and a depth of its own beside levels of textures, first with early tests, then with late ones.
TEST(EngineRtl, TakesChannelsThroughEveryOrderOfStages) {
  Config c = level_configs()[2];
  c.fog = FogMode::vertex;
  c.depth_line = DepthLine::z;
  Scene scene = random_scene(5, 120, powers_of_two);
  Random random(8);
  for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
    for (Vertex& v : scene.triangles[i].v) v.z = std::uniform_real_distribution<double>(0, 1)(random);
  }
  const auto late = static_cast<std::int64_t>(DepthWhen::late);
  scene.commands.push_back({60, StateChange{false, {{*find_state_register("depth.when"), late}}}});
  ASSERT_TRUE(rtl_draws_pixels(c, scene));
  compare(c, scene);
}

// What the shipped configurations do not have; tests/rtl/pixel_pipe_test.cpp uses the same packages.
TEST(EngineRtl, EqualsTheModelInOtherModesOfThePixelStages) {
  Config linear = shipped_config("depth16");
  linear.filter = TextureFilter::bilinear;
  linear.depth_code = DepthCode::linear;
  linear.fog = FogMode::linear;
  Config opengl = shipped_config("depth16");
  opengl.depth_code = DepthCode::opengl;
  opengl.depth_func = DepthFunc::lequal;
  opengl.wrap = TextureWrap::clamp;
  for (const Config& c : {linear, opengl}) {
    SCOPED_TRACE(to_string(c.depth_code));
    compare(c, random_scene(5, 60));
  }
}

TEST(EngineRtl, EqualsTheModelWithLevels) {
  const auto configs = level_configs();
  for (const Config& c : in_gate(configs)) {
    SCOPED_TRACE(fmt::format("mip {}, lod {}", to_string(c.mip), to_string(c.lod)));
    const Scene scene = random_scene(5, 120, powers_of_two);
    ASSERT_TRUE(rtl_draws_pixels(c, scene));
    compare(c, scene);
  }
  // Gradients come with rows of constant depth, too.
  Config plane = level_configs()[2];
  plane.perspective = Perspective::const_depth_rows;
  plane.wrap = TextureWrap::clamp;
  compare(plane, random_scene(6, 60, powers_of_two));
}

TEST(EngineRtl, CountsItsOwnValues) {
  using enum RecordType;
  Config c = shipped_config("depth16");
  Scene scene = random_scene(3, 1);
  EXPECT_EQ(own_fields(c, scene, row), 0U);
  // All but triangle and y.
  EXPECT_EQ(own_fields(c, scene, span), fields<SpanRecord>.size() - 2);
  // All but triangle, y and covered.
  EXPECT_EQ(own_fields(c, scene, fragment), fields<FragmentRecord>.size() - 3);
  EXPECT_EQ(own_fields(c, scene, RecordType::depth), fields<DepthRecord>.size() - 1);
  EXPECT_EQ(own_fields(c, scene, RecordType::fog), fields<FogRecord>.size() - 1);
  EXPECT_EQ(own_fields(c, scene, RecordType::merge), fields<MergeRecord>.size() - 1);
  EXPECT_EQ(rtl_own(c, scene).picture, 6U);
  EXPECT_EQ(rtl_own(c, scene).counters, 3U);
  EXPECT_EQ(own_fields(c, scene, RecordType::merge_alpha), 0U);
  c.rtl.blend = RtlBlend::equation;
  EXPECT_EQ(rtl_own(c, scene).picture, 7U);
  EXPECT_EQ(own_fields(c, scene, RecordType::merge_alpha), fields<MergeAlphaRecord>.size() - 1);
  c.rtl.blend = RtlBlend::alpha;
  // Without i and j, since one texture has a size that is no power of two.
  EXPECT_EQ(own_fields(c, scene, RecordType::texture), fields<TextureRecord>.size() - 3);
  scene.textures.pop_back();
  EXPECT_EQ(own_fields(c, scene, RecordType::texture), fields<TextureRecord>.size() - 1);
  EXPECT_EQ(own_fields(c, scene, RecordType::lod), 0U);
  EXPECT_EQ(own_fields(level_configs()[1], scene, RecordType::lod), fields<LodRecord>.size() - 1);
  EXPECT_EQ(own_fields(level_configs()[1], scene, RecordType::texture), fields<TextureRecord>.size() - 1);
  c.perspective = Perspective::const_depth_rows;
  EXPECT_EQ(own_fields(c, scene, fragment), fields<FragmentRecord>.size() - 2);
  c.rtl.shades = false;
  EXPECT_EQ(own_fields(c, scene, span), fields<SpanRecord>.size() - 14);
  EXPECT_EQ(own_fields(c, scene, fragment), fields<FragmentRecord>.size() - 6);
}

void expect_modelled(const Config& config, const Scene& scene) {
  EXPECT_FALSE(rtl_draws_pixels(config, scene));
  EXPECT_EQ(own_fields(config, scene, RecordType::span), fields<SpanRecord>.size() - 2);
  for (const RecordType type :
       {RecordType::depth, RecordType::lod, RecordType::texture, RecordType::fog, RecordType::merge}) {
    EXPECT_EQ(own_fields(config, scene, type), 0U);
  }
  EXPECT_EQ(rtl_own(config, scene).picture, 0U);
  EXPECT_EQ(rtl_own(config, scene).counters, 0U);
  compare(config, scene);
}

TEST(EngineRtl, LeavesToTheModelWhatThePixelStagesDoNotTake) {
  Config iterative = shipped_config("depth16");
  iterative.perspective = Perspective::const_depth_rows;
  iterative.fog = FogMode::linear;
  iterative.pixel_reciprocal.pipelined = false;
  expect_modelled(iterative, random_scene(3, 60));

  for (const LodMode mode : {LodMode::zone_d, LodMode::finite}) {
    Config other = level_configs()[2];
    other.lod = mode;
    expect_modelled(other, random_scene(3, 60, powers_of_two));
  }

  Scene wide = random_scene(3, 60);
  Texture& texture = wide.textures.front();
  texture.width = 2 << texel_index_bits;
  texture.height = 1;
  texture.rgba.assign(std::size_t{4} * static_cast<std::size_t>(texture.width), 200);
  expect_modelled(shipped_config("depth16"), wide);
}

StateSetting setting(const char* key, std::int64_t value) { return {*find_state_register(key), value}; }

// Of the stencil test, in either way the alpha test.
void add_tests(Random& random, StateChange& change, bool& is_late) {
  const auto below = [&](std::uint64_t n) { return static_cast<std::int64_t>(random() % n); };
  if (change.reset) is_late = false;
  if (random() % 3 == 0) {
    is_late = random() % 3 != 0;
    change.settings.push_back(setting("depth.when", is_late ? 1 : 0));
    if (!is_late) change.settings.push_back(setting("stencil.test", 0));
  }
  if (random() % 2 == 0) {
    change.settings.push_back(setting("alpha.func", 1 + below(7)));
    change.settings.push_back(setting("alpha.ref", below(200)));
  }
  if (random() % 3 == 0) change.settings.push_back(setting("alpha.zero", below(2)));
  if (!is_late) return;
  if (random() % 4 != 0) change.settings.push_back(setting("stencil.test", below(4) != 0));
  for (const char* key : {"stencil.func", "stencil.back.func"}) {
    if (random() % 2 == 0) change.settings.push_back(setting(key, 1 + below(7)));
  }
  for (const char* key : {"stencil.fail", "stencil.zfail", "stencil.pass", "stencil.back.fail",
                          "stencil.back.zfail", "stencil.back.pass"}) {
    if (random() % 2 == 0) change.settings.push_back(setting(key, below(8)));
  }
  for (const char* key : {"stencil.ref", "stencil.mask", "stencil.write"}) {
    if (random() % 3 == 0) change.settings.push_back(setting(key, random() % 2 == 0 ? below(4) : below(256)));
  }
  if (random() % 2 == 0) change.settings.push_back(setting("stencil.two_sided", below(2)));
  for (const char* key : {"stencil.back.ref", "stencil.back.mask", "stencil.back.write"}) {
    if (random() % 3 == 0)
      change.settings.push_back(setting(key, random() % 2 == 0 ? below(4) - 1 : below(256)));
  }
}

// A new blend, which rtl.blend = equation has.
void blend_by_equation(Random& random, StateChange& change) {
  const auto any = [&](const char* key, std::int64_t n) {
    change.settings.push_back(
        setting(key, static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n))));
  };
  for (const char* key : {"blend.src", "blend.dst", "blend.alpha.src", "blend.alpha.dst"}) {
    if (random() % 4 != 0) any(key, 15);
  }
  for (const char* key : {"blend.op", "blend.alpha.op"}) {
    if (random() % 2 == 0) any(key, 5);
  }
  for (const char* key : {"blend.red", "blend.green", "blend.blue", "blend.alpha"}) any(key, 256);
  if (random() % 3 == 0) any("logic.op", 17);
}

// In front of every few triangles a change of what the pixel stages take. others: and, in front of some, of
// what they leave to the model, until the next reset. late: and of the tests; by_equation: and of the blend.
Scene with_draw_states(Scene scene, std::uint64_t seed, bool others, bool late = false,
                       bool by_equation = false) {
  Random random(seed);
  const auto below = [&](std::uint64_t n) { return static_cast<std::int64_t>(random() % n); };
  constexpr std::int64_t every_pixel = 0xffffffff;
  bool is_late = false;
  for (std::size_t i = 0; i < scene.triangles.size(); i += 1 + random() % 3) {
    StateChange change;
    const bool returns = random() % 3 == 0;
    change.reset = returns;
    if (random() % 2 == 0) change.settings.push_back(setting("depth.func", 1 + below(7)));
    if (random() % 2 == 0) change.settings.push_back(setting("depth.write", below(2)));
    if (random() % 2 == 0) change.settings.push_back(setting("depth.bias", below(4000) - 2000));
    if (random() % 3 == 0) change.settings.push_back(setting("color.write", below(2)));
    if (random() % 2 == 0) change.settings.push_back(setting("scissor.left", below(30)));
    if (random() % 2 == 0) change.settings.push_back(setting("scissor.bottom", 40 + below(30)));
    if (random() % 2 == 0)
      change.settings.push_back(setting("stipple", below(every_pixel) | below(every_pixel)));
    if (random() % 4 == 0) {
      change.settings.push_back(setting("blend.src", static_cast<int>(BlendFactor::one)));
      change.settings.push_back(setting("blend.dst", static_cast<int>(BlendFactor::zero)));
    }
    if (late) add_tests(random, change, is_late);
    if (by_equation && random() % 3 != 0) blend_by_equation(random, change);
    if (others && !returns && random() % 4 == 0) change.settings.push_back(setting("logic.op", below(17)));
    if (others && !returns && random() % 4 == 0)
      change.settings.push_back(setting("blend.alpha.dst", below(15)));
    if (others && !returns && random() % 4 == 0) {
      change.settings.push_back(setting("target.format", below(5)));
      change.settings.push_back(setting("target.dither", below(5)));
    }
    if (others && !returns && random() % 4 == 0) {
      change.settings.push_back(setting("chroma.test", below(3)));
      change.settings.push_back(setting("chroma.low.red", below(128)));
    }
    if (others && !returns && random() % 4 == 0) {
      change.settings.push_back(setting("texture1", below(scene.textures.size())));
      change.settings.push_back(setting("texture1.op", below(6)));
    }
    scene.commands.push_back({i, change});
    if (random() % 5 == 0) {
      Clear clear;
      clear.depth = true;
      if (late && random() % 2 == 0) clear.stencil = static_cast<std::uint8_t>(below(4));
      scene.commands.push_back({i, clear});
    }
  }
  return scene;
}

TEST(EngineRtl, DrawsInTheStatesThatThePixelStagesTake) {
  for (const char* name : {"depth16", "narrow"}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      SCOPED_TRACE(fmt::format("{}, seed {}", name, seed));
      const Config c = shipped_config(name);
      const Scene scene = with_draw_states(random_scene(seed, 120), seed, false);
      ASSERT_TRUE(rtl_draws_pixels(c, scene));
      EXPECT_EQ(own_fields(c, scene, RecordType::depth), fields<DepthRecord>.size() - 1);
      compare(c, scene);
    }
  }
}

// Both orders of tests in one scene, with alpha and stencil test: each has a chain of its own.
TEST(EngineRtl, DrawsWithLateTestsAndStencil) {
  Config linear = shipped_config("depth16");
  linear.depth_code = DepthCode::linear;
  linear.filter = TextureFilter::bilinear;
  std::uint64_t stencilled = 0;
  const std::array configs{shipped_config("depth16"), shipped_config("narrow"), linear};
  for (const Config& c : in_gate(configs)) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      SCOPED_TRACE(fmt::format("{}, seed {}", c.name, seed));
      const Scene scene = with_draw_states(random_scene(seed, 120), seed, false, true);
      ASSERT_TRUE(rtl_draws_pixels(c, scene));
      EXPECT_EQ(own_fields(c, scene, RecordType::stencil), fields<StencilRecord>.size() - 1);
      EXPECT_EQ(rtl_own(c, scene).picture, 7U);
      EXPECT_EQ(rtl_own(c, scene).counters, 4U);
      stencilled += compare(c, scene).stencil.size();
    }
  }
  EXPECT_GT(stencilled, is_gate_run() ? 4000U : 15000U);
}

TEST(EngineRtl, DrawsWithAnyBlendWhereItHasTheEquation) {
  std::size_t changed = 0;
  constexpr std::array names{"depth16", "narrow"};
  for (const char* name : in_gate(names)) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      SCOPED_TRACE(fmt::format("{}, seed {}", name, seed));
      Config c = shipped_config(name);
      const Scene scene = with_draw_states(random_scene(seed, 120), seed, false, seed == 3, true);
      EXPECT_FALSE(rtl_draws_pixels(c, scene));
      c.rtl.blend = RtlBlend::equation;
      ASSERT_TRUE(rtl_draws_pixels(c, scene));
      EXPECT_EQ(own_fields(c, scene, RecordType::merge_alpha), fields<MergeAlphaRecord>.size() - 1);
      compare(c, scene);
      const auto rtl = make_rtl(c);
      rtl->begin(scene);
      draw_scene(*rtl, scene, 0, scene.triangles.size(), nullptr);
      for (std::size_t i = 3; i < rtl->frame().color.size(); i += 4) changed += rtl->frame().color[i] != 255;
    }
  }
  EXPECT_GT(changed, is_gate_run() ? 2000U : 5000U);  // of 18,432 alphas per configuration
}

TEST(EngineRtl, DrawsInTheseStatesWithLevels) {
  constexpr std::array indices{1U, 2U};
  for (const std::size_t i : in_gate(indices)) {
    const Config c = level_configs()[i];
    const Scene scene = with_draw_states(random_scene(4, 120, powers_of_two), 4, false);
    ASSERT_TRUE(rtl_draws_pixels(c, scene));
    compare(c, scene);
    compare(c, with_draw_states(random_scene(4, 120, powers_of_two), 4, true));
    const Scene late = with_draw_states(random_scene(5, 120, powers_of_two), 5, false, true);
    ASSERT_TRUE(rtl_draws_pixels(c, late));
    compare(c, late);
  }
}

TEST(EngineRtl, LeavesOtherStatesToTheModelAndTakesTheNextAgain) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    Config c = shipped_config("depth16");
    if (seed == 3) c.rtl.blend = RtlBlend::equation;
    const Scene scene = with_draw_states(random_scene(seed, 120), seed, true, seed % 2 == 0);
    EXPECT_FALSE(rtl_draws_pixels(c, scene));
    EXPECT_EQ(own_fields(c, scene, RecordType::depth), 0U);
    compare(c, scene);
  }
}

// Two passes: what the first one draws with a view of its own is a texture of the second one.
TEST(EngineRtl, DrawsPassesWithViewsAndCopies) {
  const Scene scene = mirror_scene(96, 72);
  for (const char* name : {"depth16", "narrow"}) {
    SCOPED_TRACE(name);
    const Config c = shipped_config(name);
    ASSERT_TRUE(rtl_draws_pixels(c, scene));
    EXPECT_EQ(compare(c, scene).constants.size(), 2U);
  }
}

TEST(EngineRtl, EqualsTheModelInRandomConfigurations) {
  Random random(77);
  int drawn = 0;
  while (drawn < (is_gate_run() ? 1 : 3)) {
    const Config c = random_rtl_config(random);
    const Scene scene = random_scene(random(), 120);
    const auto model = make_model(c);
    try {
      model->begin(scene);
    } catch (const InputError&) {
      continue;  // a configuration that this scene does not fit
    }
    draw_scene(*model, scene, 0, scene.triangles.size(), nullptr);
    const Counters& counters = model->counters();
    if (counters.written <= 100 || counters.written == counters.covered)
      continue;  // a comparison of the depth
    SCOPED_TRACE(to_toml(c));
    compare(c, scene);
    ++drawn;
  }
}

}  // namespace
}  // namespace bitspan
