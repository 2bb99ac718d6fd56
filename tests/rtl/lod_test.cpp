// SPDX-License-Identifier: Apache-2.0
// rtl/lod.sv alone against the model's stage: every mode, both kinds of level, shipped and random
// configurations, raw values from the whole range of each format, gaps and stalls.
#include "model/stages/lod.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/sv_writer.hpp"
#include "model/numeric/exact.hpp"
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

const std::vector<std::string> inputs = {"h",    "u",    "v",    "h_x",  "h_y", "gu_x",
                                         "gu_y", "gv_x", "gv_y", "last", "rest"};
const std::vector<std::string> outputs = {"recip_m", "recip_e", "s",     "u_x", "u_y", "v_x",
                                          "v_y",     "lambda",  "level", "f",   "rest"};

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "lod",
          .package = emit_pixel_sv(c),
          .channels = {{ChannelKind::in, "in", inputs}, {ChannelKind::out, "out", outputs}},
          .constants = {"b", "a", "load", "load_place", "load_data"},
          .levels = {}};
}

std::uint64_t port(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }

// What a scene sets: B and A'.
struct LodCase {
  Config config;
  model::Constants constants;
  model::LodStage stage;

  LodCase(const Config& c, Random& random) : config(c) {
    constants.record.b = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_b)));
    constants.record.s_max = std::max<std::int64_t>(1, random_raw(random, c.format(FormatId::setup_s)));
    stage = model::prepare_lod(c, constants);
  }
};

constexpr std::array modes_in_rtl{LodMode::none, LodMode::zone_s, LodMode::gradient};

struct LodRun : UnitRun {
  std::array<std::size_t, max_mip_level + 1> levels{};
  std::size_t mixed = 0;  // between two levels
};

// Half of the values small, so that differences of products have any size.
std::int64_t random_value(Random& random, const Format& f) {
  const std::int64_t raw = random_raw(random, f);
  return random() % 2 == 0 ? raw : raw >> (random() % static_cast<std::uint64_t>(f.word));
}

Exchange random_fragment(Random& random, const LodCase& t, std::uint64_t number, LodRun& run) {
  const Config& c = t.config;
  const Format& uv = c.format(FormatId::span_uv);
  const Format& h_grad = c.format(FormatId::plane_h_grad);
  const Format& g_grad = c.format(FormatId::plane_g_grad);
  FragmentRecord f;
  f.h = random_value(random, c.format(FormatId::span_h));
  for (std::int64_t* w : {&f.u, &f.v}) *w = random_value(random, uv);
  GradientRecord g;
  for (std::int64_t* w : {&g.h_x, &g.h_y}) *w = random_value(random, h_grad);
  for (std::int64_t* w : {&g.gu_x, &g.gu_y, &g.gv_x, &g.gv_y}) *w = random_value(random, g_grad);
  const int last = static_cast<int>(random() % (max_mip_level + 1));
  LodRecord r;
  model::lod(t.stage, f, &g, DistanceRecord{}, last + 1, r);
  ++run.levels[static_cast<std::size_t>(r.level)];
  run.mixed += r.f != 0 ? 1 : 0;
  const Format& slope = c.format(FormatId::lod_slope);
  return {{port(f.h, c.format(FormatId::span_h)), port(f.u, uv), port(f.v, uv), port(g.h_x, h_grad),
           port(g.h_y, h_grad), port(g.gu_x, g_grad), port(g.gu_y, g_grad), port(g.gv_x, g_grad),
           port(g.gv_y, g_grad), static_cast<std::uint64_t>(last), number},
          {port(r.recip_m, c.pixel_reciprocal.output), Rtl::to_port(r.recip_e, exponent_bits),
           port(r.s, c.format(FormatId::distance_s)), port(r.u_x, slope), port(r.u_y, slope),
           port(r.v_x, slope), port(r.v_y, slope), port(r.lambda, c.format(FormatId::lod_lambda)),
           static_cast<std::uint64_t>(r.level), port(r.f, c.format(FormatId::lod_frac)), number}};
}

