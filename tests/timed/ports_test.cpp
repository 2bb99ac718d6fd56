// SPDX-License-Identifier: Apache-2.0
// The timed model with the RTL's ports: both modes, the values, the numbers of its report. That its clocks
// are the RTL's is tested where there is RTL: tests/rtl/pixel_chain_timing_test.cpp and bitspan verify.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "config/check.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/random_config.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

SystemcOptions with_ports(const PortTiming& ports, TimedMode mode = TimedMode::span) {
  SystemcOptions options;
  options.mode = mode;
  options.memory = TimedMemory::ports;
  options.ports = ports;
  return options;
}

struct Outcome {
  TimedReport report;
  Counters counters;
  Frame frame;
  Trace trace;
};

// With the scene's commands; `batch` triangles per call; 0: all.
Outcome run(const Config& config, const Scene& scene, const SystemcOptions& options, std::size_t batch = 0) {
  const auto engine = make_systemc(config, options);
  Outcome r;
  engine->begin(scene);
  const std::size_t all = scene.triangles.size();
  const std::size_t step = batch == 0 ? all : batch;
  for (std::size_t i = 0; i < all; i += step) {
    draw_scene(*engine, scene, i, std::min(step, all - i), &r.trace);
  }
  r.report = engine->report();
  r.counters = engine->counters();
  r.frame = engine->frame();
  return r;
}

void expect_same_records(const Outcome& a, const Outcome& b) {
#define BITSPAN_EXPECT_EQUAL(Record, LIST, stage, member) \
  EXPECT_TRUE(a.trace.member == b.trace.member) << stage;
  BITSPAN_RECORDS(BITSPAN_EXPECT_EQUAL)
#undef BITSPAN_EXPECT_EQUAL
  expect_same_frame(a.frame, b.frame);
}

void expect_consistent(const Outcome& r, const Config& config) {
  std::uint64_t moved = 0;
  for (const StageReport& s : r.report.stages) {
    EXPECT_EQ(s.busy + s.starved + s.blocked + s.memory, r.report.cycles) << s.name;
    moved += s.busy;
  }
  EXPECT_GT(moved, 0U);
  const Counters& c = r.counters;
  ASSERT_EQ(r.report.stages.size(), 8U);
  EXPECT_EQ(r.report.stages[4].records_in, c.covered - c.masked);
  EXPECT_EQ(r.report.stages[4].records_out, c.depth_passed);
  EXPECT_EQ(r.report.stages[5].records_in, c.depth_passed);
  EXPECT_EQ(r.report.stages[5].records_out, c.written);
  EXPECT_EQ(r.report.stages[7].records_out, c.written);
  const bool mixes = has_levels_in_rtl(config) && mixes_levels(config.mip);
  ASSERT_EQ(r.report.ports.size(), mixes ? 10U : 6U);
  EXPECT_EQ(r.report.ports[z_port].requests, c.covered);
  EXPECT_EQ(r.report.ports[z_port].writes, c.written);
  EXPECT_EQ(r.report.ports[color_port].writes, c.written);
  EXPECT_LE(r.report.ports[color_port].requests, c.written);
  EXPECT_EQ(r.report.memory.reads + r.report.memory.writes + r.report.cache_hits, 0U);
}

