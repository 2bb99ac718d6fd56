// SPDX-License-Identifier: Apache-2.0
// The SystemC engine: every record equal to the functional model's under any timing, and what its numbers
// promise.
#include "model/timed/engine_systemc.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "config/config.hpp"
#include "model/engine_model.hpp"
#include "model/timed/span_interpolator_timing.hpp"
#include "model/timed/stage_timings.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/texels.hpp"
#include "tests/support/files.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"
#include "tests/timed/square_half.hpp"

namespace bitspan {
namespace {

// Every FIFO, latency, interval of a configuration alike; the memory too.
void set_timing(Config& config, int latency, int interval, int fifo, const MemoryTiming& memory) {
  config.timing.fill({.latency = latency, .interval = interval, .fifo = fifo});
  config.memory = memory;
}

Scene small_scene(std::uint64_t seed, int triangles = 24) {
  return random_scene(seed, {.width = 96, .height = 64, .triangles = triangles, .size_max = 60});
}

struct Outcome {
  Trace trace;
  Frame frame;
  Counters counters;
};

Outcome draw_all(Engine& engine, const Scene& scene) {
  Outcome out;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &out.trace);
  out.frame = engine.frame();
  out.counters = engine.counters();
  return out;
}

// All records, the frame and the counters but the cycles; returns the number of records compared.
std::size_t expect_equal(const Outcome& timed, const Outcome& model) {
  std::size_t compared = 0;
#define BITSPAN_EXPECT_EQUAL(Record, LIST, stage, member)                   \
  EXPECT_EQ(timed.trace.member.size(), model.trace.member.size()) << stage; \
  EXPECT_TRUE(timed.trace.member == model.trace.member) << stage;           \
  compared += model.trace.member.size();
  BITSPAN_RECORDS(BITSPAN_EXPECT_EQUAL)
#undef BITSPAN_EXPECT_EQUAL
  expect_same_frame(timed.frame, model.frame);
  Counters counters = timed.counters;
  counters.cycles = model.counters.cycles;
  EXPECT_TRUE(counters == model.counters);
  return compared;
}

void expect_consistent(const TimedReport& report, const Counters& counters) {
  EXPECT_EQ(report.cycles, counters.cycles);
  ASSERT_EQ(report.stages.size(), 8U);
  for (const StageReport& stage : report.stages) {
    EXPECT_EQ(stage.busy + stage.starved + stage.blocked + stage.memory, report.cycles) << stage.name;
    EXPECT_LE(stage.fifo_high_water, stage.fifo_capacity) << stage.name;
    EXPECT_GE(stage.busy, stage.records_out > 0 ? 1U : 0U) << stage.name;
  }
  const auto in = [&](std::size_t i) { return report.stages[i].records_in; };
  const auto out = [&](std::size_t i) { return report.stages[i].records_out; };
  for (std::size_t i = 0; i + 1 < report.stages.size(); ++i) {
    EXPECT_EQ(out(i), in(i + 1)) << report.stages[i].name;
  }
  EXPECT_EQ(in(0), counters.triangles);
  EXPECT_EQ(out(0), counters.triangles - counters.degenerate);
  EXPECT_EQ(out(1), counters.rows);
  EXPECT_EQ(out(3), counters.fragments);
  EXPECT_EQ(out(4), counters.depth_passed);
  EXPECT_EQ(out(5), counters.depth_passed - counters.killed);
  EXPECT_EQ(out(7), counters.written);
}

TEST(EngineSystemc, EqualsTheModelInEveryModeUnderManyTimings) {
  std::size_t compared = 0;
  std::uint64_t seed = 1;
  for (const std::string& name : shipped_names) {
    for (const Perspective mode : all_perspectives) {
      for (const int fifo : {1, 2, 1000}) {
        Config config = shipped_config(name);
        config.perspective = mode;
        const int latency = 1 + static_cast<int>(seed % 9);
        const int interval = 1 + static_cast<int>(seed % 4);
        set_timing(config, latency, interval, fifo,
                   {.latency = 1 + static_cast<int>(seed * 7 % 50),
                    .width_bytes = 1 << (seed % 6),
                    .cache_line_bytes = 32 << (seed % 3),
                    .cache_sets = 1 << (seed % 5),
                    .cache_ways = 1 + static_cast<int>(seed % 3)});
        config.filter = seed % 2 == 0 ? TextureFilter::nearest : TextureFilter::bilinear;
        config.wrap = seed % 3 == 0 ? TextureWrap::clamp : TextureWrap::cyclic;
        config.row_reciprocal.pipelined = seed % 2 == 0;
        config.pixel_reciprocal.pipelined = seed % 5 != 0;
        const Scene scene = small_scene(seed);
        SCOPED_TRACE(std::string(name) + " " + std::string(to_string(mode)) + " seed " +
                     std::to_string(seed));
        ++seed;
        const auto model = make_model(config);
        const auto timed = make_systemc(config);
        const Outcome outcome = draw_all(*timed, scene);
        compared += expect_equal(outcome, draw_all(*model, scene));
        expect_consistent(timed->report(), outcome.counters);
      }
    }
  }
  EXPECT_GT(compared, 100000U);
}

TEST(EngineSystemc, EqualsTheModelOnTheDemo) {
  const Scene scene = demo_scene(160, 120);
  for (const Perspective mode : all_perspectives) {
    Config config = shipped_config("depth16");
    config.perspective = mode;
    SCOPED_TRACE(to_string(mode));
    const auto model = make_model(config);
    const auto timed = make_systemc(config);
    const Outcome outcome = draw_all(*timed, scene);
    EXPECT_GT(expect_equal(outcome, draw_all(*model, scene)), 50000U);
    expect_consistent(timed->report(), outcome.counters);
    EXPECT_TRUE(timed->report().interpolator_exact);
  }
}

// The same pixel drawn over and over: each fragment has to see the depth and the colour of the one before.
TEST(EngineSystemc, FragmentsOfOnePixelWaitForEachOther) {
  Scene scene;
  scene.width = scene.height = 4;
  scene.s_min = 1;
  scene.s_max = 100;
  for (int i = 0; i < 40; ++i) {
    const double s = 50.0 - i + (i * 7 % 5);  // mostly nearer than the last, not always
    Triangle t;
    t.v[0] = {{1.25, 1.25, s}, {0, 0, {1, 0.5, i / 40.0, 0.5}}};
    t.v[1] = {{2.25, 1.25, s}, {0, 0, {1, 0.5, i / 40.0, 0.5}}};
    t.v[2] = {{1.25, 2.25, s}, {0, 0, {1, 0.5, i / 40.0, 0.5}}};
    scene.triangles.push_back(t);
  }
  Config config = shipped_config("depth16");
  set_timing(config, 9, 1, 8, {.latency = 30, .width_bytes = 8});
  const auto model = make_model(config);
  const auto timed = make_systemc(config);
  const Outcome outcome = draw_all(*timed, scene);
  expect_equal(outcome, draw_all(*model, scene));
  EXPECT_GT(outcome.counters.written, 3U);
  EXPECT_LT(outcome.counters.written, outcome.counters.covered);
  EXPECT_GT(timed->report().stages[4].memory, 30U);
}

TEST(EngineSystemc, OneTriangleByHand) {
  const Scene scene = square_half();  // offered at clock 0
  Config config = shipped_config("depth16");
  set_timing(config, 1, 1, 4, {.latency = 1, .width_bytes = 1024});
  config.row_reciprocal.pipelined = true;
  config.rtl.setup_multipliers = 16;  // a row each clock
  config.rtl.fifo = 2;
  const InterpolatorLatency latency = interpolator_latency(config);
  const auto engine = make_systemc(config);
  const Outcome outcome = draw_all(*engine, scene);
  ASSERT_EQ(outcome.counters.rows, 4U);
  ASSERT_EQ(outcome.counters.written, 10U);
  // Source pushes at 0, setup accepts at 1 and delivers at 2, edge_walk accepts at 3 and delivers its first
  // row at 4, span_setup accepts at 5: in the FIFO at 5 + LS, taken a clock later, the first pixel issued a
  // clock after that, the last of ten nine clocks later, in front of the output's buffer LP later, and out a
  // clock later.
  const auto last_pixel = std::uint64_t{5} + static_cast<std::uint64_t>(latency.span_setup) + 1 + 1 + 9 +
                          static_cast<std::uint64_t>(latency.span) + 1;
  // Then each of four stages accepts a clock after the delivery and delivers its latency later. The first
  // fragment asks for the depth word, which is there before its latency is over. Merge's first fragment has
  // two writes, and the next waits a clock for the second. The count is one more than the last clock's
  // number.
  std::uint64_t stages = 0;
  for (const Stage stage : {Stage::depth, Stage::texture, Stage::fog, Stage::merge}) {
    stages +=
        1 + static_cast<std::uint64_t>(timed::stage_timings(config)[static_cast<std::size_t>(stage)].latency);
  }
  EXPECT_EQ(outcome.counters.cycles, last_pixel + stages + 1 + 1);
  const TimedReport report = engine->report();
  EXPECT_EQ(report.stages[2].busy, 4U);
  EXPECT_EQ(report.stages[3].busy, 10U);
  EXPECT_EQ(report.memory.reads, 1U);   // the depth word
  EXPECT_EQ(report.memory.writes, 2U);  // colour and depth words
}

TimedReport report_of(const Config& config, const Scene& scene, TimedMode mode) {
  const auto engine = make_systemc(config, {.mode = mode});
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  return engine->report();
}

const std::vector<std::pair<std::string, std::int64_t>> late_tests{{"depth.when", 1}};

// A fragment reads the texels of the filter and of the levels that it takes, by either unit: what fetches the
// same texels takes the same clocks.
TEST(EngineSystemc, ReadsTheTexelsOfTheLevelAndFilterTaken) {
  Config config = shipped_config("depth16");
  config.filter = TextureFilter::nearest;
  config.mip = MipMode::linear;
  config.lod = LodMode::none;
  const Scene plain = random_scene(3, {.width = 64,
                                       .height = 48,
                                       .triangles = 30,
                                       .size_min = 8,
                                       .size_max = 60,
                                       .uv_limit = 40,
                                       .textures = 2,
                                       .mip_chains = true});
  ASSERT_FALSE(plain.textures.empty());
  using Registers = std::vector<std::pair<std::string, std::int64_t>>;
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    for (const bool of_second : {false, true}) {
      SCOPED_TRACE(of_second);
      const std::string unit = of_second ? "texture1." : "texture.";
      const auto report = [&](const Registers& registers) {
        StateChange change;
        const auto set = [&](const std::string& key, std::int64_t value) {
          change.settings.push_back({*find_state_register(key), value});
        };
        if (of_second) set("texture1", 0);
        for (const auto& [key, value] : registers) set(unit + key, value);
        Scene scene = plain;
        scene.commands = {{0, change}};
        const TimedReport r = report_of(config, scene, mode);
        return std::pair(r.cache_hits + r.cache_misses, r.cycles);
      };
      const auto nearest = report({}), bilinear = report({{"filter", 1}});
      EXPECT_LT(nearest.first, bilinear.first);
      EXPECT_EQ(report({{"magnify", 2}}), bilinear);
      EXPECT_EQ(report({{"filter", 1}, {"magnify", 1}}), nearest);
      EXPECT_EQ(report({{"magnify", 2}, {"level.least", 1}}), report({{"level.least", 1}}));
      const auto both = report({{"lod.bias", 8}});
      EXPECT_LT(nearest.first, both.first);
      EXPECT_EQ(report({{"lod.bias", 8}, {"magnify", 2}}), both);
      EXPECT_EQ(report({{"lod.bias", 8}, {"level.greatest", 0}}), nearest);
      EXPECT_EQ(report({{"lod.bias", 8}, {"level.greatest", 0}, {"magnify", 2}}), bilinear);
    }
  }
}