// Sends `count` fragments; throws where one comes out otherwise, is lost, doubled, or comes after the last.
// `reset_after`: clocks of other fragments in front, then a reset.
LodRun run_lod(const LodCase& t, Random& random, int count, const StageStalls& stalls, int reset_after = 0,
               StageTrace* trace = nullptr) {
  const Config& c = t.config;
  const StageDesign unit = design_of(c);
  StageBench bench(unit, random());
  if (trace != nullptr) bench.keep_trace(*trace);
  bench.set_constant("b", port(t.constants.record.b, c.format(FormatId::setup_b)));
  if (has_lod_zones(c)) {
    const Format& a = c.format(FormatId::distance_a);
    bench.set_constant("a", port(static_cast<std::int64_t>(model::on_grid(t.stage.a, a.fraction())), a));
    bench.set_constant("load", 1);
    const Format& k = c.format(FormatId::lod_k);
    for (std::size_t i = 0; i < t.stage.zones.size(); ++i) {
      bench.set_constant("load_place", i);
      bench.set_constant(
          "load_data", port(static_cast<std::int64_t>(model::on_grid(t.stage.zones[i].k, k.fraction())), k));
      bench.clock();
    }
    bench.set_constant("load", 0);
  }
  bench.set_stalls(stalls);
  LodRun r;
  if (reset_after > 0) {
    for (int n = 0; n < reset_after; ++n) bench.send("in", random_fragment(random, t, 0, r).in);
    for (int n = 0; n < reset_after; ++n) bench.clock();
    bench.reset();
  }
  static_cast<UnitRun&>(r) = run_unit(
      bench, unit, static_cast<std::size_t>(count),
      [&](std::uint64_t n) { return random_fragment(random, t, mark_of(n), r); }, to_toml(c));
  return r;
}

constexpr StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};

// Fragments per condition; more in the long test.
int count_of(int fragments) { return is_long_run() ? 90 * fragments : fragments; }

LodRun check(const Config& config, std::uint64_t seed, int count) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  LodRun sum;
  for (const StageStalls& stalls : conditions) {
    const LodCase t(config, random);
    const LodRun r = run_lod(t, random, count, stalls);
    EXPECT_EQ(r.fragments, static_cast<std::size_t>(count));
    sum.fragments += r.fragments;
    sum.mixed += r.mixed;
    for (std::size_t i = 0; i < sum.levels.size(); ++i) sum.levels[i] += r.levels[i];
  }
  return sum;
}

Config config_of(const char* name, MipMode mip, LodMode mode) {
  Config c = shipped_config(name);
  c.mip = mip;
  c.lod = mode;
  c.lod_bias = 5;
  c.lod_first = 300;
  c.pixel_reciprocal.pipelined = true;
  return c;
}

TEST(Lod, EveryModeInShippedConfigurations) {
  std::size_t fragments = 0;
  for (const std::string& name : shipped_names) {
    for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
      for (const LodMode mode : in_gate(modes_in_rtl)) {
        const Config c = config_of(name.c_str(), mip, mode);
        const LodRun r = check(c, 11, count_of(1600));
        fragments += r.fragments;
        const auto seen = std::ranges::count_if(r.levels, [](std::size_t n) { return n > 0; });
        EXPECT_GE(seen, has_zones(mode) || has_gradients(mode) ? 6 : 1) << name << " " << to_string(mode);
        EXPECT_EQ(r.mixed > 100, mixes_levels(mip)) << name << " " << to_string(mode);
      }
    }
  }
  EXPECT_GE(fragments, is_gate_run() ? 30000U : 100000U);
}

TEST(Lod, RandomConfigurations) {
  const int most = is_gate_run() ? 1 : 3;  // of a mode
  std::array<int, modes_in_rtl.size()> modes{};
  for (std::uint64_t seed = stage_seeds(1)[0]; std::ranges::min(modes) < most; ++seed) {
    Config c = random_stage_config(seed);
    const auto mode = static_cast<std::size_t>(std::ranges::find(modes_in_rtl, c.lod) - modes_in_rtl.begin());
    if (!has_lod(c) || mode == modes.size() || modes[mode] == most) continue;
    c.pixel_reciprocal.pipelined = true;
    if (first_violation(c)) continue;
    ++modes[mode];
    SCOPED_TRACE(stage_seed_text(seed));
    check(c, seed, count_of(800));
    if (HasFailure()) return;
  }
}