TEST(Ports, BothModesAreEqualAndTheValuesAreTheBuss) {
  std::vector<Config> configs = shipped_configs();
  for (std::uint64_t seed = 1; configs.size() < 9; ++seed) {
    RandomConfigOptions options;
    Config c = random_config(seed, shipped_configs(), options);
    c.pixel_reciprocal.pipelined = true;
    if (!first_violation(c) && pixel_stages_are_in_rtl(c)) configs.push_back(c);
  }
  configs.push_back(shipped_config("depth16"));
  configs.back().perspective = Perspective::const_depth_rows;
  for (const LodMode lod : {LodMode::zone_s, LodMode::gradient}) {
    for (const MipMode mip : {MipMode::nearest, MipMode::linear}) {
      configs.push_back(shipped_config("depth16"));
      configs.back().mip = mip;
      configs.back().lod = lod;
      configs.back().lod_first = 300;
    }
  }
  configs.push_back(shipped_config("depth16"));
  configs.back().fog = FogMode::vertex;
  std::uint64_t seed = 1;
  std::uint64_t uncovered = 0;
  std::uint64_t next_levels = 0;
  for (const Config& config : configs) {
    SCOPED_TRACE(config.name);
    const Scene scene = random_scene(
        seed, {.width = 64, .height = 48, .triangles = 14, .size_max = 40, .mip_chains = has_lod(config)});
    Outcome bus;
    try {
      bus = run(config, scene, {.mode = TimedMode::span});
    } catch (const InputError&) {
      continue;  // the scene's range does not fit
    }
    for (const PortTiming& ports : {PortTiming{}, {9, 9, 0, 1}, {1, 40, 0.3, seed}}) {
      for (const std::size_t batch : {std::size_t{0}, std::size_t{3}}) {
        const Outcome span = run(config, scene, with_ports(ports), batch);
        const Outcome cycle = run(config, scene, with_ports(ports, TimedMode::cycle), batch);
        EXPECT_EQ(span.report.cycles, cycle.report.cycles);
        for (std::size_t i = 0; i < cycle.report.stages.size(); ++i) {
          EXPECT_EQ(span.report.stages[i].busy, cycle.report.stages[i].busy);
          EXPECT_EQ(span.report.stages[i].blocked, cycle.report.stages[i].blocked);
          EXPECT_EQ(span.report.stages[i].memory, cycle.report.stages[i].memory);
        }
        expect_same_records(span, bus);
        expect_same_records(cycle, bus);
        expect_consistent(span, config);
        uncovered += span.counters.fragments - span.counters.covered;
        if (span.report.ports.size() > 6) next_levels += span.report.ports[6].requests;
      }
    }
    ++seed;
  }
  EXPECT_GT(seed, 5U);
  EXPECT_GT(uncovered, 10U);
  EXPECT_GT(next_levels, 100U);
}

StateSetting setting(const char* key, std::int64_t value) { return {*find_state_register(key), value}; }

// Which planes are written, and which pixels.
TEST(Ports, DrawState) {
  const Config config = shipped_config("depth16");
  Scene scene = random_scene(4, {.width = 64, .height = 48, .triangles = 20, .size_max = 40});
  scene.commands = {{3, StateChange{false, {setting("depth.write", 0), setting("depth.bias", 300)}}},
                    {6, StateChange{false, {setting("color.write", 0), setting("depth.write", 1)}}},
                    {9, StateChange{true, {setting("stipple", 0x5aa55aa5), setting("scissor.left", 9)}}},
                    {12, Clear{{}, {}, true, {}}},
                    {13, Target{2}},
                    {14, StateChange{false, {setting("depth.func", static_cast<int>(DepthFunc::always))}}}};
  const Outcome bus = run(config, scene, {.mode = TimedMode::span});
  for (const PortTiming& ports : {PortTiming{}, {1, 40, 0.3, 5}}) {
    const Outcome span = run(config, scene, with_ports(ports));
    const Outcome cycle = run(config, scene, with_ports(ports, TimedMode::cycle), 6);
    EXPECT_EQ(span.report.cycles, run(config, scene, with_ports(ports, TimedMode::cycle)).report.cycles);
    expect_same_records(span, bus);
    expect_same_records(cycle, bus);
    for (const Outcome* r : {&span, &cycle}) {
      EXPECT_GT(r->counters.masked, 20U);
      EXPECT_EQ(r->report.stages[4].records_in, r->counters.covered - r->counters.masked);
      EXPECT_LT(r->report.ports[z_port].writes, r->counters.written);
      EXPECT_LT(r->report.ports[color_port].writes, r->counters.written);
    }
  }
  scene.commands = {
      {3, StateChange{false, {setting("target.format", static_cast<int>(TargetFormat::rgb565))}}}};
  EXPECT_THROW(run(config, scene, with_ports({})), InputError);
  scene.textures.resize(1, Texture{.name = "one", .width = 1, .height = 1, .rgba = {1, 2, 3, 255}});
  for (Triangle& t : scene.triangles) t.texture = -1;
  scene.commands = {{3, StateChange{false, {setting("texture1", 0)}}}};
  EXPECT_THROW(run(config, scene, with_ports({})), InputError);
}

