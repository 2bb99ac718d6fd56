// SPDX-License-Identifier: Apache-2.0
// rtl/blend_unit.sv alone against the model's stage: every pair of factors, every operation and every logic
// operation, of colour and of alpha, in shipped and random configurations, gaps and stalls.
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/stages/merge.hpp"
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
          .top = "blend_unit",
          .package = emit_pixel_sv(c),
          .channels = {{ChannelKind::in,
                        "in",
                        {"r", "g", "b", "a", "stored", "src", "dst", "op", "alpha_src", "alpha_dst",
                         "alpha_op", "constant", "logic", "rest"}},
                       {ChannelKind::out, "out", {"r", "g", "b", "a", "rest"}}},
          .constants = {},
          .levels = {}};
}

template <class E>
E random_of(Random& random) {
  return static_cast<E>(random() % enum_names<E>.size());
}
std::uint8_t random_code(Random& random) {
  return random() % 4 == 0 ? static_cast<std::uint8_t>(255 * (random() % 2))
                           : static_cast<std::uint8_t>(random());
}
std::uint64_t packed(const std::array<std::uint8_t, 4>& p) {
  return p[0] | std::uint64_t{p[1]} << 8 | std::uint64_t{p[2]} << 16 | std::uint64_t{p[3]} << 24;
}

struct BlendRun : UnitRun {
  std::set<std::tuple<BlendFactor, BlendFactor, BlendOp>> color, alpha;
  std::set<LogicOp> logic;
};

BlendRun run_blend(const Config& c, Random& random, std::size_t count, const StageStalls& stalls,
                   StageTrace* trace = nullptr) {
  const StageDesign unit = design_of(c);
  StageBench bench(unit, random());
  if (trace != nullptr) bench.keep_trace(*trace);
  bench.set_stalls(stalls);
  const Format& color = c.format(FormatId::fog_color);
  const Format& alpha = c.format(FormatId::texture_alpha);
  model::MergeStage stage = model::prepare_merge(c);
  BlendRun r;
  const auto make = [&](std::uint64_t number) -> Exchange {
    model::Blend blend;
    const auto equation = [&] {
      return model::BlendEquation{random_of<BlendFactor>(random), random_of<BlendFactor>(random),
                                  random_of<BlendOp>(random)};
    };
    blend.color = equation();
    blend.alpha = equation();
    std::array<std::uint8_t, 4> constant{}, stored{};
    for (std::uint8_t& code : constant) code = random_code(random);
    for (std::uint8_t& code : stored) code = random_code(random);
    for (std::size_t i = 0; i < 4; ++i) blend.constant[i] = constant[i];
    if (random() % 4 == 0) blend.logic = random_of<LogicOp>(random);
    if (blend.logic == LogicOp::none) {
      r.color.insert({blend.color.src, blend.color.dst, blend.color.op});
      r.alpha.insert({blend.alpha.src, blend.alpha.dst, blend.alpha.op});
    }
    r.logic.insert(blend.logic);
    model::set_blend(stage, blend);
    FogRecord fog;
    for (std::int64_t* w : {&fog.r, &fog.g, &fog.b}) *w = random_raw(random, color);
    TextureRecord texture;
    texture.a = random() % 8 == 0 ? std::int64_t{1} << alpha.fraction() : random_raw(random, alpha);
    MergeRecord m;
    model::merge(stage, {}, texture, fog, stored, m);
    const MergeAlphaRecord a = model::merged_alpha(stage, texture, stored[3]);
    const auto bits = [](auto v) { return static_cast<std::uint64_t>(v); };
    return {{Rtl::to_port(fog.r, color.word), Rtl::to_port(fog.g, color.word),
             Rtl::to_port(fog.b, color.word), Rtl::to_port(texture.a, alpha.word), packed(stored),
             bits(blend.color.src), bits(blend.color.dst), bits(blend.color.op), bits(blend.alpha.src),
             bits(blend.alpha.dst), bits(blend.alpha.op), packed(constant), bits(blend.logic), number},
            {bits(m.r), bits(m.g), bits(m.b), bits(a.a), number}};
  };
  static_cast<UnitRun&>(r) = run_unit(bench, unit, count, make, to_toml(c));
  return r;
}

std::size_t count_of(std::size_t fragments) { return is_long_run() ? 60 * fragments : fragments; }

TEST(BlendUnit, EveryEquation) {
  for (const Config& c : shipped_configs()) {
    SCOPED_TRACE(c.name);
    for (const StageStalls& stalls : {StageStalls{0, 0}, {0.3, 0.3}}) {
      Random random(11);
      const BlendRun r = run_blend(c, random, count_of(20000), stalls);
      EXPECT_EQ(r.fragments, count_of(20000));
      EXPECT_EQ(r.color.size(), std::size_t{16} * 16 * 5);
      EXPECT_EQ(r.alpha.size(), std::size_t{16} * 16 * 5);
      EXPECT_EQ(r.logic.size(), 17U);
    }
  }
}

TEST(BlendUnit, RandomConfigurations) {
  for (const std::uint64_t seed : stage_seeds(8)) {
    SCOPED_TRACE(stage_seed_text(seed));
    Random random(seed);
    run_blend(random_stage_config(seed), random, count_of(3000), {0.3, 0.3});
    if (HasFailure()) return;
  }
}

TEST(BlendUnit, Clocks) {
  const Config c = shipped_config("depth16");
  Random random(5);
  const auto total = static_cast<std::uint64_t>(pixel_timing(c).merge.any_blend + 1);
  const BlendRun r = run_blend(c, random, 500, {});
  EXPECT_EQ(r.first_out, r.offered + total);
  EXPECT_EQ(r.last_out, r.offered + total + 499);
}

TEST(BlendUnit, ToolsAgree) {
  const Config c = shipped_config("narrow");
  Random random(7);
  StageTrace trace;
  run_blend(c, random, 200, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(c), trace);
}

TEST(BlendUnit, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/blend_equation.sv", "FactorW'({1'b0, code[7]})", "FactorW'(1'b0)"},
      {"rtl/blend_equation.sv", "(share < room) ? share", "(share > room) ? share"},
      {"rtl/blend_equation.sv", "sum_q <= stored - own;", "sum_q <= stored + own;"},
      {"rtl/blend_equation.sv", "{8{truth[1]}} & replaced_q", "{8{truth[2]}} & replaced_q"},
      {"rtl/blend_equation.sv", "(whole > 255) ? '1", "1'b0 ? '1"},
      {"rtl/blend_equation.sv", "of_number(factor_dst_1, base_dst)",
       "of_number({factor_dst_1[3:1], factor_src_1[0]}, base_dst)"},
      {"rtl/blend_equation.sv", "One >>> 1", "One >>> 2"},
      {"rtl/blend_equation.sv", "(ScaledW + 1)'(1) <<< AGrid", "(ScaledW + 1)'(0) <<< AGrid"},
      {"rtl/blend_unit.sv", "(c == 3) ? in_alpha_op_i : in_op_i", "(c != 3) ? in_alpha_op_i : in_op_i"},
  };
  Config c = shipped_config("depth16");
  // Colours below 0 and above 255.
  c.format(FormatId::fog_color) = {16, 10, true, Rounding::rnd, Overflow::sat, false};
  const auto run = [&] {
    Random random(9);
    run_blend(c, random, 4000, {0.2, 0.4});
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
