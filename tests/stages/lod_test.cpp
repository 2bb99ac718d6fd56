// SPDX-License-Identifier: Apache-2.0
#include "model/stages/lod.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "golden/engine_golden.hpp"
#include "golden/lod.hpp"
#include "golden/mip_chain.hpp"
#include "golden/texture.hpp"
#include "model/engine_model.hpp"
#include "model/mip_chain.hpp"
#include "model/pipeline.hpp"
#include "scene/random.hpp"
#include "tests/stages/worked.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

Config with_levels(Config c, MipMode mip, LodMode lod) {
  c.mip = mip;
  c.lod = lod;
  return c;
}

// One fragment through the model, and through golden, which must say the same.
struct Leveled {
  Leveled(MipMode mip, LodMode lod, int bias = 0, int first = 16384)
      : config(with_levels(plain_config(), mip, lod)) {
    config.lod_bias = bias;
    config.lod_first = first;
  }
  LodRecord operator()(const FragmentRecord& f, int levels, const GradientRecord& gradient = {},
                       const DistanceRecord& distance = {}) const {
    const model::Constants constants = model::make_constants(config, worked_scene());
    const DrawState s = state.value_or(first_state(config));
    model::LodStage stage = model::prepare_lod(config, constants);
    model::set_lod(stage, s);
    LodRecord out;
    model::lod(stage, f, &gradient, distance, levels, out);
    std::vector<LodRecord> same;
    const FragmentRecord* one = &f;
    golden::make_lod({golden::Width::quad, true}, config, golden::make_constants(config, worked_scene()))(
        {&one, 1}, gradient, {&distance, 1}, levels, s, same);
    EXPECT_EQ(same, std::vector{out});
    return out;
  }
  LodRecord at_depth(double h, int levels) const {
    FragmentRecord f;
    f.triangle = 3;
    f.x = 4;
    f.y = 5;
    f.h = encoded(h, config.format(FormatId::span_h));
    const LodRecord r = (*this)(f, levels);
    EXPECT_EQ(r.triangle, 3);
    EXPECT_EQ(r.x, 4);
    EXPECT_EQ(r.y, 5);
    return r;
  }
  double lambda(const LodRecord& r) const { return decoded(r.lambda, config.format(FormatId::lod_lambda)); }
  double f(const LodRecord& r) const { return decoded(r.f, config.format(FormatId::lod_frac)); }
  Config config;
  std::optional<DrawState> state;  // else the first one
};

// S_i = 1/4, 1/2, 1 of 2^E; h = 0, 21845 and 65535 lie at s = 1, 3/4 and 1/2.
TEST(Lod, ZonesDoubleWithTheDistance) {
  const Leveled level(MipMode::linear, LodMode::zone_s);
  const LodRecord between = level.at_depth(21845, 8);
  EXPECT_EQ(decoded(between.s, level.config.format(FormatId::distance_s)), 0.75);
  EXPECT_NE(between.recip_m, 0);
  EXPECT_EQ(level.lambda(between), 1.5);
  EXPECT_EQ(between.level, 1);
  EXPECT_EQ(level.f(between), 0.5);
  EXPECT_EQ(level.lambda(level.at_depth(0, 8)), 2);
  EXPECT_EQ(level.at_depth(0, 8).level, 2);
  EXPECT_EQ(level.at_depth(0, 8).f, 0);
  EXPECT_EQ(level.lambda(level.at_depth(65535, 8)), 1);
  // The last level has no coarser one.
  EXPECT_EQ(level.lambda(level.at_depth(21845, 2)), 1);
  EXPECT_EQ(level.at_depth(21845, 2).f, 0);
  EXPECT_EQ(level.at_depth(21845, 1).level, 0);
  // Nearer than level 0's distance there is level 0.
  const Leveled far(MipMode::linear, LodMode::zone_s, 0, 65536);
  EXPECT_EQ(far.lambda(far.at_depth(21845, 8)), 0);
}

TEST(Lod, TheBiasIsAddedAndTheLevelIsHeldInTheChain) {
  const Leveled half(MipMode::linear, LodMode::zone_s, 8);
  EXPECT_EQ(half.lambda(half.at_depth(21845, 8)), 2);
  const Leveled finer(MipMode::linear, LodMode::zone_s, -64);
  EXPECT_EQ(finer.lambda(finer.at_depth(21845, 8)), -2.5);
  EXPECT_EQ(finer.at_depth(21845, 8).level, 0);
  EXPECT_EQ(finer.at_depth(21845, 8).f, 0);
  const Leveled constant(MipMode::linear, LodMode::none, 37);  // 2.3125
  const LodRecord r = constant.at_depth(100, 8);
  EXPECT_EQ(r.level, 2);
  EXPECT_EQ(constant.f(r), 0.3125);
  EXPECT_EQ(r.recip_m, 0);
  EXPECT_EQ(r.s, 0);
  EXPECT_EQ(constant.at_depth(100, 2).level, 1);
}

