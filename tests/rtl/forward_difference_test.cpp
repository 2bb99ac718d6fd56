// SPDX-License-Identifier: Apache-2.0
// rtl/forward_difference.sv alone against the model: shipped and random registers, curves of any length, gaps
// and stalls.
#include "model/stages/forward_difference.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <span>
#include <stdexcept>
#include <vector>

#include "engine/emit_curve_sv.hpp"
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

constexpr FormatId registers[] = {FormatId::curve_d0, FormatId::curve_d1, FormatId::curve_d2,
                                  FormatId::curve_d3};

StageDesign design_of(const Config& c) {
  return {.name = c.name,
          .top = "forward_difference",
          .package = emit_curve_sv(c),
          .channels = {{ChannelKind::in, "in", {"d0", "d1", "d2", "d3", "steps", "rest"}},
                       {ChannelKind::out, "out", {"d0", "d1", "d2", "d3", "last", "rest"}}},
          .constants = {},
          .levels = {},
          .sources = curve_sources()};
}

Config random_curve_config(std::uint64_t seed) {
  Random random(seed);
  Config c = shipped_config("depth16");
  for (const FormatId id : registers) {
    const bool is_signed = random() % 4 != 0;
    c.format(id) = {
        static_cast<int>(3 + random() % 60),
        static_cast<int>(random() % 24),
        is_signed,
        static_cast<Rounding>(random() % rounding_modes),
        static_cast<Overflow>(random() % static_cast<unsigned>(overflow_modes - (is_signed ? 0 : 1))),
        false};
  }
  return c;
}

struct CurveRun {
  std::size_t curves = 0, points = 0;
  std::uint64_t first_out = 0, last_out = 0, offered = 0;  // clocks
};

// A random curve, its steps by the model, and its values on the ports.
class CurvePorts {
 public:
  CurvePorts(const Config& c, Random& random)
      : random_(random),
        formats_(curve_formats(c)),
        stage_(model::prepare_forward_difference(formats_, 0, 0)) {}

  CurveRegisters random_start() const {
    CurveRegisters d;
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = random_raw(random_, formats_[i]);
    return d;
  }
  void advance(CurveRegisters& d) const { model::forward_difference(stage_, d); }
  // beside: the steps, or whether it is the last point.
  void put(std::span<std::uint64_t> ports, const CurveRegisters& d, std::uint64_t beside,
           std::uint64_t mark) const {
    for (std::size_t i = 0; i < d.size(); ++i) ports[i] = Rtl::to_port(d[i], formats_[i].word);
    ports[4] = beside;
    ports[5] = mark;
  }

 private:
  Random& random_;
  CurveFormats formats_;
  model::ForwardDifferenceStage stage_;
};

// Sends curves of up to `longest` steps until `count` points are out; throws std::logic_error where one comes
// out otherwise, is lost, doubled, or comes after the last.
CurveRun run_curves(const Config& c, Random& random, std::size_t count, unsigned longest,
                    const StageStalls& stalls, StageTrace* trace = nullptr, int reset_after = 0) {
  const StageDesign design = design_of(c);
  StageBench bench(design, random());
  bench.set_stalls(stalls);
  const CurvePorts curve(c, random);
  const auto ports = [&](const CurveRegisters& d, std::uint64_t beside, std::uint64_t mark) {
    StageValues out(6);
    curve.put(out, d, beside, mark);
    return out;
  };
  if (reset_after > 0) {
    for (int n = 0; n < 3; ++n) bench.send("in", ports(curve.random_start(), 9, 0));
    for (int n = 0; n < reset_after; ++n) bench.clock();
    bench.reset();
  }
  if (trace != nullptr) bench.keep_trace(*trace);
  CurveRun r;
  std::size_t sent = 0;
  std::deque<StageValues> expected;
  r.offered = bench.clocks();
  bench.on_transfer("out", [&](const StageValues& v) {
    if (expected.empty()) throw std::logic_error("a point after the last");
    if (v != expected.front()) {
      throw std::logic_error(fmt::format("point {}: {:#x}, expected {:#x}\n{}", r.points, fmt::join(v, " "),
                                         fmt::join(expected.front(), " "), emit_curve_sv(c)));
    }
    expected.pop_front();
    if (r.points++ == 0) r.first_out = bench.clocks() - 1;
    r.last_out = bench.clocks() - 1;
  });
  bench.run_until([&] {
    while (sent < count && bench.waiting("in") < 4) {
      CurveRegisters d = curve.random_start();
      const std::uint64_t steps = random() % (longest + 1);
      const std::uint64_t mark = mark_of(++r.curves);
      bench.send("in", ports(d, steps, mark));
      for (std::uint64_t n = 0; n <= steps; ++n) {
        expected.push_back(ports(d, n == steps ? 1 : 0, mark));
        curve.advance(d);
      }
      sent += steps + 1;
    }
    return r.points == sent && sent >= count;
  });
  return r;
}

