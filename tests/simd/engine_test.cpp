// SPDX-License-Identifier: Apache-2.0
// The vector and specialised forms of the engine against the scalar one: frames, counters, records and
// statistics, on every target and with several threads.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "model/engine_model.hpp"
#include "model/simd/engine_vector.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/shipped.hpp"
#include "model/simd/targets.hpp"
#include "report/random_config.hpp"
#include "report/suites.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan::model {
namespace {

constexpr VectorTarget targets[] = {VectorTarget::avx512, VectorTarget::avx2, VectorTarget::baseline};

void expect_same(const Engine& got, const Engine& expected, const std::string& where) {
  const Frame& a = got.frame();
  const Frame& b = expected.frame();
  EXPECT_EQ(a.color, b.color) << where;
  EXPECT_EQ(a.depth, b.depth) << where;
  EXPECT_EQ(a.stencil, b.stencil) << where;
  if (!a.u.empty()) {
    EXPECT_EQ(a.triangle, b.triangle) << where;
    EXPECT_TRUE(same_bits(a.u, b.u)) << where;
    EXPECT_TRUE(same_bits(a.v, b.v)) << where;
  }
  EXPECT_EQ(got.counters(), expected.counters()) << where;
}

std::unique_ptr<Engine> drawn(const Config& config, const Scene& scene, const ModelOptions& options,
                              std::size_t at_once) {
  std::unique_ptr<Engine> engine = make_model(config, options);
  engine->begin(scene);
  for (std::size_t i = 0; i < scene.triangles.size(); i += at_once) {
    const std::size_t n = std::min(at_once, scene.triangles.size() - i);
    draw_scene(*engine, scene, i, n, nullptr);
  }
  return engine;
}

// Every form against the scalar one. Returns the fragments that were written, 0 where the scene does not fit.
std::uint64_t compare_forms(const Config& config, const Scene& scene, const std::string& name) {
  std::unique_ptr<Engine> scalar;
  try {
    scalar = drawn(config, scene, {.form = ModelForm::scalar}, scene.triangles.size());
  } catch (const InputError&) {
    return 0;
  }
  for (const VectorTarget target : targets) {
    if (!supported(target)) continue;
    for (const ModelForm form : {ModelForm::vector, ModelForm::specialised}) {
      if (form == ModelForm::specialised && !shipped_index(config).any()) continue;
      for (const int threads : {1, 3}) {
        const ModelOptions options{.form = form, .target = target, .threads = threads};
        const std::string where = name + ", target " + std::to_string(static_cast<int>(target)) + ", form " +
                                  std::to_string(static_cast<int>(form)) + ", threads " +
                                  std::to_string(threads);
        expect_same(*drawn(config, scene, options, threads == 1 ? scene.triangles.size() : 7), *scalar,
                    where);
      }
    }
    ModelOptions bare{.form = ModelForm::vector, .target = target};
    bare.winners = false;
    const std::unique_ptr<Engine> picture = drawn(config, scene, bare, scene.triangles.size());
    EXPECT_TRUE(picture->frame().u.empty());
    expect_same(*picture, *scalar, name + ", picture alone");
  }
  return scalar->counters().written;
}

RandomOptions small_scenes() {
  RandomOptions o;
  o.width = 150;
  o.height = 110;
  o.triangles = 40;
  o.size_max = 200;
  return o;
}

TEST(Forms, ShippedConfigurationsInEveryMode) {
  std::uint64_t written = 0;
  std::uint64_t seed = 10;
  for (const Config& base : shipped_configs()) {
    compare_forms(base, demo_scene(160, 120), base.name + ", demo");
    for (const Perspective perspective : {Perspective::delta_f, Perspective::hyperbolic, Perspective::affine,
                                          Perspective::const_depth_rows}) {
      for (const DepthCode code : {DepthCode::inverse, DepthCode::linear, DepthCode::opengl}) {
        for (const FogMode fog : {FogMode::table, FogMode::linear}) {
          Config c = base;
          c.perspective = perspective;
          c.depth_code = code;
          c.fog = fog;
          ++seed;
          written += compare_forms(c, random_scene(seed, small_scenes()),
                                   base.name + ", seed " + std::to_string(seed));
        }
      }
    }
  }
  EXPECT_GT(written, 100000U);
}

TEST(Forms, RandomConfigurations) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t written = 0;
  int drawn_scenes = 0;
  for (std::uint64_t seed = 1; seed <= 160; ++seed) {
    const Config config = random_config(seed, bases);
    const std::uint64_t n = vector_refusal(config) != nullptr
                                ? 0
                                : compare_forms(config, random_scene(seed, small_scenes()),
                                                "configuration and scene of seed " + std::to_string(seed));
    written += n;
    drawn_scenes += n != 0 ? 1 : 0;
  }
  EXPECT_GT(drawn_scenes, 30);
  EXPECT_GT(written, 100000U);
}