TEST(EngineSystemc, LateTestsByHand) {
  Config config = shipped_config("depth16");
  set_timing(config, 1, 1, 4, {.latency = 1, .width_bytes = 1024});
  config.row_reciprocal.pipelined = true;
  config.rtl.setup_multipliers = 16;
  config.rtl.fifo = 2;
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    const auto report = [&](const Scene& scene) { return report_of(config, scene, mode); };
    const auto in_state = [](std::vector<std::pair<std::string, std::int64_t>> state) {
      state.insert(state.end(), late_tests.begin(), late_tests.end());
      return state;
    };
    const TimedReport early = report(square_half({}));
    // The same stages in another order, and the change itself takes no clock.
    const TimedReport late = report(square_half(late_tests));
    EXPECT_EQ(late.cycles, early.cycles);
    EXPECT_EQ(late.memory.reads, 1U);
    EXPECT_EQ(late.memory.writes, 2U);
    EXPECT_EQ(late.stages[4].name, "depth");
    EXPECT_EQ(late.stages[4].records_in, 10U);
    EXPECT_EQ(late.stages[5].records_in, 10U);

    // The first fragment asks for the depth word and the stencil word, and writes the latter: two clocks on
    // which no other one enters depth. The others follow one by one; so merge's second write costs no clock.
    const TimedReport stencil = report(
        square_half(in_state({{"stencil.test", 1}, {"stencil.ref", 1}, {"stencil.pass", 2}})));  // replace
    EXPECT_EQ(stencil.cycles, early.cycles + 1);
    EXPECT_EQ(stencil.memory.reads, 2U);
    EXPECT_EQ(stencil.memory.writes, 3U);
    EXPECT_EQ(stencil.stages[4].memory, 2U);
    // The plane keeps what it has: no write.
    const TimedReport kept = report(square_half(in_state({{"stencil.test", 1}})));
    EXPECT_EQ(kept.memory.reads, 2U);
    EXPECT_EQ(kept.memory.writes, 2U);

    // What texture kills reads no depth code behind it, and one in front of it.
    const TimedReport killed_early = report(square_half({}, 0));
    EXPECT_EQ(killed_early.memory.reads, 1U);
    EXPECT_EQ(killed_early.stages[4].records_in, 10U);
    const TimedReport killed_late = report(square_half(late_tests, 0));
    EXPECT_EQ(killed_late.memory.reads, 0U);
    EXPECT_EQ(killed_late.stages[4].records_in, 0U);
    EXPECT_EQ(killed_late.stages[5].records_out, 0U);
    EXPECT_LT(killed_late.cycles, late.cycles);

    // What fails the depth test has had its texels looked up; what is masked has not.
    const TimedReport behind = report(square_half(in_state({{"depth.func", 0}})));  // never
    EXPECT_EQ(behind.stages[5].records_out, 10U);
    EXPECT_EQ(behind.stages[4].records_out, 0U);
    const TimedReport masked = report(square_half(in_state({{"scissor.right", 1}})));
    EXPECT_EQ(masked.stages[5].records_in, 10U);
    EXPECT_EQ(masked.stages[5].records_out, 4U);
    EXPECT_EQ(masked.stages[4].records_in, 4U);
  }
}