TEST(Lod, TheNearestLevelIsFoundByHalves) {
  for (const auto& [bias, level] : {std::pair(7, 0), {8, 1}, {23, 1}, {24, 2}, {-9, 0}, {200, 3}}) {
    const Leveled nearest(MipMode::nearest, LodMode::none, bias);
    EXPECT_EQ(nearest.at_depth(0, 4).level, level) << bias;
    EXPECT_EQ(nearest.at_depth(0, 4).f, 0) << bias;
  }
}

// lambda is 37/16, whatever the ends are; a least level above the greatest one counts alone.
TEST(Lod, TheRegistersSayWhichLevelsThereAre) {
  struct Case {
    int least, greatest, levels;
    std::int64_t level, f, nearest;
  };
  for (const Case& k :
       {Case{0, 15, 8, 2, 80, 2}, Case{2, 15, 8, 2, 80, 2}, Case{3, 15, 8, 3, 0, 3}, Case{0, 2, 8, 2, 0, 2},
        Case{0, 1, 8, 1, 0, 1}, Case{0, 0, 8, 0, 0, 0}, Case{0, 3, 8, 2, 80, 2}, Case{5, 1, 8, 5, 0, 5},
        Case{1, 1, 8, 1, 0, 1}, Case{3, 15, 2, 1, 0, 1}, Case{0, 2, 2, 1, 0, 1}, Case{15, 0, 1, 0, 0, 0},
        Case{15, 15, 16, 15, 0, 15}, Case{4, 2, 4, 3, 0, 3}}) {
    SCOPED_TRACE(testing::Message() << k.least << ".." << k.greatest << " of " << k.levels);
    for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
      Leveled level(mip, LodMode::none, 5);
      level.state = first_state(level.config);
      EXPECT_EQ(level.state->texture_lod_bias, 5);
      level.state->texture_lod_bias = 37;
      level.state->texture1_lod_bias = -9;  // of the other unit
      level.state->texture1_level_least = 7;
      level.state->texture_level_least = k.least;
      level.state->texture_level_greatest = k.greatest;
      const LodRecord r = level.at_depth(100, k.levels);
      EXPECT_EQ(level.lambda(r), 2.3125);
      EXPECT_EQ(r.level, mip == MipMode::linear ? k.level : k.nearest);
      EXPECT_EQ(r.f, mip == MipMode::linear ? k.f : 0);
    }
  }
}

// At s = 3/4 the zone says 1.5.
TEST(Lod, TheRegistersBiasTakesTheConfigurationsPlace) {
  Leveled level(MipMode::linear, LodMode::zone_s, 8);
  for (const int bias : {-31, -24, -8, 0, 8, 32}) {
    level.state = first_state(level.config);
    level.state->texture_lod_bias = bias;
    EXPECT_EQ(level.lambda(level.at_depth(21845, 8)), 1.5 + bias / 16.0);
  }
}

// u = 3 x, v = 5 y at s = 2, where q = B.
TEST(Lod, TheLongestGradientGivesTheLevel) {
  const Leveled level(MipMode::linear, LodMode::gradient);
  const Scene scene = worked_scene();
  const model::Pipeline pipeline = model::make_pipeline(level.config, scene);
  SetupRecord setup;
  const Triangle t = triangle(vertex(0, 0, 2, 0, 0), vertex(40, 0, 2, 120, 0), vertex(0, 40, 2, 0, 200));
  ASSERT_TRUE(model::setup(pipeline.setup, t, 0, setup));
  const GradientRecord g = model::setup_gradients(pipeline.plane_walk, setup);
  EXPECT_EQ(golden::make_gradients({golden::Width::quad, true}, level.config,
                                   golden::make_constants(level.config, scene))(setup),
            g);
  EXPECT_EQ(g.h_x, 0);
  EXPECT_EQ(decoded(g.gu_x, level.config.format(FormatId::plane_g_grad)), 3 * 65535);
  EXPECT_EQ(decoded(g.gv_y, level.config.format(FormatId::plane_g_grad)), 5 * 65535);
  FragmentRecord f;
  f.u = encoded(30, level.config.format(FormatId::span_uv));
  const LodRecord r = level(f, 8, g);
  EXPECT_EQ(decoded(r.u_x, level.config.format(FormatId::lod_slope)), 3);
  EXPECT_EQ(decoded(r.v_y, level.config.format(FormatId::lod_slope)), 5);
  EXPECT_EQ(r.u_y, 0);
  EXPECT_EQ(level.lambda(r), 2.25);  // 5 = 2^2 (1 + 1/4)
  EXPECT_EQ(r.level, 2);
  EXPECT_EQ(level.f(r), 0.25);
  // No gradient at all: one ulp.
  const LodRecord flat = level(f, 8);
  EXPECT_EQ(level.lambda(flat), -level.config.format(FormatId::lod_slope).fraction());
  EXPECT_EQ(flat.level, 0);
}

