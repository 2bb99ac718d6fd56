// SPDX-License-Identifier: Apache-2.0
// rtl/texture_levels.sv alone against the model's stage: shipped and random configurations, eight texels of a
// chain of two levels, gaps and stalls.
#include <gtest/gtest.h>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/mip_chain.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/texture.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/rtl/unit_run.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "texture_levels",
          .package = emit_pixel_sv(c),
          .channels = {{ChannelKind::in, "in", {"color1",      "color4",      "color2",      "color3",
                                                "alpha1",      "alpha4",      "alpha2",      "alpha3",
                                                "ex",          "ey",          "next_color1", "next_color4",
                                                "next_color2", "next_color3", "next_alpha1", "next_alpha4",
                                                "next_alpha2", "next_alpha3", "next_ex",     "next_ey",
                                                "f",           "rest"}},
                       {ChannelKind::out, "out", {"r", "g", "b", "a", "rest"}}},
          .constants = {},
          .levels = {}};
}

// One that repeats, with two levels of random texels: the next level is no mean of the first.
Config levels_config(Config c) {
  c.mip = MipMode::linear;
  c.wrap = TextureWrap::cyclic;
  c.transparent.reset();
  return c;
}
model::MipChain random_chain(Random& random) {
  model::MipChain chain;
  for (const int size : {8, 4}) {
    Texture t{"t", size, size, {}};
    for (int i = 0; i < 4 * size * size; ++i) {
      t.rgba.push_back(random() % 4 == 0 ? static_cast<std::uint8_t>(255 * (random() % 2))
                                         : static_cast<std::uint8_t>(random()));
    }
    chain.push_back(t);
  }
  return chain;
}

struct LevelsRun : UnitRun {
  std::size_t mixed = 0;
};

LevelsRun run_levels(const Config& c, Random& random, std::size_t count, const StageStalls& stalls,
                     StageTrace* trace = nullptr) {
  const StageDesign unit = design_of(c);
  StageBench bench(unit, random());
  if (trace != nullptr) bench.keep_trace(*trace);
  bench.set_stalls(stalls);
  const model::TextureStage stage = model::prepare_texture(c);
  const model::MipChain chain = random_chain(random);
  const Format& mix = c.format(FormatId::texture_mix);
  const Format& alpha = c.format(FormatId::texture_alpha);
  const model::Register own_alpha = model::make_register(c, FormatId::texture_alpha);
  const auto alpha_of = [&](std::uint8_t code) {
    return model::quantize_ratio({code, 0}, {255, 0}, own_alpha, model::NoObserve{});
  };
  LevelsRun r;
  const auto make = [&](std::uint64_t number) -> Exchange {
    FragmentRecord f;
    for (std::int64_t* w : {&f.u, &f.v}) *w = random_raw(random, c.format(FormatId::span_uv));
    StageValues in;
    // Both levels alone: where their texels lie, and how they are weighed.
    for (std::int64_t level = 0; level < 2; ++level) {
      const Texture& image = chain[static_cast<std::size_t>(level)];
      TextureRecord own;
      model::texture(stage, &chain, f, LodRecord{.level = level}, own);
      const auto texel = [&](std::int64_t right, std::int64_t down) {
        const std::int64_t i = (own.i + right) % image.width;
        const std::int64_t j = (own.j + down) % image.height;
        return image.rgba.data() + 4 * (j * image.width + i);
      };
      const std::uint8_t* texels[] = {texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)};
      for (const std::uint8_t* t : texels) {
        in.push_back(t[0] | std::uint64_t{t[1]} << 8 | std::uint64_t{t[2]} << 16);
      }
      for (const std::uint8_t* t : texels) {
        in.push_back(Rtl::to_port(alpha_of(t[3]), alpha.word));
      }
      in.push_back(static_cast<std::uint64_t>(own.ex));
      in.push_back(static_cast<std::uint64_t>(own.ey));
    }
    LodRecord level;
    if (random() % 4 != 0) level.f = random_raw(random, c.format(FormatId::lod_frac));
    r.mixed += level.f != 0 ? 1 : 0;
    TextureRecord t;
    model::texture(stage, &chain, f, level, t);
    in.push_back(static_cast<std::uint64_t>(level.f));
    in.push_back(number);
    return {in,
            {Rtl::to_port(t.texel_r, mix.word), Rtl::to_port(t.texel_g, mix.word),
             Rtl::to_port(t.texel_b, mix.word), Rtl::to_port(t.texel_a, alpha.word), number}};
  };
  static_cast<UnitRun&>(r) = run_unit(bench, unit, count, make, to_toml(c));
  return r;
}

std::size_t count_of(std::size_t fragments) { return is_long_run() ? 90 * fragments : fragments; }

TEST(TextureLevels, ShippedConfigurations) {
  for (Config c : shipped_configs()) {
    for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
      c.filter = filter;
      SCOPED_TRACE(c.name);
      for (const StageStalls& stalls : {StageStalls{0, 0}, {0.3, 0.3}}) {
        Random random(11);
        const LevelsRun r = run_levels(levels_config(c), random, count_of(10000), stalls);
        EXPECT_EQ(r.fragments, count_of(10000));
        EXPECT_GT(r.mixed, r.fragments / 2);
      }
    }
  }
}

TEST(TextureLevels, RandomConfigurations) {
  int tested = 0;
  for (std::uint64_t seed = stage_seeds(1)[0]; tested < (is_gate_run() ? 3 : 8); ++seed) {
    const Config c = levels_config(random_stage_config(seed));
    if (first_violation(c) || !is_in_rtl(c.filter)) continue;
    ++tested;
    SCOPED_TRACE(stage_seed_text(seed));
    Random random(seed);
    run_levels(c, random, count_of(2000), {0.3, 0.3});
    if (HasFailure()) return;
  }
}

TEST(TextureLevels, Clocks) {
  const Config c = levels_config(shipped_config("depth16"));
  Random random(5);
  const auto total = static_cast<std::uint64_t>(pixel_timing(c).texture.levels + 1);
  const LevelsRun r = run_levels(c, random, 500, {});
  EXPECT_EQ(r.first_out, r.offered + total);
  EXPECT_EQ(r.last_out, r.offered + total + 499);
}

TEST(TextureLevels, ToolsAgree) {
  const Config c = levels_config(shipped_config("narrow"));
  Random random(7);
  StageTrace trace;
  run_levels(c, random, 100, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(c), trace);
}

TEST(TextureLevels, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/texture_levels.sv", ".Depth(FilteredAt)", ".Depth(FilteredAt - 1)"},
      {"rtl/texture_levels.sv", "assign ex = {in_next_ex_i, in_ex_i};", "assign ex = {in_ex_i, in_ex_i};"},
      {"rtl/texture_levels.sv", "filtered[(3+c)*MixW+:MixW]", "filtered[(3-c)*MixW+:MixW]"},
      {"rtl/texture_levels.sv", ".b_i(filtered_a[AlphaW+:AlphaW])", ".b_i(filtered_a[0+:AlphaW])"},
  };
  Config c = levels_config(shipped_config("depth16"));
  c.filter = TextureFilter::bilinear;
  expect_seen(bugs, [&] {
    Random random(9);
    run_levels(c, random, 2000, {0.2, 0.4});
  });
}

}  // namespace
}  // namespace bitspan