// With the stencil test a fragment that fails changes the plane, too: the next one of its pixel enters depth
// when it has left, one clock later. Without it nothing waits for a fragment that fails.
TEST(EngineSystemc, StencilTestsOfOnePixelWaitForEachOther) {
  Config config = shipped_config("depth16");
  set_timing(config, 1, 1, 4, {.latency = 1, .width_bytes = 1024});
  config.row_reciprocal.pipelined = true;
  config.rtl.setup_multipliers = 16;  // a row each clock
  const auto latency = static_cast<std::uint64_t>(
      timed::stage_timings(config)[static_cast<std::size_t>(Stage::depth)].latency);
  const auto with_stencil = [](bool test) {
    std::vector<std::pair<std::string, std::int64_t>> state = late_tests;
    state.emplace_back("depth.func", 0);  // never
    state.emplace_back("stencil.test", test ? 1 : 0);
    state.emplace_back("stencil.zfail", 3);  // increment
    return state;
  };
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    const auto cycles = [&](bool test, std::size_t triangles) {
      Scene scene = square_half(with_stencil(test));
      Triangle& t = scene.triangles[0];
      t.v[0] = {{1.25, 1.25, 50}, {}};
      t.v[1] = {{2.25, 1.25, 50}, {}};
      t.v[2] = {{1.25, 2.25, 50}, {}};
      for (Vertex& v : t.v) v.c = {1, 1, 1, 1};
      scene.triangles.resize(triangles, Triangle(t));
      return report_of(config, scene, mode).cycles;
    };
    EXPECT_EQ(cycles(true, 60) - cycles(true, 40), 20 * (latency + 1));
    EXPECT_LT(cycles(false, 60) - cycles(false, 40), 20 * (latency + 1));
  }
}