// A plane in perspective: u = 10 s along x, h_x is not 0, and u counts.
TEST(Lod, PerspectiveCounts) {
  const Leveled level(MipMode::linear, LodMode::gradient);
  GradientRecord g;
  g.h_x = encoded(-100, level.config.format(FormatId::plane_h_grad));
  g.gv_x = encoded(65535, level.config.format(FormatId::plane_g_grad));
  FragmentRecord f;  // h = 0
  f.v = encoded(655.35 * 3, level.config.format(FormatId::span_uv));
  const LodRecord r = level(f, 8, g);
  // (65535 + 1966.05 100) / 65535 = 4
  EXPECT_NEAR(decoded(r.v_x, level.config.format(FormatId::lod_slope)), 4, 1e-5);
}

Texture image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Texture t{"image", width, height, {}};
  for (int i = 0; i < 4 * width * height; ++i)
    t.rgba.push_back(static_cast<std::uint8_t>(random.bits() >> 56));
  return t;
}

TEST(MipChain, EachTexelIsTheMeanOfFour) {
  Texture t{"t", 4, 2, {}};
  for (const int red : {0, 1, 10, 20, 0, 1, 30, 41}) {
    for (const int c : {red, 255, 0, 2}) t.rgba.push_back(static_cast<std::uint8_t>(c));
  }
  const model::MipChain chain = model::make_mip_chain(t);
  ASSERT_EQ(chain.size(), 3U);
  EXPECT_EQ(chain[1].width, 2);
  EXPECT_EQ(chain[1].height, 1);
  EXPECT_EQ(chain[1].rgba, (std::vector<std::uint8_t>{1, 255, 0, 2, 25, 255, 0, 2}));  // 2/4 and 101/4
  EXPECT_EQ(chain[2].width, 1);
  EXPECT_EQ(chain[2].height, 1);
  EXPECT_EQ(chain[2].rgba, (std::vector<std::uint8_t>{13, 255, 0, 2}));  // (2 (1 + 25) + 2) / 4
}

TEST(MipChain, GoldenAndModelHaveTheSame) {
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 8}, {8, 1}, {2, 2}, {64, 64}, {16, 128}, {32, 2}}) {
    const Texture t = image(width, height, 7);
    const model::MipChain chain = model::make_mip_chain(t);
    const std::vector<Texture> same = golden::mip_levels(t);
    ASSERT_EQ(chain.size(), same.size()) << width << "x" << height;
    ASSERT_EQ(chain.size(), static_cast<std::size_t>(1 + std::log2(std::max(width, height))));
    for (std::size_t l = 0; l < chain.size(); ++l) {
      EXPECT_EQ(chain[l].width, same[l].width);
      EXPECT_EQ(chain[l].height, same[l].height);
      EXPECT_EQ(chain[l].rgba, same[l].rgba) << width << "x" << height << " level " << l;
    }
  }
}

TEST(MipChain, OtherSidesAreRefused) {
  const Config c = with_levels(plain_config(), MipMode::nearest, LodMode::none);
  for (const auto& [width, height] : {std::pair(3, 4), {4, 12}, {1 << 16, 1}}) {
    Scene scene = worked_scene();
    scene.textures = {image(2, 2, 1), image(width, height, 1)};
    for (const bool golden : {false, true}) {
      const auto engine = golden ? make_golden(c, false) : make_model(c, {.form = ModelForm::scalar});
      try {
        engine->begin(scene);
        ADD_FAILURE() << width << "x" << height;
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("powers of two"), std::string::npos) << error.what();
      }
    }
    Config without = c;
    without.mip = MipMode::none;
    EXPECT_NO_THROW(make_model(without, {.form = ModelForm::scalar})->begin(scene));
  }
}