// Both orders of tests in one scene, with alpha and stencil test.
TEST(Ports, LateTests) {
  const Config config = shipped_config("depth16");
  Scene scene = random_scene(4, {.width = 64, .height = 48, .triangles = 24, .size_max = 40});
  const auto increment = static_cast<std::int64_t>(StencilOp::increment);
  scene.commands = {
      {2, StateChange{false, {setting("depth.when", 1), setting("alpha.func", 4), setting("alpha.ref", 60)}}},
      {6, StateChange{false,
                      {setting("stencil.test", 1), setting("stencil.pass", increment),
                       setting("stencil.zfail", increment), setting("stencil.func", 6),
                       setting("stencil.ref", 1)}}},
      {12, Clear{{}, {}, true, 0}},
      {14, StateChange{true, {setting("alpha.func", 1), setting("alpha.ref", 200)}}},
      {18, StateChange{true,
                       {setting("depth.when", 1), setting("stencil.test", 1), setting("stencil.func", 1)}}}};
  const Outcome bus = run(config, scene, {.mode = TimedMode::span});
  for (const PortTiming& ports : {PortTiming{}, {1, 40, 0.3, 5}}) {
    const Outcome span = run(config, scene, with_ports(ports));
    const Outcome cycle = run(config, scene, with_ports(ports, TimedMode::cycle), 5);
    EXPECT_EQ(span.report.cycles, run(config, scene, with_ports(ports, TimedMode::cycle)).report.cycles);
    expect_same_records(span, bus);
    expect_same_records(cycle, bus);
    for (const Outcome* r : {&span, &cycle}) {
      Counters counters = r->counters;
      counters.cycles = bus.counters.cycles;
      EXPECT_EQ(counters, bus.counters);
      EXPECT_GT(counters.stencil_failed, 20U);
      EXPECT_GT(counters.killed, 20U);
      EXPECT_EQ(r->report.stages[4].records_in, r->trace.depth.size());
      EXPECT_EQ(r->report.stages[4].records_out, counters.depth_passed);
      EXPECT_EQ(r->report.stages[5].records_in, r->trace.texture.size());
      EXPECT_EQ(r->report.stages[7].records_out, counters.written);
      EXPECT_EQ(r->report.ports[z_port].requests, r->trace.depth.size());
      EXPECT_GT(r->trace.stencil.size(), 50U);
    }
  }
}

// With rtl.blend = equation, any blend: which fragments read the stored colour, the new alpha, a clock more.
TEST(Ports, AnyBlend) {
  Config config = shipped_config("depth16");
  Scene scene = demo_scene(96, 72);
  const auto number = [](auto name) { return static_cast<std::int64_t>(name); };
  scene.commands = {{0, StateChange{false, {setting("blend.dst", number(BlendFactor::zero))}}},
                    {150, StateChange{false,
                                      {setting("blend.op", number(BlendOp::max)),
                                       setting("blend.alpha.op", number(BlendOp::min))}}},
                    {300, StateChange{false, {setting("logic.op", number(LogicOp::copy_inverted))}}},
                    {450, StateChange{true, {setting("logic.op", number(LogicOp::equiv))}}}};
  EXPECT_THROW(run(config, scene, with_ports({})), InputError);
  config.rtl.blend = RtlBlend::equation;
  const Outcome bus = run(config, scene, {.mode = TimedMode::span});
  EXPECT_GT(bus.trace.merge_alpha.size(), 500U);
  for (const PortTiming& ports : {PortTiming{}, {1, 40, 0.3, 5}}) {
    const Outcome span = run(config, scene, with_ports(ports));
    expect_same_records(span, bus);
    expect_same_records(run(config, scene, with_ports(ports, TimedMode::cycle), 100), bus);
    std::uint64_t reads = 0;
    for (const MergeRecord& r : bus.trace.merge) {
      reads += (r.triangle >= 150 && r.triangle < 300) || r.triangle >= 450 ? 1 : 0;
    }
    EXPECT_GT(reads, 500U);
    EXPECT_LT(reads, bus.trace.merge.size() - 500);
    EXPECT_EQ(span.report.ports[color_port].requests, reads);
  }
  scene.commands.clear();
  const std::uint64_t by_equation = run(config, scene, with_ports({})).report.cycles;
  config.rtl.blend = RtlBlend::alpha;
  EXPECT_GT(by_equation, run(config, scene, with_ports({})).report.cycles);
}