// Front and back faces count in the plane in ways of their own.
TEST(EngineSystemc, TestsTheStencilOfEitherSide) {
  const Config config = shipped_config("depth16");
  Scene scene =
      random_scene(31, {.width = 96, .height = 64, .triangles = 40, .size_min = 20, .size_max = 60});
  const StateChange change = state_change({{"depth.when", 1},
                                           {"stencil.test", 1},
                                           {"stencil.pass", 3},  // increment
                                           {"stencil.two_sided", 1},
                                           {"stencil.back.zfail", 3},
                                           {"stencil.back.pass", 2}});  // replace
  scene.commands.insert(scene.commands.begin(), {0, change});
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    const Outcome model = draw_all(*make_model(config), scene);
    EXPECT_GT(expect_equal(draw_all(*make_systemc(config, {.mode = mode}), scene), model), 1000U);
    EXPECT_GT(std::ranges::count(model.trace.stencil, 0, &StencilRecord::back), 100);
    EXPECT_GT(std::ranges::count(model.trace.stencil, 1, &StencilRecord::back), 100);
  }
}

TEST(EngineSystemc, SlowerIsNeverFaster) {
  const Scene scene = small_scene(77, 40);
  const auto cycles = [&](const Config& config) {
    const auto engine = make_systemc(config);
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    return engine->report().cycles;
  };
  Config base = shipped_config("depth16");
  // Wide memory: what limits is the stage under test.
  set_timing(base, 2, 1, 4, {.latency = 4, .width_bytes = 64});
  const std::uint64_t reference = cycles(base);
  for (const Stage stage :
       {Stage::setup, Stage::edge_walk, Stage::depth, Stage::texture, Stage::fog, Stage::merge}) {
    std::uint64_t previous = reference;
    for (const int interval : {2, 4, 9}) {
      Config config = base;
      config.timing[static_cast<std::size_t>(stage)].interval = interval;
      const std::uint64_t now = cycles(config);
      EXPECT_GE(now, previous) << to_string(stage) << " interval " << interval;
      previous = now;
    }
    const bool follows_the_rtl = stage != Stage::setup && stage != Stage::edge_walk;
    if (follows_the_rtl) {
      EXPECT_EQ(previous, reference) << to_string(stage);
    }
    previous = reference;
    for (const int latency : {5, 20, 100}) {
      Config config = base;
      config.timing[static_cast<std::size_t>(stage)].latency = latency;
      const std::uint64_t now = cycles(config);
      EXPECT_GE(now, previous) << to_string(stage) << " latency " << latency;
      previous = now;
    }
    if (follows_the_rtl) {
      EXPECT_EQ(previous, reference) << to_string(stage);
    }
  }
  // A unit that is not pipelined takes a fragment per latency.
  for (const bool in_fog : {false, true}) {
    Config pipelined = base;
    if (in_fog) pipelined.fog = FogMode::linear;
    if (!in_fog) pipelined.depth_code = DepthCode::linear;
    pipelined.perspective = Perspective::affine;  // whose span takes no reciprocal
    Config one_at_a_time = pipelined;
    one_at_a_time.pixel_reciprocal.pipelined = false;
    EXPECT_GT(cycles(one_at_a_time), 2 * cycles(pipelined));
  }
  std::uint64_t previous = reference;
  for (const int width : {8, 2, 1}) {
    Config config = base;
    config.memory.width_bytes = width;
    const std::uint64_t now = cycles(config);
    EXPECT_GT(now, previous) << "width " << width;
    previous = now;
  }
  Config one = base;
  for (StageTiming& timing : one.timing) timing.fifo = 1;
  EXPECT_GT(cycles(one), reference);
}