TEST(Lod, WhatIsNotThereIsRefusedByName) {
  Config c = with_levels(shipped_config("depth16"), MipMode::linear, LodMode::gradient);
  EXPECT_FALSE(first_violation(c).has_value());
  c.perspective = Perspective::affine;
  ASSERT_TRUE(first_violation(c).has_value());
  EXPECT_EQ(first_violation(c)->key, "lod.mode");
  c.mip = MipMode::none;
  EXPECT_FALSE(first_violation(c).has_value());
  c.format(FormatId::lod_frac).integer = 1;
  EXPECT_EQ(first_violation(c)->key, "formats.lod.frac");
  c = with_levels(shipped_config("depth16"), MipMode::linear, LodMode::zone_s);
  EXPECT_TRUE(pixel_stages_are_in_rtl(c));
  for (const LodMode mode : {LodMode::zone_d, LodMode::finite}) {
    c.lod = mode;
    EXPECT_FALSE(pixel_stages_are_in_rtl(c));
    c.mip = MipMode::none;
    EXPECT_TRUE(pixel_stages_are_in_rtl(c));
    c.mip = MipMode::linear;
  }
}

// Bilinear in level 1 and further, of textures with a side that is held at one texel.
TEST(Texture, ASideHeldAtOneTexelIsNotHalved) {
  struct Case {
    int width, height, level;
    double u, v;
    double ex, ey;
    // cyclic, clamp, mirror, border
    std::array<std::pair<int, int>, 4> at;
  };
  const Case cases[] = {
      // u 1/4, v 1/1: 3/8 and 3/4 behind the half.
      {4, 1, 2, 3.5, 1.25, 0.375, 0.75, {{{0, 0}, {0, 0}, {0, 0}, {0, 0}}}},
      // u 2/4, v 1/1: 2 and 9/4.
      {4, 1, 1, 5, 2.75, 0, 0.25, {{{0, 0}, {1, 0}, {1, 0}, {2, 1}}}},
      // u 1/1, v 1/8: -5/4 and 1.
      {1, 8, 3, -0.75, 12, 0.75, 0, {{{0, 0}, {0, 0}, {0, 0}, {-1, 1}}}},
      // u 1/1, v 2/8: 0 and 5/4.
      {1, 8, 2, 0.5, 7, 0, 0.25, {{{0, 1}, {0, 1}, {0, 1}, {0, 1}}}},
  };
  Config c = with_levels(plain_config(), MipMode::nearest, LodMode::none);
  c.filter = TextureFilter::bilinear;
  c.border = {200, 200, 200, 255};
  FragmentRecord f;
  f.r = f.g = f.b = f.a = encoded(1, c.format(FormatId::span_shade));
  const FragmentRecord* const one = &f;
  for (const Case& k : cases) {
    SCOPED_TRACE(testing::Message() << k.width << "x" << k.height << ", level " << k.level);
    const Texture grey{"grey", k.width, k.height,
                       std::vector<std::uint8_t>(static_cast<std::size_t>(4 * k.width * k.height), 40)};
    f.u = encoded(k.u, c.format(FormatId::span_uv));
    f.v = encoded(k.v, c.format(FormatId::span_uv));
    LodRecord lod;
    lod.level = k.level;
    const std::vector<Texture> levels = golden::mip_levels(grey);
    for (std::size_t w = 0; w < 4; ++w) {
      c.wrap =
          std::array{TextureWrap::cyclic, TextureWrap::clamp, TextureWrap::mirror, TextureWrap::border}[w];
      TextureRecord r;
      model::texture(model::prepare_texture(c), &levels, f, lod, r);
      EXPECT_EQ(std::pair(r.i, r.j), (std::pair<std::int64_t, std::int64_t>(k.at[w]))) << w;
      EXPECT_EQ(decoded(r.ex, c.format(FormatId::texture_frac)), k.ex) << w;
      EXPECT_EQ(decoded(r.ey, c.format(FormatId::texture_frac)), k.ey) << w;
      // Of the first case the border's share is 3/8 in the upper row, and all of the lower one.
      if (&k == &cases[0]) {
        EXPECT_EQ(decoded(r.texel_r, c.format(FormatId::texture_mix)), w == 3 ? 175 : 40);
      }
      std::vector<TextureRecord> same;
      golden::make_mip_texture({golden::Width::quad, true}, c)({&one, 1}, {&lod, 1}, &levels, first_state(c),
                                                               same);
      EXPECT_EQ(same, std::vector{r}) << w;
    }
  }
}

