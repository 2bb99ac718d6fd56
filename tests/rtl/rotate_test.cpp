// SPDX-License-Identifier: Apache-2.0
// rtl/rotate.sv alone against the model: shipped and random registers, gaps and stalls.
#include "model/stages/rotate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <span>

#include "engine/emit_rotate_sv.hpp"
#include "tb/rtl_sources.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"
#include "tests/rtl/stage_replay.hpp"
#include "tests/rtl/unit_run.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr int turn = 360;

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "rotate",
          .package = emit_rotate_sv(c),
          .channels = {{ChannelKind::in, "in", {"x", "y", "t", "s", "quarter", "behind", "rest"}},
                       {ChannelKind::out, "out", {"x", "y", "rest"}}},
          .constants = {},
          .levels = {},
          .sources = rotate_sources()};
}

Config random_rotate_config(std::uint64_t seed) {
  Random random(seed);
  Config c = shipped_config("depth16");
  for (const FormatId id : {FormatId::rotate_t, FormatId::rotate_s, FormatId::rotate_xy}) {
    c.format(id) = {static_cast<int>(4 + random() % 40),
                    static_cast<int>(1 + random() % 4),
                    true,
                    static_cast<Rounding>(random() % rounding_modes),
                    static_cast<Overflow>(random() % overflow_modes),
                    false};
  }
  c.rtl.product_clocks = static_cast<int>(1 + random() % 5);
  return c;
}

// Vectors with their angles, and what has to come out for each.
class RandomTurns {
 public:
  RandomTurns(const Config& c, Random& random)
      : random_(random),
        vector_(c.format(FormatId::rotate_xy)),
        stage_(model::prepare_rotate(rotate_formats(c), turn)) {}

  void make(std::uint64_t n, std::span<std::uint64_t> in, std::span<std::uint64_t> out) {
    const auto port = [](std::int64_t raw, const model::Register& r) { return Rtl::to_port(raw, r.word); };
    const PlaneVector v{random_raw(random_, vector_), random_raw(random_, vector_)};
    const int angle = static_cast<int>(random_() % (turn + 1)) - turn / 2;
    const model::RotateOperands by = model::rotate_operands(stage_, angle);
    const PlaneVector to = model::rotate(stage_, v, by);
    const std::uint64_t mark = mark_of(n);
    std::ranges::copy(
        std::array{port(v.x, stage_.xy), port(v.y, stage_.xy), port(by.t, stage_.t), port(by.s, stage_.s),
                   static_cast<std::uint64_t>(by.quarter) & 3, std::uint64_t{by.is_first ? 0U : 1U}, mark},
        in.begin());
    std::ranges::copy(std::array{port(to.x, stage_.xy), port(to.y, stage_.xy), mark}, out.begin());
  }

 private:
  Random& random_;
  Format vector_;
  model::RotateStage stage_;
};

UnitRun run_vectors(const Config& c, Random& random, std::size_t count, const StageStalls& stalls,
                    StageTrace* trace = nullptr) {
  const StageDesign design = design_of(c);
  StageBench bench(design, random());
  bench.set_stalls(stalls);
  RandomTurns turns(c, random);
  if (trace != nullptr) bench.keep_trace(*trace);
  return run_unit(
      bench, design, count,
      [&](std::uint64_t n) {
        Exchange e{StageValues(7), StageValues(3)};
        turns.make(n, e.in, e.out);
        return e;
      },
      emit_rotate_sv(c));
}

// The same without gaps and stalls. Returns the clocks.
std::uint64_t stream_vectors(const Config& c, Random& random, std::uint64_t count) {
  RandomTurns turns(c, random);
  std::deque<std::array<std::uint64_t, 3>> given;  // on their way
  std::uint64_t sent = 0;
  return run_stream(design_of(c), {.offer =
                                       [&](std::span<std::uint64_t> in) {
                                         if (sent == count) return false;
                                         turns.make(sent++, in, given.emplace_back());
                                         return true;
                                       },
                                   .expect =
                                       [&](std::span<std::uint64_t> out) {
                                         std::ranges::copy(given.at(0), out.begin());
                                         given.pop_front();
                                       },
                                   .count = count});
}

void check(const Config& config, std::uint64_t seed, std::size_t count) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  const StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};
  for (const StageStalls& stalls : conditions) {
    EXPECT_EQ(run_vectors(config, random, count, stalls).fragments, count);
  }
}

TEST(RotateRtl, Shipped) { check(shipped_config("depth16"), 71, is_long_run() ? 200'000 : 3000); }

// In the long form 10^8 vectors, one per clock.
TEST(RotateRtl, ManyVectors) {
  constexpr std::uint64_t seed = 75;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Config config = shipped_config("depth16");
  const std::uint64_t count = is_long_run() ? 100'000'000 : 50'000;
  EXPECT_EQ(stream_vectors(config, random, count), count + static_cast<std::uint64_t>(rotate_clocks(config)));
}

TEST(RotateRtl, Random) {
  for (int n = 0; n < (is_long_run() ? 20 : 2); ++n) {
    const auto seed = static_cast<std::uint64_t>(n) + 81;
    check(random_rotate_config(seed), seed, 1200);
  }
}

TEST(RotateRtl, Clocks) {
  Random random(72);
  const Config config = shipped_config("depth16");
  const UnitRun r = run_vectors(config, random, 500, {});
  const auto clocks = static_cast<std::uint64_t>(rotate_clocks(config));
  EXPECT_EQ(r.first_out, r.offered + clocks);
  EXPECT_EQ(r.last_out, r.offered + clocks + 499);
}

TEST(RotateRtl, IcarusAndYosysAgree) {
  Random random(73);
  StageTrace trace;
  Config config = shipped_config("depth16");
  config.format(FormatId::rotate_xy) = {14, 8, true, Rounding::rnd_conv, Overflow::sat, false};
  run_vectors(config, random, 60, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(config), trace);
}

TEST(RotateRtl, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/rotate_lift.sv", "(Minus != 0) ? left - right : left + right", "left + right"},
      {"rtl/rotate_lift.sv", ".Depth(Clocks - 1)", ".Depth(Clocks - 2)"},
      {"rtl/rotate_quarter.sv", "2'd1: {x_o, y_o} = {minus_y, x_i};", "2'd1: {x_o, y_o} = {y_i, minus_x};"},
      {"rtl/rotate_quarter.sv", "2'd2: {x_o, y_o} = {minus_x, minus_y};",
       "2'd2: {x_o, y_o} = {x_i, minus_y};"},
      {"rtl/rotate_quarter.sv", "assign x = -$signed", "assign x = ~$signed"},
      {"rtl/rotate.sv", ".factor_i(s_middle),", ".factor_i(s_q),"},
      {"rtl/rotate.sv", ".factor_i(t_last),", ".factor_i(t_last ^ t_q),"},
      {"rtl/rotate.sv", ".quarter_i(in_behind_i ? 2'd0 : in_quarter_i),", ".quarter_i(in_quarter_i),"},
      {"rtl/rotate.sv", ".quarter_i(quarter_last),", ".quarter_i(2'd0),"},
  };
  const auto run = [&] {
    Random random(74);
    run_vectors(shipped_config("depth16"), random, 2000, {0.2, 0.4});
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