TEST(EngineSystemc, AFrameInOneCallHasNoFlushAndTheClockGoesOn) {
  const Scene scene = small_scene(5, 30);
  const Config config = shipped_config("depth16");
  const auto whole = make_systemc(config);
  const auto pieces = make_systemc(config);
  const Outcome one = draw_all(*whole, scene);
  Outcome many;
  pieces->begin(scene);
  std::uint64_t previous = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); i += 7) {
    const std::size_t n = std::min<std::size_t>(7, scene.triangles.size() - i);
    pieces->draw({scene.triangles.data() + i, n}, static_cast<std::int64_t>(i), &many.trace);
    EXPECT_GT(pieces->counters().cycles, previous);
    previous = pieces->counters().cycles;
  }
  pieces->draw({}, 30, &many.trace);
  EXPECT_EQ(pieces->counters().cycles, previous);
  many.frame = pieces->frame();
  many.counters = pieces->counters();
  expect_equal(many, one);
  EXPECT_GT(many.counters.cycles, one.counters.cycles);
}

TEST(EngineSystemc, SeveralEnginesTakeTurnsAndBeginStartsAnew) {
  const Scene a = small_scene(8, 12);
  const Scene b = small_scene(9, 12);
  const Config config = shipped_config("depth16");
  const auto reference = make_model(config);
  const Outcome model_a = draw_all(*reference, a);
  const Outcome model_b = draw_all(*reference, b);
  const auto first = make_systemc(config);
  std::uint64_t cycles = 0;
  {
    const auto second = make_systemc(config);
    Outcome of_first;
    Outcome of_second;
    first->begin(a);
    second->begin(b);
    for (std::size_t i = 0; i < 12; i += 3) {
      first->draw({a.triangles.data() + i, 3}, static_cast<std::int64_t>(i), &of_first.trace);
      second->draw({b.triangles.data() + i, 3}, static_cast<std::int64_t>(i), &of_second.trace);
    }
    of_first.frame = first->frame();
    of_first.counters = first->counters();
    of_second.frame = second->frame();
    of_second.counters = second->counters();
    expect_equal(of_first, model_a);
    expect_equal(of_second, model_b);
  }
  for (int i = 0; i < 3; ++i) {
    const Outcome again = draw_all(*first, i % 2 == 0 ? b : a);
    expect_equal(again, i % 2 == 0 ? model_b : model_a);
    if (i == 0) cycles = again.counters.cycles;
    if (i == 2) {
      EXPECT_EQ(again.counters.cycles, cycles);
    }
  }
}