TEST(Ports, TheSeedDecides) {
  const Config config = shipped_config("depth16");
  const Scene scene = demo_scene(160, 120);
  const auto cycles = [&](const PortTiming& ports) {
    return run(config, scene, with_ports(ports)).report.cycles;
  };
  const PortTiming random{.least = 1, .most = 40, .stall = 0.2, .seed = 3};
  PortTiming other = random;
  other.seed = 4;
  EXPECT_EQ(cycles(random), cycles(random));
  EXPECT_NE(cycles(random), cycles(other));
}

// The memory's latency alone costs its clocks once; stalls and latencies beyond the fragments in flight cost
// throughput.
TEST(Ports, WhatMemoryCosts) {
  const Config config = shipped_config("depth16");
  Scene scene;
  scene.width = 200;
  scene.height = 60;
  scene.s_min = 1;
  scene.s_max = 2;
  Triangle triangle;
  triangle.v[0] = {0, 0, 1, 0, 0, {1, 1, 1, 1}};
  triangle.v[1] = {400, 0, 2, 8, 0, {1, 0, 1, 1}};
  triangle.v[2] = {0, 120, 1.5, 0, 8, {1, 1, 0, 1}};
  scene.triangles = {triangle};
  const auto of = [&](const PortTiming& ports) { return run(config, scene, with_ports(ports)); };
  const Outcome ideal = of({});
  const std::uint64_t pixels = ideal.counters.covered;
  ASSERT_EQ(pixels, 200U * 60U);
  // Rows follow one another, one pixel per clock.
  const PixelTiming t = pixel_timing(config);
  EXPECT_LE(ideal.report.cycles, pixels + 300);
  EXPECT_GE(ideal.report.cycles,
            pixels + static_cast<std::uint64_t>(t.depth.total + t.texture.total + t.fog.total));
  EXPECT_EQ(of({12, 12, 0, 1}).report.cycles, ideal.report.cycles + 11);
  EXPECT_GT(of({200, 200, 0, 1}).report.cycles, 3 * ideal.report.cycles);
  const Outcome stalled = of({1, 1, 0.5, 1});
  EXPECT_GT(stalled.report.cycles, ideal.report.cycles * 3 / 2);
  EXPECT_GT(stalled.report.ports[z_port].stalled, ideal.report.cycles / 4);
  EXPECT_EQ(ideal.report.ports[z_port].stalled, 0U);
}

TEST(Ports, Refused) {
  const Config config = shipped_config("depth16");
  for (const PortTiming& ports :
       {PortTiming{0, 1, 0, 1}, {3, 2, 0, 1}, {1, 10001, 0, 1}, {1, 1, -0.1, 1}, {1, 1, 1.0, 1}}) {
    EXPECT_THROW(make_systemc(config, with_ports(ports)), InputError);
  }
  Config no_rtl = config;
  no_rtl.depth_code = DepthCode::linear;
  no_rtl.perspective = Perspective::affine;
  no_rtl.pixel_reciprocal.pipelined = false;
  const auto engine = make_systemc(no_rtl, with_ports({}));
  EXPECT_THROW(engine->begin(demo_scene(32, 24)), InputError);
}

// A port that never answers in time is a deadlock, told with the stages' states.
TEST(Ports, TheWatchdogTellsTheStates) {
  SystemcOptions options = with_ports({9000, 9000, 0, 1});
  const Scene scene = demo_scene(32, 24);
  EXPECT_NO_THROW(run(shipped_config("depth16"), scene, options));
  options.watchdog_clocks = 500;
  try {
    run(shipped_config("depth16"), scene, options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("depth memory"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bitspan