// Level 0 is grey; level 1 has the reserved colour, with alpha 51 / 255, beside a texel of 40.
TEST(Texture, ATransparentTexelOfTheCoarserLevelIsWeighed) {
  Config c = with_levels(plain_config(), MipMode::linear, LodMode::none);
  c.transparent = {{255, 0, 255}};
  Texture grey{"grey", 4, 1, std::vector<std::uint8_t>(16, 100)};
  Texture coarser{"coarser", 2, 1, {255, 0, 255, 51, 40, 40, 40, 255}};
  const std::vector<Texture> levels{grey, coarser, {"last", 1, 1, {0, 0, 0, 0}}};
  FragmentRecord f;
  f.r = f.g = f.b = f.a = encoded(1, c.format(FormatId::span_shade));
  f.v = encoded(0.5, c.format(FormatId::span_uv));
  const FragmentRecord* const one = &f;
  LodRecord lod;
  lod.f = encoded(0.5, c.format(FormatId::lod_frac));
  // u in level 0, and red of V: half of 100, and half of what level 1 has at u / 2.
  for (const auto& [filter, u, red] : {
           std::tuple(TextureFilter::nearest, 1.5, 177.5),     // the reserved texel
           std::tuple(TextureFilter::nearest, 2.5, 70.0),      // its neighbour
           std::tuple(TextureFilter::bilinear, 1.5, 150.625),  // 255 3/4 + 40 1/4: it is nearest
           std::tuple(TextureFilter::bilinear, 2.5, 70.0),     // 40 stands for it
       }) {
    SCOPED_TRACE(u);
    c.filter = filter;
    f.u = encoded(u, c.format(FormatId::span_uv));
    TextureRecord r;
    EXPECT_TRUE(model::texture(model::prepare_texture(c), &levels, f, lod, r));
    EXPECT_EQ(decoded(r.texel_r, c.format(FormatId::texture_mix)), red);
    std::vector<TextureRecord> same;
    golden::make_mip_texture({golden::Width::quad, true}, c)({&one, 1}, {&lod, 1}, &levels, first_state(c),
                                                             same);
    EXPECT_EQ(same, std::vector{r});
  }
}

// Level l of a texture, at u and v of that level, is the texture of that level itself; and the mix of two is
// T11's.
TEST(Texture, ALevelIsATextureOfItsOwn) {
  Config c = plain_config();
  c.format(FormatId::span_uv) = {40, 20, true, Rounding::rnd, Overflow::sat, false};
  const Texture whole = image(32, 16, 3);
  const model::MipChain chain = model::make_mip_chain(whole);
  Random random(5);
  for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
    c.filter = filter;
    c.mip = MipMode::linear;
    const model::TextureStage stage = model::prepare_texture(c);
    for (int i = 0; i < 500; ++i) {
      FragmentRecord f;
      f.r = f.g = f.b = f.a = encoded(1, c.format(FormatId::span_shade));
      // Multiples of 2^5, so that each level's coordinate has a raw value.
      f.u = random.integer(-(1 << 22), 1 << 22) * 32;
      f.v = random.integer(-(1 << 22), 1 << 22) * 32;
      LodRecord lod;
      lod.level = random.integer(0, 5);
      const auto of_level = [&](std::int64_t level) {
        FragmentRecord at = f;
        at.u = f.u >> level;
        at.v = f.v >> std::min<std::int64_t>(level, 4);  // of 16 rows
        TextureRecord r;
        model::texture(stage, &chain[static_cast<std::size_t>(level)], at, r);
        return r;
      };
      TextureRecord r;
      model::texture(stage, &chain, f, lod, r);
      ASSERT_EQ(r, of_level(lod.level)) << "level " << lod.level;
      if (lod.level == 5) continue;
      lod.f = random.integer(1, (1 << 8) - 1);
      model::texture(stage, &chain, f, lod, r);
      const double a = decoded(of_level(lod.level).texel_g, c.format(FormatId::texture_mix));
      const double b = decoded(of_level(lod.level + 1).texel_g, c.format(FormatId::texture_mix));
      const double share = decoded(lod.f, c.format(FormatId::lod_frac));
      EXPECT_EQ(decoded(r.texel_g, c.format(FormatId::texture_mix)),
                std::floor((a * (1 - share) + b * share) * 16 + 0.5) / 16);
      EXPECT_EQ(r.i, of_level(lod.level).i);
    }
  }
}