// `count` points of curves of up to `longest` steps, without gaps and stalls. Returns the clocks.
std::uint64_t stream_curves(const Config& c, Random& random, std::uint64_t count, unsigned longest) {
  struct Given {
    CurveRegisters d;
    std::uint64_t left, mark;
  };
  const CurvePorts curve(c, random);
  std::deque<Given> given;  // on their way
  std::uint64_t sent = 0, curves = 0;
  const auto offer = [&](std::span<std::uint64_t> in) {
    if (sent == count) return false;
    const std::uint64_t steps = std::min<std::uint64_t>(random() % (longest + 1), count - sent - 1);
    const Given& g = given.emplace_back(curve.random_start(), steps, mark_of(++curves));
    curve.put(in, g.d, steps, g.mark);
    sent += steps + 1;
    return true;
  };
  const auto expect = [&](std::span<std::uint64_t> out) {
    Given& g = given.at(0);
    curve.put(out, g.d, g.left == 0 ? 1 : 0, g.mark);
    if (g.left-- == 0) {
      given.pop_front();
    } else {
      curve.advance(g.d);
    }
  };
  return run_stream(design_of(c), {offer, expect, count});
}

void check(const Config& config, std::uint64_t seed, std::size_t count) {
  SCOPED_TRACE(fmt::format("{}, seed {}", config.name, seed));
  Random random(seed);
  const StageStalls conditions[] = {{0, 0}, {0.3, 0}, {0, 0.4}, {0.3, 0.3}};
  for (const StageStalls& stalls : conditions) {
    const CurveRun r = run_curves(config, random, count, 20, stalls);
    EXPECT_GE(r.points, count);
    EXPECT_GT(r.curves, count / 40);
  }
}

TEST(ForwardDifferenceRtl, Shipped) { check(shipped_config("depth16"), 31, is_long_run() ? 200'000 : 3000); }

// In the long form more than 10^8 steps, a point per clock from the second clock on.
TEST(ForwardDifferenceRtl, ManySteps) {
  constexpr std::uint64_t seed = 32;
  SCOPED_TRACE(seed);
  Random random(seed);
  const std::uint64_t count = is_long_run() ? 101'000'000 : 50'000;
  EXPECT_EQ(stream_curves(shipped_config("depth16"), random, count, 4096), count + 2);
}

TEST(ForwardDifferenceRtl, Random) {
  for (int n = 0; n < (is_long_run() ? 20 : 2); ++n) {
    const auto seed = static_cast<std::uint64_t>(n) + 51;
    check(random_curve_config(seed), seed, 1200);
  }
}

// A point per clock, from the second clock after the offer on, and no gap between curves.
TEST(ForwardDifferenceRtl, Clocks) {
  Random random(33);
  const CurveRun r = run_curves(shipped_config("depth16"), random, 2000, 6, {});
  EXPECT_EQ(r.first_out, r.offered + 2);
  EXPECT_EQ(r.last_out, r.first_out + r.points - 1);
}

TEST(ForwardDifferenceRtl, ResetAmidCurves) {
  Random random(34);
  for (const int clocks : {1, 2, 7}) {
    EXPECT_GE(run_curves(shipped_config("depth16"), random, 300, 9, {0.2, 0.3}, nullptr, clocks).points,
              300U);
  }
}

TEST(ForwardDifferenceRtl, IcarusAndYosysAgree) {
  Random random(35);
  StageTrace trace;
  const Config config = random_curve_config(77);
  run_curves(config, random, 80, 9, {0.2, 0.3}, &trace);
  expect_tools_agree(design_of(config), trace);
}

TEST(ForwardDifferenceRtl, PlantedBugsAreSeen) {
  constexpr PlantedBug bugs[] = {
      {"rtl/forward_difference.sv", ".step_i(out_d2_o),", ".step_i(sum_d2),"},
      {"rtl/forward_difference.sv", ".StepFrac(bitspan_curve_pkg::CurveD1Frac),",
       ".StepFrac(bitspan_curve_pkg::CurveD0Frac),"},
      {"rtl/forward_difference.sv", "(out_ready_i && out_last_o);", "out_ready_i;"},
      {"rtl/forward_difference.sv", "(out_ready_i && out_last_o);", "out_last_o;"},
      {"rtl/forward_difference.sv", "left_q <= left_q - StepsW'(1);", "left_q <= left_q;"},
      {"rtl/forward_difference.sv", "out_valid_o <= next_valid;", "out_valid_o <= 1'b1;"},
      {"rtl/forward_difference.sv", "assign out_last_o = left_q == '0;", "assign out_last_o = left_q[0];"},
      {"rtl/accumulate.sv", "assign sum = acc + step;", "assign sum = acc - step;"},
  };
  Config config = shipped_config("depth16");
  config.format(FormatId::curve_d1) = {40, 8, true, Rounding::rnd, Overflow::sat, false};
  const auto run = [&] {
    Random random(36);
    run_curves(config, random, 2000, 9, {0.2, 0.4});
  };
  run();
  expect_seen(bugs, run);
}

}  // namespace
}  // namespace bitspan