TEST(EngineSystemc, TheHandshakeIsTheInterpolatorsOnEveryClock) {
  for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
    Config config = shipped_config("depth16");
    config.perspective = mode;
    set_timing(config, 2, 1, 2, {.latency = 25, .width_bytes = 2});
    const Scene scene = small_scene(21, 30);
    const auto engine = make_systemc(config, {.record_handshake = true});
    const Outcome outcome = draw_all(*engine, scene);
    const auto& handshake = engine->handshake();
    ASSERT_EQ(handshake.size(), outcome.counters.cycles);
    SpanInterpolatorTiming alone(interpolator_latency(config));
    std::size_t spans = 0;
    std::uint64_t pixels = 0;
    std::uint64_t stalls = 0;
    for (const HandshakeClock& h : handshake) {
      const std::int64_t count = spans < outcome.trace.span.size() ? outcome.trace.span[spans].count : 0;
      const InterpolatorClock c = alone.clock(h.in_valid, count, h.out_ready);
      ASSERT_EQ(c.in_ready, h.in_ready);
      ASSERT_EQ(c.out_valid, h.out_valid);
      spans += c.accept ? 1 : 0;
      pixels += c.deliver ? 1 : 0;
      // A pixel may still go into span while one waits at the output, and none does where two wait.
      stalls += (c.span_held || (h.out_valid && !h.out_ready)) && !c.issue ? 1 : 0;
    }
    EXPECT_EQ(spans, outcome.counters.rows);
    EXPECT_EQ(pixels, outcome.counters.fragments);
    EXPECT_GT(stalls, 100U);
    EXPECT_EQ(engine->report().stages[3].blocked, stalls);
  }
  EXPECT_TRUE(make_systemc(shipped_config("depth16"))->name() == "systemc");
}

TEST(EngineSystemc, TheCacheSeesEachTexelAccess) {
  Config config = shipped_config("depth16");
  Scene scene = small_scene(3, 30);
  scene.textures = {{.name = "grey",
                     .width = 40,
                     .height = 30,
                     .rgba = std::vector<std::uint8_t>(std::size_t{40} * 30 * 4, 128)}};
  for (Triangle& t : scene.triangles) t.texture = 0;
  const auto accesses = [&](TextureFilter filter, int lines) {
    config.filter = filter;
    config.memory.cache_sets = lines;
    const auto engine = make_systemc(config);
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    TimedReport report = engine->report();
    EXPECT_EQ(report.cache_hits + report.cache_misses,
              engine->counters().depth_passed * (filter == TextureFilter::bilinear ? 4U : 1U));
    return report;
  };
  const TimedReport large = accesses(TextureFilter::nearest, 4096);
  const TimedReport small = accesses(TextureFilter::nearest, 1);
  accesses(TextureFilter::bilinear, 64);
  // Large enough for all: a miss a line at most.
  const auto lines =
      (scene.textures[0].rgba.size() + 63) / static_cast<std::size_t>(config.memory.cache_line_bytes) + 1;
  EXPECT_LE(large.cache_misses, lines);
  EXPECT_GT(small.cache_misses, large.cache_misses);
  EXPECT_GE(small.memory.reads, small.cache_misses);
}

