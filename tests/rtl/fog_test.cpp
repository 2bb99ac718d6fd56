// SPDX-License-Identifier: Apache-2.0
// rtl/fog.sv alone against the model's stage: shipped and random configurations, every mode, pictures of any
// size, random tables, gaps and stalls.
#include "model/stages/fog.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/sv_writer.hpp"
#include "tb/rtl_pixels.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_case.hpp"
#include "tests/rtl/unit_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

const std::vector<std::string> inputs = {"x",    "y",     "h",     "r",      "g",          "b",     "rest",
                                         "mode", "color", "width", "height", "constant_b", "scale", "factor"};
const std::vector<std::string> outputs = {"index", "recip_m", "recip_e", "factor", "r", "g", "b", "rest"};

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "fog",
          .package = emit_pixel_sv(c),
          .channels = {{ChannelKind::in, "in", inputs}, {ChannelKind::out, "out", outputs}},
          .constants = {"load", "load_threshold", "load_place", "load_data"},
          .levels = {}};
}

int between(Random& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}
bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }
std::uint64_t port(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }

// What a scene sets: the picture's size, the constants, the table.
struct FogCase {
  Config config;
  model::Constants constants;
  model::FogStage stage;

  FogCase(const Config& c, Random& random) : config(c) {
    stage = model::prepare_fog(c, constants, Scene{});
    draw_constants(random);
    const int most = std::min(1 << (pixel_index_bits(c) - 1), 20000);
    stage.zones.width =
        chance(random, 0.3) ? between(random, 1, std::min(most, 20)) : between(random, 1, most);
    stage.zones.height =
        chance(random, 0.3) ? between(random, 1, std::min(most, 20)) : between(random, 1, most);
    stage.table.resize(std::size_t{1} << c.fog_index_bits());
    for (std::int64_t& entry : stage.table) entry = random_raw(random, c.format(FormatId::fog_factor));
  }

  void draw_constants(Random& random) {
    constants.record.b = std::max<std::int64_t>(1, random_raw(random, config.format(FormatId::setup_b)));
    constants.record.fog_scale = random_raw(random, config.format(FormatId::fog_scale));
    stage.q = model::make_inverse_depth(config, constants);
    stage.scale.raw = constants.record.fog_scale;
  }
};

// Thresholds and table, one per clock.
void load(StageBench& bench, const FogCase& t) {
  const auto write = [&](bool threshold, std::uint64_t place, std::uint64_t data) {
    bench.set_constant("load", 1);
    bench.set_constant("load_threshold", threshold ? 1 : 0);
    bench.set_constant("load_place", place);
    bench.set_constant("load_data", data);
    bench.clock();
  };
  const std::int64_t all =
      t.stage.zones.width * t.stage.zones.width + t.stage.zones.height * t.stage.zones.height;
  const std::int64_t zones = std::int64_t{1} << t.stage.zones.bits;
  for (std::int64_t k = 1; k < zones; ++k) {
    const bool by_r = t.stage.zones.by == FogZone::r;  // then k zones have k^2 shares of r^2
    const std::int64_t share = by_r ? k * k : k;
    const std::int64_t of = by_r ? zones * zones : zones;
    write(true, static_cast<std::uint64_t>(k), static_cast<std::uint64_t>((share * all + of - 1) / of));
  }
  for (std::size_t i = 0; i < t.stage.table.size(); ++i) {
    write(false, i, port(t.stage.table[i], t.config.format(FormatId::fog_factor)));
  }
  bench.set_constant("load", 0);
}