TEST(Lod, Clocks) {
  for (const LodMode mode : modes_in_rtl) {
    const Config c = config_of("depth16", MipMode::linear, mode);
    Random random(5);
    const LodCase t(c, random);
    const auto total = static_cast<std::uint64_t>(pixel_timing(c).lod.total);
    const LodRun r = run_lod(t, random, 500, {});
    EXPECT_EQ(r.first_out, r.offered + total) << to_string(mode);
    EXPECT_EQ(r.last_out, r.offered + total + 499) << to_string(mode);
  }
}

TEST(Lod, ResetAmidFragments) {
  Random random(7);
  const LodCase t(config_of("narrow", MipMode::linear, LodMode::zone_s), random);
  for (const int clocks : {3, 12, 40}) {
    EXPECT_EQ(run_lod(t, random, 300, {0.2, 0.3}, clocks).fragments, 300U) << clocks;
  }
}

TEST(Lod, ToolsAgree) {
  std::vector<Config> configs = {config_of("narrow", MipMode::nearest, LodMode::none),
                                 config_of("depth16", MipMode::nearest, LodMode::gradient),
                                 config_of("depth16", MipMode::linear, LodMode::zone_s)};
  for (const Config& c : configs) {
    Random random(21);
    const LodCase t(c, random);
    StageTrace trace;
    run_lod(t, random, 60, {0.2, 0.3}, 0, &trace);
    expect_tools_agree(design_of(c), trace);
  }
}

TEST(Lod, PlantedBugsAreSeen) {
  constexpr PlantedBug both[] = {
      {"rtl/lod.sv", "(wide > limit) ? limit", "1'b0 ? limit"},
      {"rtl/lod.sv", ".Depth(Clocks - RecipAt)", ".Depth(Clocks - RecipAt - 1)"},
      {"rtl/lod.sv", "SumW'(bitspan_pixel_pkg::LodBias)", "-SumW'(bitspan_pixel_pkg::LodBias)"},
  };
  constexpr PlantedBug of_zones[] = {
      {"rtl/lod.sv", "LevelW'(i) <= last && distance", "LevelW'(i) != last && distance"},
      {"rtl/lod.sv", "IntoW'(distance_into) - IntoW'(start_q)", "IntoW'(distance_into)"},
      {"rtl/lod.sv", "(ends_out ? '0 : ", "(1'b0 ? '0 : "},
      {"rtl/lod.sv", ".Depth(IntoAt - 1 - DistanceAt)", ".Depth(IntoAt - DistanceAt)"},
  };
  constexpr PlantedBug of_gradients[] = {
      {"rtl/lod.sv", "wide[WideW-1] ? '0 : ", "1'b0 ? '0 : "},
      {"rtl/lod.sv", "slope[SlopeW-1]) ? -slope", "slope[SlopeW-1]) ? ~slope"},
      {"rtl/lod.sv", "(t % 2 == 0) ? in_h_x_i", "(t < 2) ? in_h_x_i"},
      {"rtl/lod.sv", "(rho == '0) ? SlopeW'(1)", "1'b0 ? SlopeW'(1)"},
      {"rtl/lod.sv", "(larger_q[1] > larger_q[0])", "(larger_q[1] < larger_q[0])"},
      {"rtl/lod.sv", "SlopeW - 2 - bitspan", "SlopeW - 1 - bitspan"},
  };
  constexpr PlantedBug of_nearest[] = {
      {"rtl/lod.sv", " + LevelW'(held_q[HeldFrac-1])", " + LevelW'(!held_q[HeldFrac-1])"}};
  const auto seen = [](std::span<const PlantedBug> bugs, const Config& c) {
    const auto run = [&] {
      Random random(5);
      const LodCase t(c, random);
      run_lod(t, random, 3000, {0.2, 0.4});
    };
    run();
    expect_seen(bugs, run);
  };
  seen(both, config_of("depth16", MipMode::linear, LodMode::zone_s));
  seen(of_zones, config_of("depth16", MipMode::linear, LodMode::zone_s));
  seen(of_gradients, config_of("depth16", MipMode::linear, LodMode::gradient));
  seen(of_nearest, config_of("depth16", MipMode::nearest, LodMode::gradient));
}

}  // namespace
}  // namespace bitspan