// With the second texture unit each fragment looks two textures up, in both modes alike. Where both units
// show the same texture, the second one never misses.
TEST(EngineSystemc, BothTextureUnitsFetch) {
  Config config = shipped_config("depth16");
  config.memory.cache_sets = 4096;
  config.filter = TextureFilter::nearest;
  Scene scene = small_scene(3, 30);
  Texture image{.name = "image", .width = 64, .height = 64, .rgba = {}};
  for (std::size_t k = 0; k < std::size_t{64} * 64 * 4; ++k) {
    image.rgba.push_back(k % 4 == 3 ? 255 : static_cast<std::uint8_t>(k * k / 64));
  }
  scene.textures = {image, image};
  for (Triangle& t : scene.triangles) {
    t.texture = 0;
    for (Vertex& v : t.v) {
      v.u = v.x;
      v.v = v.y;
    }
  }
  const auto report = [&](int second, TimedMode mode) {
    scene.commands = {{0, StateChange{false, {{*find_state_register("texture1"), second}}}}};
    SystemcOptions options;
    options.mode = mode;
    const auto engine = make_systemc(config, options);
    engine->begin(scene);
    draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
    const std::uint64_t looked_up = engine->counters().depth_passed * (second < 0 ? 1U : 2U);
    const TimedReport out = engine->report();
    EXPECT_EQ(out.cache_hits + out.cache_misses, looked_up);
    return out;
  };
  for (const TimedMode mode : {TimedMode::cycle, TimedMode::span}) {
    const TimedReport off = report(-1, mode), same = report(0, mode), other = report(1, mode);
    EXPECT_GT(off.cache_misses, 20U);
    EXPECT_EQ(same.cache_misses, off.cache_misses);
    EXPECT_EQ(same.cycles, off.cycles);
    // The same lines once more, of another texture: each is a read, with its beats of the bus.
    EXPECT_EQ(other.cache_misses, 2 * off.cache_misses);
    EXPECT_EQ(other.memory.reads - off.memory.reads, off.cache_misses);
    EXPECT_EQ(other.memory.beats - off.memory.beats,
              off.cache_misses *
                  static_cast<std::uint64_t>(config.memory.cache_line_bytes / config.memory.width_bytes));
    EXPECT_GT(other.cycles, off.cycles);
    if (mode == TimedMode::span) {
      EXPECT_EQ(other.cycles, report(1, TimedMode::cycle).cycles);
    }
  }
}

// The cache holds all: each line that a texel of the model's records lies in misses once.
TEST(EngineSystemc, TexelsOfFewerBytesTakeFewerLines) {
  Config config = shipped_config("depth16");
  config.memory.cache_sets = 4096;
  config.filter = TextureFilter::nearest;
  config.wrap = TextureWrap::mirror;
  Scene scene = small_scene(3, 30);
  Texture image{.name = "image", .width = 64, .height = 64, .rgba = {}};
  for (std::size_t k = 0; k < std::size_t{64} * 64 * 4; ++k) {
    image.rgba.push_back(k % 4 == 3 ? 255 : static_cast<std::uint8_t>(k * k / 64));
  }
  for (Triangle& t : scene.triangles) {
    t.texture = 0;
    for (Vertex& v : t.v) {
      v.u = v.x;
      v.v = v.y;
    }
  }
  const auto misses = [&](TexelFormat format) {
    scene.textures = {converted(image, format, {})};
    const auto engine = make_systemc(config);
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    const TimedReport report = engine->report();
    EXPECT_EQ(report.cache_hits + report.cache_misses, engine->counters().depth_passed);
    Trace trace;
    const auto model = make_model(config);
    model->begin(scene);
    model->draw(scene.triangles, 0, &trace);
    std::set<std::size_t> lines;
    for (const TextureRecord& r : trace.texture) {
      lines.insert(block_at(format, 64, r.i, r.j) / static_cast<std::size_t>(config.memory.cache_line_bytes));
    }
    EXPECT_EQ(report.cache_misses, lines.size()) << to_string(format);
    return report.cache_misses;
  };
  const std::uint64_t plain = misses(TexelFormat::rgba8888);
  const std::uint64_t words = misses(TexelFormat::rgb565);
  const std::uint64_t bytes = misses(TexelFormat::i8);
  EXPECT_GT(plain, words + words / 3);
  EXPECT_GT(words, bytes + bytes / 3);
  EXPECT_EQ(misses(TexelFormat::uyvy), words);
  EXPECT_GT(bytes, misses(TexelFormat::dxt1) + misses(TexelFormat::dxt1) / 3);
  // Outside of the texture nothing is read.
  scene.textures = {image};
  for (Triangle& t : scene.triangles) {
    for (Vertex& v : t.v) v.u = -5;
  }
  config.wrap = TextureWrap::border;
  const auto engine = make_systemc(config);
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  EXPECT_GT(engine->counters().depth_passed, 100U);
  EXPECT_EQ(engine->report().cache_hits + engine->report().cache_misses, 0U);
}