Exchange random_fragment(Random& random, FogCase& t, std::uint64_t number) {
  const Config& c = t.config;
  if (chance(random, 0.2)) t.draw_constants(random);
  t.stage.mode = has_other_mode(c) && chance(random, 0.5) ? c.fog
                 : chance(random, 0.8)                    ? FogMode::table
                                                          : FogMode::none;
  for (auto& channel : t.stage.fog_color) channel = static_cast<std::uint8_t>(random());
  const Format& h = c.format(FormatId::span_h);
  const Format& color = c.format(FormatId::texture_color);
  const Format& factor = c.format(FormatId::fog_factor);
  const Format& mixed = c.format(FormatId::fog_color);
  FragmentRecord f;
  f.x = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(t.stage.zones.width));
  f.y = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(t.stage.zones.height));
  f.h = random_raw(random, h);
  TextureRecord texel;
  for (std::int64_t* v : {&texel.r, &texel.g, &texel.b}) *v = random_raw(random, color);
  // In the other modes it stands at the port, and is not to be read.
  model::FragmentChannels channels{};
  channels[0].w = random_raw(random, factor);
  FogRecord r;
  model::fog(t.stage, f, {}, texel, r, model::NoObserve{}, &channels);
  Exchange g;
  const auto unsigned_of = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
  g.in = {unsigned_of(f.x),
          unsigned_of(f.y),
          port(f.h, h),
          port(texel.r, color),
          port(texel.g, color),
          port(texel.b, color),
          number,
          fog_number(t.stage.mode),
          t.stage.fog_color[0] | std::uint64_t{t.stage.fog_color[1]} << 8 |
              std::uint64_t{t.stage.fog_color[2]} << 16,
          unsigned_of(t.stage.zones.width),
          unsigned_of(t.stage.zones.height),
          port(t.constants.record.b, c.format(FormatId::setup_b)),
          port(t.constants.record.fog_scale, c.format(FormatId::fog_scale)),
          port(channels[0].w, factor)};
  g.out = {Rtl::to_port(r.index, c.fog_index_bits() + 1),
           port(r.recip_m, c.pixel_reciprocal.output),
           Rtl::to_port(r.recip_e, exponent_bits),
           port(r.factor, factor),
           port(r.r, mixed),
           port(r.g, mixed),
           port(r.b, mixed),
           number};
  return g;
}

struct FogRun : UnitRun {
  std::vector<std::size_t> modes = std::vector<std::size_t>(3);
  std::size_t indices = 0;  // different ones
};

// Sends `count` fragments; throws where one comes out otherwise, is lost, doubled, or comes after the last.
// `reset_after`: clocks of other fragments in front, then a reset.
FogRun run_fog(FogCase& t, Random& random, int count, const StageStalls& stalls, int reset_after = 0) {
  const StageDesign unit = design_of(t.config);
  StageBench bench(unit, random());
  load(bench, t);
  bench.set_stalls(stalls);
  if (reset_after > 0) {
    for (int n = 0; n < reset_after; ++n) bench.send("in", random_fragment(random, t, 0).in);
    for (int n = 0; n < reset_after; ++n) bench.clock();
    bench.reset();
  }
  FogRun r;
  std::vector<bool> seen(t.stage.table.size());
  static_cast<UnitRun&>(r) = run_unit(
      bench, unit, static_cast<std::size_t>(count),
      [&](std::uint64_t n) {
        Exchange g = random_fragment(random, t, mark_of(n));
        ++r.modes[g.in[7]];
        if (t.stage.mode == FogMode::table) seen[g.out[0]] = true;
        return g;
      },
      to_toml(t.config));
  r.indices = static_cast<std::size_t>(std::ranges::count(seen, true));
  return r;
}

// Fragments that take `least_indices` entries of the table at least: a random h may have few steps.
void check(const Config& config, std::uint64_t seed, int count, std::size_t least_indices) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  const StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};
  for (const StageStalls& stalls : conditions) {
    FogCase t(config, random);
    const FogRun r = run_fog(t, random, count, stalls);
    EXPECT_GT(r.modes[static_cast<std::size_t>(FogMode::none)], 0U);
    EXPECT_GT(r.modes[static_cast<std::size_t>(FogMode::table)], 0U);
    EXPECT_EQ(r.modes[fog_number(FogMode::linear)] > 0, has_other_mode(config));
    EXPECT_GE(r.indices, least_indices);
  }
}

TEST(Fog, Shipped) {
  for (Config config : shipped_configs()) {
    for (const FogMode mode : {FogMode::table, FogMode::linear, FogMode::vertex}) {
      config.fog = mode;
      check(config, 11, 4000, 20);
    }
  }
}