TEST(Lod, GoldenAndModelAreEqual) {
  std::size_t records = 0;
  std::size_t mixed = 0;
  std::size_t held = 0;  // a side at one texel
  std::uint64_t seed = 0;
  for (const Config& base : shipped_configs()) {
    for (const Perspective perspective : all_perspectives) {
      for (const LodMode lod :
           {LodMode::none, LodMode::zone_s, LodMode::gradient, LodMode::zone_d, LodMode::finite}) {
        for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
          Config c = with_levels(base, mip, lod);
          c.perspective = perspective;
          if (first_violation(c)) continue;
          Random random(++seed);
          c.filter = random.chance(0.5) ? TextureFilter::nearest : TextureFilter::bilinear;
          c.wrap = static_cast<TextureWrap>(random.integer(0, 3));
          if (random.chance(0.5)) c.transparent = {{255, 0, 255}};
          c.lod_bias = static_cast<int>(random.integer(-16, 40));
          c.lod_first = static_cast<int>(random.log_uniform(20, 40000));
          const Scene scene = random_scene(seed, {.width = 64,
                                                  .height = 48,
                                                  .triangles = 24,
                                                  .size_max = 60,
                                                  .uv_limit = 400,
                                                  .texture_size_max = 16,
                                                  .mip_chains = true});
          Trace want, got;
          const auto golden = make_golden(c, true);
          const auto model = make_model(c, {.form = ModelForm::scalar});
          for (const auto& [engine, trace] : {std::pair(golden.get(), &want), {model.get(), &got}}) {
            engine->begin(scene);
            engine->draw(scene.triangles, 0, trace);
          }
          ASSERT_EQ(want.gradient, got.gradient) << "seed " << seed;
          ASSERT_EQ(want.lod, got.lod) << "seed " << seed;
          ASSERT_EQ(want.texture, got.texture) << "seed " << seed;
          ASSERT_EQ(want.merge, got.merge) << "seed " << seed;
          ASSERT_EQ(golden->counters(), model->counters()) << "seed " << seed;
          ASSERT_EQ(got.lod.size(), got.texture.size());
          ASSERT_EQ(!got.gradient.empty(), has_lod_gradients(c));
          records += got.lod.size();
          for (const LodRecord& r : got.lod) {
            mixed += r.f != 0 ? 1 : 0;
            const int texture = scene.triangles[static_cast<std::size_t>(r.triangle)].texture;
            if (texture < 0) continue;
            const Texture& t = scene.textures[static_cast<std::size_t>(texture)];
            held += std::min(t.width, t.height) >> r.level == 0 ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(records, 20000U);
  EXPECT_GT(mixed, 2000U);
  EXPECT_GT(held, 2000U);
}

// Four columns in level 0, at u = 5/4: by one texel 20, by four 17.5 of 10 and 20. Level 1 has 15 and 60: 15,
// and 20.625.
TEST(Texture, MagnifiesWhereTheLevelOfDetailIsAtMostZero) {
  Config c = with_levels(plain_config(), MipMode::nearest, LodMode::none);
  const Texture row{"row", 4, 1, {10, 0, 0, 255, 20, 0, 0, 255, 40, 0, 0, 255, 80, 0, 0, 255}};
  const std::vector<Texture> levels = golden::mip_levels(row);
  ASSERT_EQ(levels[1].rgba[4], 60);
  FragmentRecord f;
  f.r = f.g = f.b = f.a = encoded(1, c.format(FormatId::span_shade));
  f.u = encoded(1.25, c.format(FormatId::span_uv));
  f.v = encoded(0.5, c.format(FormatId::span_uv));
  const FragmentRecord* const one = &f;
  struct Case {
    TextureFilter filter;
    MagnifyFilter magnify;
    int least, greatest;
    std::int64_t lambda, level;  // lambda raw
    double red;
  };
  constexpr auto nearest = TextureFilter::nearest, bilinear = TextureFilter::bilinear;
  using M = MagnifyFilter;
  for (const Case& k :
       {Case{nearest, M::same, 0, 15, 0, 0, 20}, Case{nearest, M::same, 0, 15, 1, 0, 20},
        Case{nearest, M::bilinear, 0, 15, -1, 0, 17.5}, Case{nearest, M::bilinear, 0, 15, 0, 0, 17.5},
        Case{nearest, M::bilinear, 0, 15, 1, 0, 20}, Case{nearest, M::nearest, 0, 15, -9, 0, 20},
        Case{bilinear, M::nearest, 0, 15, -1, 0, 20}, Case{bilinear, M::nearest, 0, 15, 0, 0, 20},
        Case{bilinear, M::nearest, 0, 15, 1, 0, 17.5}, Case{bilinear, M::same, 0, 15, -1, 0, 17.5},
        // Held to 0 from above it is magnified; held to 1 from below, or to a single level, it is not.
        Case{nearest, M::bilinear, 0, 0, 900, 0, 17.5}, Case{nearest, M::bilinear, 1, 15, -900, 1, 15},
        Case{bilinear, M::nearest, 1, 15, -900, 1, 20.625}, Case{bilinear, M::nearest, 2, 0, -900, 2, 38},
        Case{nearest, M::bilinear, 0, 1, 900, 1, 15}}) {
    SCOPED_TRACE(testing::Message() << to_string(k.filter) << ", " << to_string(k.magnify) << ", " << k.least
                                    << ".." << k.greatest << ", lambda " << k.lambda);
    DrawState state = first_state(c);
    state.texture_filter = k.filter;
    state.texture_magnify = k.magnify;
    state.texture_level_least = k.least;
    state.texture_level_greatest = k.greatest;
    state.texture1_magnify = k.filter == nearest ? M::nearest : M::bilinear;  // of the other unit
    LodRecord lod;
    lod.lambda = k.lambda;
    lod.level = k.level;
    Scene scene = worked_scene();
    model::Pipeline pipeline = model::make_pipeline(c, scene);
    model::set_state(pipeline, scene, state);
    TextureRecord r;
    model::texture(pipeline.texture, &levels, f, lod, r);
    EXPECT_EQ(decoded(r.texel_r, c.format(FormatId::texture_mix)), k.red);
    std::vector<TextureRecord> same;
    golden::make_mip_texture({golden::Width::quad, true}, c)({&one, 1}, {&lod, 1}, &levels, state, same);
    EXPECT_EQ(same, std::vector{r});
  }
}

// Streams whose states have any bias, ends and filters, of both units.
TEST(Lod, GoldenAndModelAreEqualInAnyState) {
  std::size_t biased = 0, bounded = 0, magnified = 0, second = 0, seconds_own = 0;
  for (std::uint64_t seed = 1; seed <= (is_long_run() ? 2000U : 80U); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::vector<Config> bases = shipped_configs();
    Random random(seed);
    constexpr std::array modes{LodMode::none, LodMode::zone_s, LodMode::gradient, LodMode::zone_d,
                               LodMode::finite};
    Config c =
        with_levels(bases[seed % bases.size()], random.chance(0.5) ? MipMode::nearest : MipMode::linear,
                    modes[static_cast<std::size_t>(random.integer(0, 4))]);
    c.lod_bias = static_cast<int>(random.integer(-16, 16));
    c.lod_first = static_cast<int>(random.log_uniform(20, 40000));
    if (first_violation(c)) continue;
    const Scene scene = random_scene(seed, {.width = 48,
                                            .height = 40,
                                            .triangles = 40,
                                            .size_max = 60,
                                            .uv_limit = 100,
                                            .texture_size_max = 32,
                                            .mip_chains = true,
                                            .command_probability = 0.5});
    Trace want, got;
    const auto golden = make_golden(c, true);
    const auto model = make_model(c, {.form = ModelForm::scalar});
    const auto lanes = make_model(c, {});
    for (const auto& [engine, trace] :
         {std::pair(golden.get(), &want), {model.get(), &got}, {lanes.get(), nullptr}}) {
      engine->begin(scene);
      draw_scene(*engine, scene, 0, scene.triangles.size(), trace);
    }
    ASSERT_EQ(want.state, got.state);
    ASSERT_EQ(want.lod, got.lod);
    ASSERT_EQ(want.texture, got.texture);
    ASSERT_EQ(want.texture_second, got.texture_second);
    ASSERT_EQ(want.merge, got.merge);
    ASSERT_EQ(golden->counters(), model->counters());
    ASSERT_EQ(golden->counters(), lanes->counters());
    ASSERT_EQ(golden->frame().color, lanes->frame().color);
    ASSERT_EQ(golden->frame().depth, lanes->frame().depth);
    const std::vector<DrawState> states = all_states_of(c, scene.commands);
    const auto state_of = [&](std::int64_t triangle) {
      const auto after = std::ranges::upper_bound(got.state, triangle, {}, &StateRecord::triangle);
      return states[static_cast<std::size_t>(after - got.state.begin())];
    };
    for (const LodRecord& r : got.lod) {
      const DrawState s = state_of(r.triangle);
      biased += s.texture_lod_bias != c.lod_bias ? 1 : 0;
      bounded += r.level == s.texture_level_least || r.level == s.texture_level_greatest ? 1 : 0;
      magnified += r.lambda <= 0 && first_magnified(s) != first_lookup(s) ? 1 : 0;
    }
    for (const TextureSecondRecord& r : got.texture_second) {
      const DrawState s = state_of(r.triangle);
      ++second;
      seconds_own += s.texture1_lod_bias != s.texture_lod_bias ? 1 : 0;
    }
  }
  EXPECT_GT(biased, 2000U);
  EXPECT_GT(bounded, 2000U);
  EXPECT_GT(magnified, 500U);
  EXPECT_GT(second, 2000U);
  EXPECT_GT(seconds_own, 1000U);
}

// The environment asks for the longer form.
std::uint64_t lambda_scenes() { return is_long_run() ? 10000 : 60; }

// lambda against the base-2 logarithm of the longest derivative as the registers give it; docs/bounds.md.
TEST(Lod, LambdaIsWithinItsBound) {
  std::size_t checked = 0;
  for (const Config& base : shipped_configs()) {
    for (std::uint64_t seed = 1; seed <= lambda_scenes(); ++seed) {
      const Config c = with_levels(base, MipMode::linear, LodMode::gradient);
      const Scene scene = random_scene(
          seed,
          {.width = 96, .height = 64, .triangles = 10, .size_max = 90, .uv_limit = 1024, .mip_chains = true});
      const auto engine = make_model(c, {.form = ModelForm::scalar});
      Trace trace;
      engine->begin(scene);
      engine->draw(scene.triangles, 0, &trace);
      const model::Constants constants = model::make_constants(c, scene);
      const auto value = [&c](std::int64_t raw, FormatId id) {
        return std::ldexp(static_cast<long double>(raw), -c.format(id).fraction());
      };
      const long double ulp = value(1, FormatId::lod_slope);
      std::size_t at = 0;
      std::size_t plane = 0;
      for (const LodRecord& r : trace.lod) {
        while (trace.fragment[at].triangle != r.triangle || trace.fragment[at].x != r.x ||
               trace.fragment[at].y != r.y)
          ++at;
        while (trace.gradient[plane].triangle != r.triangle) ++plane;
        const FragmentRecord& f = trace.fragment[at];
        const GradientRecord& g = trace.gradient[plane];
        const long double q = value(f.h, FormatId::span_h) + value(constants.record.b, FormatId::setup_b);
        const auto derivative = [&](std::int64_t gw, std::int64_t h, std::int64_t w) {
          return std::abs(value(gw, FormatId::plane_g_grad) -
                          value(w, FormatId::span_uv) * value(h, FormatId::plane_h_grad)) /
                 q;
        };
        const long double rho = std::max({derivative(g.gu_x, g.h_x, f.u), derivative(g.gu_y, g.h_y, f.u),
                                          derivative(g.gv_x, g.h_x, f.v), derivative(g.gv_y, g.h_y, f.v)});
        // Below an ulp lambda stands for one ulp; above its range lod.slope saturates.
        if (rho < 2 * ulp || rho > value((std::int64_t{1} << 27) - 1, FormatId::lod_slope)) continue;
        // The reciprocal's relative error and half an ulp of lod.slope; half an ulp of lod.lambda.
        const long double m = std::ldexp(static_cast<long double>(r.recip_m),
                                         -c.pixel_reciprocal.output.fraction() - static_cast<int>(r.recip_e));
        const long double unit = std::abs(m * q - 1);
        const long double relative = unit + ulp / 2 / rho;
        const long double quantised = -std::log2(1 - relative) + value(1, FormatId::lod_lambda) / 2;
        const long double error = value(r.lambda, FormatId::lod_lambda) - std::log2(rho);
        ASSERT_LE(error, quantised) << base.name << " seed " << seed;
        ASSERT_GE(error, -0.0861L - quantised) << base.name << " seed " << seed;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, is_long_run() ? 10000000U : 50000U);
}

}  // namespace
}  // namespace bitspan