TEST(EngineSystemc, WritesAWaveformOfEveryStage) {
  const TemporaryFolder folder;
  const Scene scene = small_scene(4, 3);
  const auto engine = make_systemc(shipped_config("depth16"), {.vcd = folder.path("run.vcd")});
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  engine->close_vcd();
  const std::string vcd = folder.read("run.vcd");
  for (const char* name : {"setup", "edge_walk", "span_interpolator", "span_setup", "span", "depth",
                           "texture", "fog", "merge"}) {
    EXPECT_NE(vcd.find("$scope module " + std::string(name) + " "), std::string::npos) << name;
  }
  // Rising edges of the clock, the last at (cycles - 1) ns.
  const std::uint64_t last = (engine->report().cycles - 1) * 1000;
  EXPECT_NE(vcd.find("#" + std::to_string(last) + "\n"), std::string::npos);
  EXPECT_EQ(vcd.find("#" + std::to_string(last + 1000) + "\n"), std::string::npos);
  EXPECT_EQ(folder.files(), 1);
}

TEST(EngineSystemc, TheWatchdogTellsTheStateOfEachStage) {
  Config config = shipped_config("depth16");
  config.memory.latency = 20000;
  const Scene scene = small_scene(4, 5);
  const auto engine = make_systemc(config, {.watchdog_clocks = 300});
  engine->begin(scene);
  std::string message;
  try {
    engine->draw(scene.triangles, 0, nullptr);
  } catch (const std::runtime_error& e) {
    message = e.what();
  }
  EXPECT_NE(message.find("nothing moved for 300 clocks"), std::string::npos) << message;
  EXPECT_NE(message.find("depth memory"), std::string::npos) << message;
  for (const char* stage : {"setup", "edge_walk", "span_setup", "span ", "texture", "fog", "merge"}) {
    EXPECT_NE(message.find(stage), std::string::npos) << stage;
  }
  EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), std::logic_error);
  // By its own limit it does not bark at all, and begin() makes the engine whole again.
  const auto patient = make_systemc(config);
  EXPECT_GT(draw_all(*patient, scene).counters.cycles, 20000U);
}

TEST(EngineSystemc, NoDeadlockAtTheEndsOfWhatIsLegal) {
  const Scene scene = small_scene(12, 6);
  for (const int latency : {1, 300}) {
    for (const int interval : {1, 50}) {
      for (const int width : {1, 1024}) {
        Config config = shipped_config("depth16");
        config.filter = TextureFilter::bilinear;
        set_timing(config, latency, interval, 1,
                   {.latency = latency,
                    .width_bytes = width,
                    .cache_line_bytes = 1024,
                    .cache_sets = 1,
                    .cache_ways = 1});
        const auto engine = make_systemc(config);
        const Outcome outcome = draw_all(*engine, scene);
        EXPECT_GT(outcome.counters.written, 0U);
        expect_consistent(engine->report(), outcome.counters);
      }
    }
  }
}

TEST(EngineSystemc, RefusesWhatTheModelRefuses) {
  Scene scene = small_scene(4, 3);
  scene.triangles[1].v[2].x = std::nan("");
  const auto engine = make_systemc(shipped_config("depth16"));
  EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), std::logic_error);
  engine->begin(scene);
  EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), InputError);
  EXPECT_EQ(engine->counters().cycles, 0U);
  scene.triangles[1].v[2].x = 5;
  engine->draw(scene.triangles, 0, nullptr);  // nothing had been drawn, so nothing is broken
  EXPECT_GT(engine->counters().cycles, 0U);
  EXPECT_THROW(make_systemc(shipped_config("depth16"), {.vcd = "/nonexistent/folder/run.vcd"})->begin(scene),
               InputError);
}

TEST(EngineSystemc, TellsItsProgress) {
  const Scene scene = demo_scene(320, 240);
  std::uint64_t told = 0;
  std::uint64_t last = 0;
  const auto engine = make_systemc(shipped_config("depth16"), {.progress = [&](std::uint64_t triangles) {
                                     ++told;
                                     EXPECT_GE(triangles, last);
                                     last = triangles;
                                   }});
  engine->begin(scene);
  engine->draw(scene.triangles, 0, nullptr);
  EXPECT_EQ(told, engine->report().cycles / 65536);
  EXPECT_GT(told, 0U);
  EXPECT_LE(last, scene.triangles.size());
}

}  // namespace
}  // namespace bitspan