TEST(Fog, Random) {
  for (const std::uint64_t seed : stage_seeds(6)) {
    SCOPED_TRACE(stage_seed_text(seed));
    check(random_stage_config(seed), seed, 1500, 1);
  }
}

TEST(Fog, Clocks) {
  for (Config config : shipped_configs()) {
    for (const FogMode mode : {FogMode::table, FogMode::linear, FogMode::vertex}) {
      config.fog = mode;
      Random random(5);
      FogCase t(config, random);
      const auto total = static_cast<std::uint64_t>(pixel_timing(config).fog.total);
      const FogRun r = run_fog(t, random, 500, {});
      EXPECT_EQ(r.first_out, r.offered + total) << config.name;
      EXPECT_EQ(r.last_out, r.offered + total + 499) << config.name;
    }
  }
}

TEST(Fog, ResetAmidFragments) {
  Random random(7);
  FogCase t(shipped_config("narrow"), random);
  for (const int clocks : {3, 12, 40}) {
    EXPECT_EQ(run_fog(t, random, 300, {0.2, 0.3}, clocks).fragments, 300U) << clocks;
  }
}

TEST(Fog, RefusesLinearFogWhereItIsNotBuilt) {
  Random random(3);
  FogCase t(shipped_config("narrow"), random);
  StageBench bench(design_of(t.config), 1);
  Exchange g = random_fragment(random, t, 0);
  g.in[7] = static_cast<std::uint64_t>(FogMode::linear);
  bench.send("in", g.in);
  EXPECT_THROW(bench.clock(), std::logic_error);
}

TEST(Fog, PlantedBugsOfAGivenFactorAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/fog.sv", ".Depth(EntryAt)\n    ) u_factor_line", ".Depth(EntryAt + 1)\n    ) u_factor_line"},
      {"rtl/fog.sv", ".Depth(EntryAt)\n    ) u_factor_line", ".Depth(EntryAt - 1)\n    ) u_factor_line"},
      {"rtl/fog.sv", ".d_i(in_factor_i),", ".d_i(in_factor_i ^ FactorW'(1)),"},
  };
  Config config = shipped_config("depth16");
  config.fog = FogMode::vertex;
  Random random(5);
  FogCase t(config, random);
  run_fog(t, random, 1000, {0.2, 0.4});
  expect_seen(bugs, [&] { run_fog(t, random, 1000, {0.2, 0.4}); });
}

TEST(Fog, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/fog.sv", "negative ? '0 : (|placed", "(|placed"},
      {"rtl/fog.sv", "(|placed[PlacedW-1:StepW]) ? ", "1'b0 ? "},
      {"rtl/fog.sv", "place[axis], 1'b1})", "place[axis], 1'b0})"},
      {"rtl/fog.sv", "radius_q[s] >= threshold[zone_q", "radius_q[s] > threshold[zone_q"},
      {"rtl/depth_operand.sv", "{!negative}", "{1'b1}"},
      {"rtl/multiply_round.sv", "sticky_i(sticky)", "sticky_i(1'b0)"},
      {"rtl/fog.sv", ".Depth(RecipAt - 1)", ".Depth(RecipAt)"},
      {"rtl/multiply_round.sv", "far_i(far)", "far_i(1'b0)"},
      {"rtl/square.sv", "{a_i[Width-1:k+1], 2'b01}", "{a_i[Width-1:k+1], 2'b11}"},
  };
  Config config = shipped_config("depth16");
  config.fog = FogMode::linear;
  // A step that is negative or past the last one, and a rounding that looks at the sticky bit.
  config.format(FormatId::span_h) = {38, 20, true, Rounding::trn, Overflow::sat, false};
  config.format(FormatId::fog_factor).rounding = Rounding::rnd_min_inf;
  Random random(5);
  FogCase t(config, random);
  run_fog(t, random, 3000, {0.2, 0.4});
  expect_seen(bugs, [&] { run_fog(t, random, 3000, {0.2, 0.4}); });
}

}  // namespace
}  // namespace bitspan