RandomOptions scenes_of_states() {
  RandomOptions o = small_scenes();
  o.command_probability = 0.3;
  o.mip_chains = true;
  return o;
}

// The first state keeps an alpha that another one wrote: behind a clear of alpha to 255, and on a target that
// was taken in that other state.
TEST(Forms, AlphasOutliveTheStateThatWroteThem) {
  const Config config = shipped_config("depth16");
  RandomOptions options = small_scenes();
  options.triangles = 30;
  Scene scene = random_scene(8, options);
  const StateSetting writes_alpha{*find_state_register("blend.alpha.dst"),
                                  static_cast<std::int64_t>(BlendFactor::zero)};
  Clear opaque;
  opaque.alpha = 255;
  const std::vector<DrawCommand> between{{5, opaque}, {5, Target{2}}};
  for (const DrawCommand& command : between) {
    scene.commands = {
        {0, StateChange{false, {writes_alpha}}}, command, {20, StateChange{.reset = true, .settings = {}}}};
    compare_forms(config, scene, std::holds_alternative<Target>(command.what) ? "target" : "clear");
  }
}

// Every draw state in one stream.
TEST(Forms, RandomDrawStates) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t written = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    RandomOptions options = scenes_of_states();
    options.second_texture = seed % 2 == 0;
    const Config config = seed % 2 == 0 ? random_config(seed, bases) : bases[seed / 2 % bases.size()];
    if (vector_refusal(config) != nullptr) continue;
    written += compare_forms(config, random_scene(seed, options), "states of seed " + std::to_string(seed));
    if (HasFailure()) return;
  }
  EXPECT_GT(written, 100000U);
}

// The named suites, whose features are draw states for the most part.
TEST(Forms, NamedSuites) {
  std::uint64_t written = 0;
  for (const std::string& name : matching_suites("*/delta_f/32x24")) {
    const SuiteCase suite = make_suite(name, 0, 0);
    if (vector_refusal(suite.config) == nullptr) written += compare_forms(suite.config, suite.scene, name);
    if (HasFailure()) return;
  }
  EXPECT_GT(written, 20000U);
}

