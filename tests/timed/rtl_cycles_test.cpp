// SPDX-License-Identifier: Apache-2.0
// The span interpolator's clocks against the Verilated RTL's: in_ready and out_valid on every clock.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "model/timed/span_interpolator_timing.hpp"
#include "scene/random.hpp"
#include "tb/rtl_stream.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

struct Case {
  std::string name;
  std::string base;  // shipped configuration
  Perspective mode = Perspective::delta_f;
  bool pipelined = true;
  ReciprocalKind row = ReciprocalKind::restoring;
  RowSlope row_slope = RowSlope::reciprocal;
  bool shades = true;
  FogMode fog = FogMode::none;
  bool lines = false;  // every second triangle is one
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

Config make_config(const Case& c) {
  Config config = shipped_config(c.base);
  config.perspective = c.mode;
  config.row_slope = c.row_slope;
  config.rtl.shades = c.shades;
  config.fog = c.fog;
  if (c.lines) config.line_walk = LineForm::dda;
  config.row_reciprocal.pipelined = c.pipelined;
  config.row_reciprocal.kind = c.row;
  if (c.row != ReciprocalKind::restoring) {
    config.row_reciprocal.operand_bits = 12;
    config.row_reciprocal.index_bits = 6;
    config.row_reciprocal.table_bits = 14;
    config.row_reciprocal.internal_bits = 18;
    config.row_reciprocal.steps = c.row == ReciprocalKind::lut_newton ? 1 : 0;
  }
  check_config(config, c.name);
  return config;
}

void add_lines(Scene& scene, const Case& c) {
  for (std::size_t i = 0; c.lines && i < scene.triangles.size(); i += 2) {
    scene.triangles[i].is_line = true;
    scene.triangles[i].v[2] = scene.triangles[i].v[1];
  }
}

// What the RTL is offered of a trace: its rows, in order.
std::vector<RtlInputs> inputs_of(const Config& config, const Trace& trace) {
  const std::int64_t b = trace.constants.front().b;
  std::vector<RtlInputs> inputs;
  std::size_t line = 0;
  for (const RowRecord& row : trace.row) {
    for (; line < trace.line_walk.size() && trace.line_walk[line].triangle < row.triangle; ++line) {
      inputs.push_back(rtl_inputs(config, trace.line_walk[line], b));
    }
    inputs.push_back(rtl_inputs(config, row, b));
  }
  for (; line < trace.line_walk.size(); ++line) {
    inputs.push_back(rtl_inputs(config, trace.line_walk[line], b));
  }
  std::size_t plane = 0;
  for (const PlaneRowRecord& row : trace.plane_row) {
    while (trace.plane[plane].triangle != row.triangle) ++plane;
    inputs.push_back(rtl_inputs(config, row, trace.plane[plane].k, b));
  }
  return inputs;
}

class RtlCycles : public testing::TestWithParam<Case> {
 protected:
  static void SetUpTestSuite() {
    // Libraries built here stay in the build folder, unless the environment says where.
    setenv("BITSPAN_CACHE", build_path("rtl-cache").c_str(), 0);
  }
};

TEST_P(RtlCycles, EqualOnEveryClockUnderRandomGapsAndStalls) {
  const Config config = make_config(GetParam());
  Rtl rtl(config);
  std::uint64_t clocks = 0;
  std::uint64_t refused = 0;
  std::uint64_t stalled = 0;
  std::uint64_t seed = 1;
  for (const double size : {2.0, 12.0, 120.0}) {
    Scene scene = random_scene(seed, {.width = 128, .height = 64, .triangles = 20, .size_max = size});
    add_lines(scene, GetParam());
    Trace trace;
    const auto model = make_model(config);
    model->begin(scene);
    model->draw(scene.triangles, 0, &trace);
    const std::vector<RtlInputs> inputs = inputs_of(config, trace);
    for (const double gap : {0.0, 0.5, 0.95}) {
      for (const double stall : {0.0, 0.3, 0.9}) {
        rtl.reset();
        const RtlRun run = run_rtl(rtl, inputs, {.seed = seed++, .in_gap = gap, .out_stall = stall}, true);
        SpanInterpolatorTiming timing(interpolator_latency(config));
        std::size_t accepted = 0;
        std::size_t taken = 0;
        for (std::size_t t = 0; t < run.handshakes.size(); ++t) {
          const RtlHandshake& h = run.handshakes[t];
          const auto count = accepted < trace.span.size() ? trace.span[accepted].count : 0;
          const InterpolatorClock c = timing.clock(h.in_valid, count, h.out_ready);
          ASSERT_EQ(c.in_ready, h.in_ready) << "clock " << t << " gap " << gap << " stall " << stall;
          ASSERT_EQ(c.out_valid, h.out_valid) << "clock " << t << " gap " << gap << " stall " << stall;
          if (c.take) {
            ASSERT_LT(taken, run.taken_at.size());
            ASSERT_EQ(run.taken_at[taken++], t);
          }
          accepted += c.accept ? 1 : 0;
          refused += h.in_valid && !h.in_ready ? 1 : 0;
          stalled += h.out_valid && !h.out_ready ? 1 : 0;
        }
        EXPECT_EQ(accepted, inputs.size());
        EXPECT_EQ(taken, inputs.size());
        EXPECT_TRUE(timing.idle());
        clocks += run.handshakes.size();
      }
    }
  }
  EXPECT_GT(clocks, 10000U);
  EXPECT_GT(refused, 1000U);
  EXPECT_GT(stalled, 1000U);
  RecordProperty("clocks", std::to_string(clocks));
}

TEST_P(RtlCycles, TheSystemcRunsHandshakeReplaysThroughTheRtl) {
  Config config = make_config(GetParam());
  config.memory.width_bytes = 2;  // a slow memory: many stalls
  Scene scene = random_scene(99, {.width = 96, .height = 64, .triangles = 20, .size_max = 60});
  add_lines(scene, GetParam());
  const auto engine = make_systemc(config, {.record_handshake = true});
  Trace trace;
  engine->begin(scene);
  engine->draw(scene.triangles, 0, &trace);
  std::vector<RtlHandshake> driven;
  std::uint64_t stalled = 0;
  for (const HandshakeClock& h : engine->handshake()) {
    driven.push_back({h.in_valid, h.in_ready, h.out_valid, h.out_ready});
    stalled += h.out_valid && !h.out_ready ? 1 : 0;
  }
  EXPECT_GT(stalled, 100U);
  Rtl rtl(config);
  rtl.reset();
  const RtlRun run = replay_rtl(rtl, inputs_of(config, trace), driven);
  ASSERT_EQ(run.handshakes.size(), driven.size());
  for (std::size_t t = 0; t < driven.size(); ++t) {
    ASSERT_TRUE(run.handshakes[t] == driven[t]) << "clock " << t;
  }
  ASSERT_EQ(run.pixels.size(), trace.fragment.size());
  for (std::size_t i = 0; i < run.pixels.size(); ++i) {
    const FragmentRecord got = fragment_record(config, run.pixels[i]);
    ASSERT_EQ(got.h, trace.fragment[i].h);
    ASSERT_EQ(got.u, trace.fragment[i].u);
    ASSERT_EQ(got.v, trace.fragment[i].v);
    ASSERT_EQ(got.last, trace.fragment[i].last);
    if (config.rtl.shades) {
      ASSERT_EQ(got.r, trace.fragment[i].r);
      ASSERT_EQ(got.a, trace.fragment[i].a);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Configurations, RtlCycles,
    testing::Values(Case{.name = "depth16_one_at_a_time", .base = "depth16", .pipelined = false},
                    Case{.name = "depth20_pipelined", .base = "depth20"},
                    Case{.name = "narrow_lut_linear", .base = "narrow", .row = ReciprocalKind::lut_linear},
                    Case{.name = "rows_divided", .base = "depth16", .row_slope = RowSlope::divide},
                    Case{.name = "constant_depth", .base = "depth16", .mode = Perspective::const_depth_rows},
                    Case{.name = "without_shades", .base = "depth16", .shades = false},
                    Case{.name = "channel", .base = "depth16", .fog = FogMode::vertex},
                    Case{.name = "lines", .base = "depth16", .lines = true},
                    Case{.name = "hyperbolic", .base = "depth16", .mode = Perspective::hyperbolic},
                    Case{.name = "hyperbolic_divided",
                         .base = "narrow",
                         .mode = Perspective::hyperbolic,
                         .row_slope = RowSlope::divide},
                    Case{.name = "affine", .base = "depth16", .mode = Perspective::affine},
                    Case{.name = "affine_divided",
                         .base = "depth16",
                         .mode = Perspective::affine,
                         .row_slope = RowSlope::divide,
                         .shades = false},
                    Case{.name = "constant_depth_one_at_a_time",
                         .base = "narrow",
                         .mode = Perspective::const_depth_rows,
                         .pipelined = false,
                         .row = ReciprocalKind::lut_newton}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace bitspan
