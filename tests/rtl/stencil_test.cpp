// SPDX-License-Identifier: Apache-2.0
// rtl/stencil.sv alone against the model's stage: every comparison with every operation, gaps and stalls.
#include "model/stages/stencil.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "engine/emit_pixel_sv.hpp"
#include "model/numeric/compare.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/rtl/unit_run.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

StageDesign design() {
  const Config c = shipped_config("depth16");
  return {
      .name = c.name,
      .top = "stencil",
      .package = emit_pixel_sv(c),
      .channels = {{ChannelKind::in,
                    "in",
                    {"stored", "z_pass", "func", "fail", "zfail", "pass", "ref", "mask", "write", "rest"}},
                   {ChannelKind::out, "out", {"pass", "op", "value", "go", "rest"}}},
      .constants = {},
      .levels = {}};
}

std::uint64_t port_of(CompareFunc func) {
  const auto passes = [&](int a, int b) { return static_cast<std::uint64_t>(model::compares(func, a, b)); };
  return passes(0, 1) | passes(1, 1) << 1 | passes(1, 0) << 2;
}

// Values that are often equal, or the ends of the range.
int random_byte(Random& random) {
  switch (random() % 4) {
    case 0:
      return static_cast<int>(random() % 2) * 255;
    case 1:
      return static_cast<int>(random() % 4);
    default:
      return static_cast<int>(random() % 256);
  }
}

struct StencilRun : UnitRun {
  std::set<std::tuple<int, bool, bool, int>> seen;  // comparison, both tests, operation
};

StencilRun run_stencil(Random& random, std::size_t count, const StageStalls& stalls,
                       StageTrace* trace = nullptr) {
  const StageDesign unit = design();
  StageBench bench(unit, random());
  if (trace != nullptr) bench.keep_trace(*trace);
  bench.set_stalls(stalls);
  StencilRun r;
  const auto make = [&](std::uint64_t number) -> Exchange {
    model::StencilStage stage;
    stage.test = true;
    const int ref = random_byte(random);
    const int mask = random() % 2 == 0 ? 255 : random_byte(random);
    const int write = random() % 2 == 0 ? 255 : random_byte(random);
    const auto op = [&] { return static_cast<StencilOp>(random() % enum_names<StencilOp>.size()); };
    const auto func = static_cast<CompareFunc>(random() % enum_names<CompareFunc>.size());
    stage.side[0] = {func, op(), op(), op(), ref, mask, write};
    const int stored = random() % 4 == 0 ? ref : random_byte(random);
    const DepthRecord z{.pass = static_cast<std::int64_t>(random() % 2)};
    StencilRecord s;
    const bool go = model::stencil(stage, false, z, static_cast<std::uint8_t>(stored), s);
    r.seen.insert({static_cast<int>(func), s.pass == 1, z.pass == 1, static_cast<int>(s.op)});
    const auto bits = [](auto v) { return static_cast<std::uint64_t>(v); };
    const model::StencilSide& side = stage.side[0];
    return {{bits(stored), bits(z.pass), port_of(func), bits(side.fail), bits(side.zfail), bits(side.pass),
             bits(ref), bits(mask), bits(write), number},
            {bits(s.pass), bits(s.op), bits(s.value), bits(go), number}};
  };
  static_cast<UnitRun&>(r) = run_unit(bench, unit, count, make);
  return r;
}

TEST(Stencil, EveryComparisonWithEveryOperation) {
  const std::size_t count = is_long_run() ? 3000000 : 60000;
  for (const StageStalls& stalls : {StageStalls{0, 0}, {0.3, 0.3}}) {
    Random random(3);
    const StencilRun r = run_stencil(random, count, stalls);
    EXPECT_EQ(r.fragments, count);
    // `never` fails always, `always` never: 8 operations each way, with and without the depth test.
    EXPECT_EQ(r.seen.size(), std::size_t{8} * 2 * (6 * 2 + 1 + 1));
  }
}

TEST(Stencil, Clocks) {
  Random random(5);
  const StencilRun r = run_stencil(random, 500, {});
  EXPECT_EQ(r.first_out, r.offered + 3);
  EXPECT_EQ(r.last_out, r.offered + 3 + 499);
}

TEST(Stencil, ToolsAgree) {
  Random random(7);
  StageTrace trace;
  run_stencil(random, 500, {0.2, 0.3}, &trace);
  expect_tools_agree(design(), trace);
}

TEST(Stencil, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/stencil.sv", "own < other && in_func_i[0]", "own < other && in_func_i[2]"},
      {"rtl/stencil.sv", "(&stored_1) ? stored_1", "1'b0 ? stored_1"},
      {"rtl/stencil.sv", "(|stored_1) ? stored_1", "1'b1 ? stored_1"},
      {"rtl/stencil.sv", "in_z_pass_i ? in_pass_i : in_zfail_i", "in_z_pass_i ? in_zfail_i : in_pass_i"},
      {"rtl/stencil.sv", "(stored_1 & ~write_1)", "(stored_1 & write_1)"},
      {"rtl/stencil.sv", "assign other = in_stored_i & in_mask_i;", "assign other = in_stored_i;"},
  };
  expect_seen(bugs, [&] {
    Random random(9);
    run_stencil(random, 3000, {0.2, 0.4});
  });
}

}  // namespace
}  // namespace bitspan