// Textures with levels, by every way to find them, in the first state and in others.
TEST(Forms, Levels) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t written = 0;
  std::uint64_t seed = 500;
  for (const Config& base : bases) {
    for (const LodMode lod :
         {LodMode::none, LodMode::zone_s, LodMode::zone_d, LodMode::gradient, LodMode::finite}) {
      for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
        for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
          ++seed;
          Config c = base;
          c.lod = lod;
          c.mip = mip;
          c.filter = filter;
          c.lod_bias = static_cast<int>(seed % 33) - 16;
          c.wrap = static_cast<TextureWrap>(seed / 2 % 4);
          RandomOptions options = scenes_of_states();
          options.texture_size_max = 16;
          if (seed % 2 == 0) options.command_probability = 0;
          written += compare_forms(c, random_scene(seed, options),
                                   base.name + ", levels, seed " + std::to_string(seed));
          if (HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(written, 100000U);
}

// What a plain pipeline has not, beside levels.
TEST(Forms, DistancesAndDz) {
  std::uint64_t written = 0;
  std::uint64_t seed = 700;
  for (const Config& base : shipped_configs()) {
    for (const FogMode fog : {FogMode::table, FogMode::distance, FogMode::log, FogMode::vertex}) {
      for (const DepthCode code : {DepthCode::inverse, DepthCode::float_dz}) {
        for (const double commands : {0.0, 0.3}) {
          ++seed;
          Config c = base;
          c.fog = fog;
          c.depth_code = code;
          RandomOptions options = small_scenes();
          options.command_probability = commands;
          options.fog_probability = 1;
          written +=
              compare_forms(c, random_scene(seed, options), base.name + ", seed " + std::to_string(seed));
          if (HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(written, 50000U);
}

// Derivatives from those that 64-bit lanes hold to those that no lanes do.
TEST(Forms, LevelsOfRandomConfigurations) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t written = 0;
  for (std::uint64_t seed = 1; seed <= 450; ++seed) {
    Config c = random_config(seed, bases);
    c.mip = seed % 3 == 0 ? MipMode::nearest : MipMode::linear;
    c.lod = LodMode::gradient;
    try {
      check_config(c, "levels");
    } catch (const InputError&) {
      continue;
    }
    if (vector_refusal(c) != nullptr) continue;
    written += compare_forms(c, random_scene(seed, scenes_of_states()), "seed " + std::to_string(seed));
    if (HasFailure()) return;
  }
  EXPECT_GT(written, 100000U);
}

// Every function of the second unit, over triangles with and without a texture of their own; with levels the
// two textures have different ones.
TEST(Forms, TheSecondTexture) {
  std::uint64_t written = 0;
  std::uint64_t seed = 800;
  const auto set = [](const char* key, std::int64_t value) {
    return StateSetting{*find_state_register(key), value};
  };
  for (const Config& base : shipped_configs()) {
    for (const LodMode lod : {LodMode::none, LodMode::zone_s, LodMode::gradient}) {
      for (const MipMode mip : {MipMode::none, MipMode::nearest, MipMode::linear}) {
        for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
          if (has_mip_chain(mip) != (lod != LodMode::none)) continue;
          Config c = base;
          c.lod = lod;
          c.mip = mip;
          c.filter = filter;
          c.transparent = {255, 0, 255};
          RandomOptions options = scenes_of_states();
          options.command_probability = 0;
          Scene scene = random_scene(++seed, options);
          while (scene.textures.size() < 2) scene = random_scene(++seed, options);
          for (std::size_t i = 0; i < scene.triangles.size(); i += 2) {
            const auto n = static_cast<std::int64_t>(i);
            scene.commands.push_back(
                {i, StateChange{
                        false,
                        {set("texture1",
                             i % 16 == 14 ? -1 : n / 2 % static_cast<std::int64_t>(scene.textures.size())),
                         set("texture1.op", n / 2 % 6), set("texture1.scale", n / 6 % 3),
                         set("texture1.red", 7 * n % 256), set("texture1.blue", 200),
                         set("alpha.func", i % 10 == 0 ? 6 : 7), set("alpha.ref", 100)}}});
          }
          written += compare_forms(c, scene, base.name + ", second texture, seed " + std::to_string(seed));
          EXPECT_TRUE(holds_second_texture(c, lanes_for_shading(c, c.fog)));
          if (HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(written, 100000U);
}

// Compares the forms on scenes of random draw states, in random configurations. ask(random, seed, config):
// what of the pipeline is on; put(random, seed, config, scene): what the scene has for it. Lanes hold many of
// them. Returns in how many of these lanes form a brightness per pixel.
template <class Ask, class Put>
int compare_with(const std::string& what, Ask ask, Put put) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t written = 0;
  int in_lanes = 0, brightened = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    Random random(seed);
    Config c = seed % 2 == 0 ? random_config(seed, bases) : bases[seed / 2 % bases.size()];
    ask(random, seed, c);
    if (first_violation(c) || vector_refusal(c) != nullptr) continue;
    RandomOptions options = scenes_of_states();
    options.second_texture = has_project(c.project) || random.chance(0.5);
    options.command_probability = random.chance(0.5) ? 0.2 : 0;
    Scene scene = random_scene(seed, options);
    put(random, seed, c, scene);
    written += compare_forms(c, scene, what + " of seed " + std::to_string(seed));
    if (testing::Test::HasFailure()) return 0;
    const Pipeline pipeline = make_pipeline(c, scene);
    const ShadePlan plan = prepare_shade(pipeline, c, scene);
    in_lanes += holds_state(plan, pipeline) ? 1 : 0;
    brightened += pipeline.light.is_on && pipeline.light.at_pixels && holds_state(plan, pipeline) &&
                          plan.holds_brightness
                      ? 1
                      : 0;
  }
  EXPECT_GT(written, 100000U);
  EXPECT_GT(in_lanes, 50);
  return brightened;
}

// What the draw states of a projected texture and channels make of a scene: slides and shadow maps, of
// colours and of depth codes, through every rounding, level and filter; vertex fog as a channel beside them.
TEST(Forms, Projections) {
  const auto ask = [](Random& random, std::uint64_t seed, Config& c) {
    c.project = ProjectUnit::reciprocal;
    c.filter = random.chance(0.5) ? TextureFilter::bilinear : TextureFilter::nearest;
    if (random.chance(0.3)) c.fog = FogMode::vertex;
    if (seed % 3 == 0) {
      c.lod = LodMode::gradient;
      c.mip = random.chance(0.5) ? MipMode::linear : MipMode::nearest;
    }
  };
  const auto put = [](Random& random, std::uint64_t seed, const Config& /*c*/, Scene& scene) {
    if (random.chance(0.3)) draw_pass(random, scene);
    draw_projection(random, scene);
    for (Texture& texture : scene.textures) {
      if (seed % 4 == 0) break;
      texture.format = TexelFormat::depth;
      texture.rgba.clear();
      texture.raw.resize(raw_size(texture.format, texture.width, texture.height));
      for (std::uint8_t& byte : texture.raw) byte = static_cast<std::uint8_t>(random.integer(0, 255));
    }
  };
  EXPECT_EQ(compare_with("projections", ask, put), 0);
}

// Levels of textures, in some configurations.
void draw_levels(Random& random, Config& c) {
  if (!random.chance(0.3)) return;
  c.lod = LodMode::gradient;
  c.mip = random.chance(0.5) ? MipMode::linear : MipMode::nearest;
}
void put_light(Random& random, std::uint64_t /*seed*/, const Config& c, Scene& scene) {
  if (has_project(c.project)) draw_projection(random, scene);
  draw_light(random, scene, light_taken(c));
}

// A light at faces, vertices and pixels, parallel and at points, beside levels, a second texture and a
// projector.
TEST(Forms, Lights) {
  const auto ask = [](Random& random, std::uint64_t seed, Config& c) {
    c.light = std::array{LightAt::face, LightAt::vertex, LightAt::pixel}[seed % 3];
    c.light_source = random.chance(0.5) ? LightSource::point : LightSource::parallel;
    // The square of a normal's length is beyond 64 bits, or more is.
    if (seed % 5 == 0) {
      const int word = std::array{34, 38, 50}[seed / 5 % 3];
      c.format(FormatId::normal_value) = {word, 4, true, Rounding::rnd, Overflow::sat, false};
    }
    // The exponent of a length reaches far down.
    if (seed % 7 == 0) {
      c.format(FormatId::light_position) = {31, 3, true, Rounding::trn, Overflow::sat, false};
      c.format(FormatId::light_direction) = {28, 2, true, Rounding::rnd_conv, Overflow::sat, false};
    }
    if (random.chance(0.3)) c.project = ProjectUnit::reciprocal;
    draw_levels(random, c);
  };
  // Some have registers or a root's unit of more bits, which lanes leave to the scalar stage.
  EXPECT_GT(compare_with("lights", ask, put_light), 15);
}

// Maps of normals and shadows of a light, among states without: with coordinates of their own, levels, a
// projector and a fall.
TEST(Forms, Reliefs) {
  const auto ask = [](Random& random, std::uint64_t seed, Config& c) {
    c.light = LightAt::pixel;
    c.light_source = LightSource::point;
    if (seed % 4 != 0) c.light_normal = LightNormal::map;
    if (seed % 4 != 1) c.light_shadow = LightShadow::map;
    c.second_coordinates = random.chance(0.5) ? SecondCoordinates::own : SecondCoordinates::first;
    if (random.chance(0.5)) c.light_fall = LightFall::second;
    if (seed % 5 == 0) c.project = ProjectUnit::reciprocal;
    draw_levels(random, c);
  };
  EXPECT_GT(compare_with("reliefs", ask, put_light), 15);
}

// Opaque triangles over one another, with translucent ones between them: a pixel is shaded once for
// those that hide each other, and counted each time. Every comparison of depths has the last one stay.
TEST(Forms, WhatIsHiddenIsCounted) {
  std::uint64_t written = 0, pixels = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Config c = shipped_config(seed % 2 == 0 ? "depth16" : "depth20");
    c.light = LightAt::pixel;
    c.project = ProjectUnit::reciprocal;
    if (seed % 3 == 0) {
      c.mip = MipMode::linear;
      c.lod = LodMode::gradient;
    }
    c.depth_func =
        std::array{DepthFunc::less, DepthFunc::lequal, DepthFunc::notequal, DepthFunc::always}[seed / 2 % 4];
    RandomOptions options = small_scenes();
    options.triangles = 60;
    options.size_min = 40;
    options.mip_chains = true;
    options.translucent_probability = seed % 4 == 0 ? 0.1 : 0;
    Scene scene = random_scene(seed, options);
    Random random(seed);
    scene.textures.resize(3);
    for (Texture& texture : scene.textures) {
      texture = {};
      texture.width = texture.height = 16;
      for (int i = 0; i < 4 * 16 * 16; ++i) {
        texture.rgba.push_back(i % 4 == 3 ? 255 : static_cast<std::uint8_t>(random.integer(1, 255)));
      }
    }
    scene.commands = {{0, StateChange{false, {{*find_state_register("texture1"), 0}}}},
                      {40, StateChange{true, {}}},
                      {50, StateChange{false, {{*find_state_register("depth.bias"), 2}}}}};
    put_light(random, seed, c, scene);
    written += compare_forms(c, scene, "seed " + std::to_string(seed));
    pixels += static_cast<std::uint64_t>(scene.width * scene.height);
    if (HasFailure()) return;
  }
  EXPECT_GT(written, pixels);
}

// A second scene with other textures has levels of its own.
TEST(Forms, LevelsOfTheNextScene) {
  Config c = shipped_config("depth16");
  c.mip = MipMode::linear;
  c.lod = LodMode::gradient;
  RandomOptions options = scenes_of_states();
  options.command_probability = 0;
  const Scene scene = random_scene(1, options);
  Scene second = scene;
  for (Texture& texture : second.textures) {
    for (std::uint8_t& code : texture.rgba) code = static_cast<std::uint8_t>(255 - code);
  }
  const std::unique_ptr<Engine> engine = make_model(c);
  for (const Scene* each : {&scene, static_cast<const Scene*>(&second)}) {
    engine->begin(*each);
    engine->draw(each->triangles, 0, nullptr);
  }
  expect_same(*engine, *drawn(c, second, {.form = ModelForm::scalar}, second.triangles.size()),
              "second scene");
}

TEST(Forms, SplitsOfTheFogTable) {
  std::uint64_t seed = 300;
  for (const Config& base : shipped_configs()) {
    for (const auto& [depth_bits, zone_bits] : {std::pair(7, 3), {8, 2}, {5, 5}, {12, 0}, {1, 8}}) {
      Config c = base;
      c.fog_depth_bits = depth_bits;
      c.fog_zone_bits = zone_bits;
      compare_forms(c, demo_scene(160, 120),
                    base.name + ", " + std::to_string(depth_bits) + " + " + std::to_string(zone_bits));
      ++seed;
      compare_forms(c, random_scene(seed, small_scenes()), base.name + ", seed " + std::to_string(seed));
    }
  }
}

// Depth codes that fill all 32 bits of the buffer, where signed and unsigned order differ.
TEST(Forms, WidestDepthBuffer) {
  for (const DepthCode code : {DepthCode::inverse, DepthCode::opengl}) {
    Config c = shipped_config("depth20");
    c.depth_bits = 32;
    c.depth_code = code;
    for (const FormatId id : {FormatId::setup_h, FormatId::setup_b, FormatId::edge_h, FormatId::edge_h_acc,
                              FormatId::edge_h_step, FormatId::span_h, FormatId::span_h_step}) {
      Format& f = c.format(id);
      f.integer += 12;
      f.word = std::min(f.word + 4, 60);
    }
    check_config(c, "32 bits of depth");
    EXPECT_GT(compare_forms(c, random_scene(5, small_scenes()), "32 bits of depth"), 0U);
  }
}

// u, v and shades whose accumulators are wider than 64 bits on their grids.
TEST(Forms, AccumulatorsWiderThanLanesOnTheGridOfTheResult) {
  for (const Perspective perspective : {Perspective::affine, Perspective::delta_f}) {
    Config c = shipped_config("depth16");
    c.perspective = perspective;
    c.start_offset = {};
    for (const Overflow overflow : {Overflow::sat, Overflow::wrap}) {
      for (const FormatId id : {FormatId::span_uv, FormatId::span_shade}) {
        if (id == FormatId::span_uv && perspective == Perspective::delta_f) continue;  // bounded by the rules
        Config wide = c;
        Format& f = wide.format(id);
        f = {.word = 64, .integer = 0, .is_signed = true, .rounding = f.rounding, .overflow = overflow};
        check_config(wide, "wide");
        EXPECT_GT(compare_forms(wide, random_scene(5, small_scenes()), "wide"), 0U);
      }
    }
  }
}

// Statistics and records of the vector form, register by register, record by record.
TEST(Forms, StatisticsAndRecords) {
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t values = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Config config = seed <= 3 ? bases[seed - 1] : random_config(seed, bases);
    const Scene scene = random_scene(seed, small_scenes());
    if (vector_refusal(config) != nullptr) continue;
    const std::unique_ptr<ObservedEngine> scalar = make_observed_model(config, ModelForm::scalar);
    Trace expected;
    try {
      scalar->begin(scene);
    } catch (const InputError&) {
      continue;
    }
    scalar->draw(scene.triangles, 0, &expected);
    for (const VectorTarget target : targets) {
      if (!supported(target)) continue;
      const std::string where =
          "seed " + std::to_string(seed) + ", target " + std::to_string(static_cast<int>(target));
      const std::unique_ptr<ObservedEngine> observed = make_observed_vector_model(config, target);
      Trace trace;
      observed->begin(scene);
      observed->draw(scene.triangles, 0, &trace);
      expect_same(*observed, *scalar, where);
      for (int i = 0; i < register_count; ++i) {
        const auto id = static_cast<RegisterId>(i);
        FieldStatistics a = observed->statistics().of(id);
        const FieldStatistics& b = scalar->statistics().of(id);
        if (b.count == 0) a.min = b.min, a.max = b.max;
        EXPECT_EQ(a, b) << where << ": " << name_of(id);
        values += b.count;
      }
      const std::unique_ptr<Engine> traced =
          make_model(config, {.form = ModelForm::vector, .target = target});
      Trace records;
      traced->begin(scene);
      traced->draw(scene.triangles, 0, &records);
      for (const Trace* got : {&trace, &records}) {
#define BITSPAN_SAME(Record, LIST, stage, member) \
  EXPECT_TRUE(got->member == expected.member) << where << ": " stage;
        BITSPAN_RECORDS(BITSPAN_SAME)
#undef BITSPAN_SAME
      }
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(values, 1000000U);
}

// A bad triangle in the middle: what came before it is drawn, the error names it, as in the scalar form.
TEST(Forms, BadTriangleInABatch) {
  Scene scene = random_scene(3, small_scenes());
  scene.triangles[20].v[1].s = scene.s_max * 2;
  std::string text[2];
  std::vector<std::uint8_t> color[2];
  int at = 0;
  for (const ModelForm form : {ModelForm::scalar, ModelForm::vector}) {
    const std::unique_ptr<Engine> engine = make_model(shipped_config("depth16"), {.form = form});
    engine->begin(scene);
    try {
      engine->draw(scene.triangles, 100, nullptr);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& e) {
      text[at] = e.what();
    }
    color[at++] = engine->frame().color;
  }
  EXPECT_EQ(text[0], text[1]);
  EXPECT_NE(text[0].find("triangle 120, vertex 1"), std::string::npos) << text[0];
  EXPECT_EQ(color[0], color[1]);
}

TEST(Forms, Refusals) {
  Config c = shipped_config("depth16");
  c.format(FormatId::span_uv).word = 24;
  EXPECT_THROW(make_model(c, {.form = ModelForm::specialised}), InputError);
  EXPECT_THROW(make_model(c, {.threads = 0}), InputError);
  EXPECT_NO_THROW(make_model(c, {.form = ModelForm::automatic}));
}

}  // namespace
}  // namespace bitspan::model
