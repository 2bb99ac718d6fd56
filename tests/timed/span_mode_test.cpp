// SPDX-License-Identifier: Apache-2.0
// Span mode against cycle mode: every number of the report, every counter, the frame and the trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "config/check.hpp"
#include "config/config.hpp"
#include "config/modes.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/random_config.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// What the runs compared have in them together, for equality to mean something.
struct Totals {
  std::uint64_t runs = 0, cycles = 0, fragments = 0, records = 0;
  std::uint64_t blocked = 0, memory = 0, misses = 0, full_fifos = 0, killed = 0, uncovered = 0;
  std::uint64_t stencilled = 0;  // fragments that met a stencil test
  std::int64_t late = 0;         // changes of state to late tests
  std::uint64_t combined = 0;    // fragments in the second texture unit

  void print() const {
    std::cout << "equal: " << runs << " runs, " << cycles << " clocks, " << fragments << " fragments, "
              << records << " records; in them " << blocked << " clocks of a stage blocked, " << memory
              << " waiting for memory, " << full_fifos << " FIFOs full, " << misses << " cache misses, "
              << killed << " fragments killed, " << uncovered << " not covered, " << stencilled
              << " stencil tests\n";
  }
};

void expect_equal_reports(const TimedReport& span, const TimedReport& cycle, Totals& totals) {
  EXPECT_EQ(span.cycles, cycle.cycles);
  EXPECT_EQ(span.cache_hits, cycle.cache_hits);
  EXPECT_EQ(span.cache_misses, cycle.cache_misses);
  EXPECT_TRUE(span.caches == cycle.caches);
  EXPECT_EQ(span.memory.reads, cycle.memory.reads);
  EXPECT_EQ(span.memory.writes, cycle.memory.writes);
  EXPECT_EQ(span.memory.beats, cycle.memory.beats);
  EXPECT_EQ(span.interpolator_exact, cycle.interpolator_exact);
  EXPECT_EQ(span.span_setup_latency, cycle.span_setup_latency);
  EXPECT_EQ(span.span_latency, cycle.span_latency);
  ASSERT_EQ(span.stages.size(), cycle.stages.size());
  for (std::size_t i = 0; i < cycle.stages.size(); ++i) {
    const StageReport& s = span.stages[i];
    const StageReport& c = cycle.stages[i];
    EXPECT_EQ(s.name, c.name);
    EXPECT_EQ(s.busy, c.busy) << c.name;
    EXPECT_EQ(s.starved, c.starved) << c.name;
    EXPECT_EQ(s.blocked, c.blocked) << c.name;
    EXPECT_EQ(s.memory, c.memory) << c.name;
    EXPECT_EQ(s.records_in, c.records_in) << c.name;
    EXPECT_EQ(s.records_out, c.records_out) << c.name;
    EXPECT_EQ(s.fifo_capacity, c.fifo_capacity) << c.name;
    EXPECT_EQ(s.fifo_high_water, c.fifo_high_water) << c.name;
    totals.blocked += c.blocked;
    totals.memory += c.memory;
    totals.full_fifos += c.fifo_capacity > 0 && c.fifo_high_water == c.fifo_capacity ? 1 : 0;
  }
  totals.cycles += cycle.cycles;
  totals.misses += cycle.cache_misses;
}

// Draws the scene in both modes, `batch` triangles per call (0: all), and compares after each call. Span mode
// with a trace, and without: then its values come another way where the configuration has a vector form.
void expect_equal_modes(const Config& config, const Scene& scene, std::size_t batch, Totals& totals) {
  const auto cycle = make_systemc(config);
  const auto span = make_systemc(config, {.mode = TimedMode::span});
  const auto bare = make_systemc(config, {.mode = TimedMode::span});
  Trace of_cycle;
  Trace of_span;
  cycle->begin(scene);
  span->begin(scene);
  bare->begin(scene);
  const std::vector<Triangle>& all = scene.triangles;
  const std::size_t step = batch == 0 ? all.size() : batch;
  for (std::size_t i = 0; i < all.size(); i += step) {
    const std::size_t part = std::min(step, all.size() - i);
    draw_scene(*cycle, scene, i, part, &of_cycle);
    draw_scene(*span, scene, i, part, &of_span);
    draw_scene(*bare, scene, i, part, nullptr);
    expect_equal_reports(span->report(), cycle->report(), totals);
    SCOPED_TRACE("without a trace");
    expect_equal_reports(bare->report(), cycle->report(), totals);
    if (testing::Test::HasFailure()) return;
  }
#define BITSPAN_EXPECT_EQUAL(Record, LIST, stage, member)  \
  EXPECT_TRUE(of_span.member == of_cycle.member) << stage; \
  totals.records += of_cycle.member.size();
  BITSPAN_RECORDS(BITSPAN_EXPECT_EQUAL)
#undef BITSPAN_EXPECT_EQUAL
  expect_same_frame(span->frame(), cycle->frame());
  expect_same_frame(bare->frame(), cycle->frame());
  const Counters& counters = cycle->counters();
  EXPECT_TRUE(span->counters() == counters);
  EXPECT_TRUE(bare->counters() == counters);
  ++totals.runs;
  totals.fragments += counters.fragments;
  totals.killed += counters.killed;
  totals.uncovered += counters.fragments - counters.covered;
  totals.stencilled += of_cycle.stencil.size();
  totals.late += std::ranges::count(of_cycle.state, 1, &StateRecord::depth_when);
  totals.combined += of_cycle.texture_second.size();
}

// Each number of the timing on its own: mostly small, sometimes large.
void randomize_timing(Config& config, Random& random) {
  const auto pick = [&](int small, int large) {
    return static_cast<int>(random.integer(1, random.chance(0.15) ? large : small));
  };
  const auto stage = [&] {
    return StageTiming{.latency = pick(6, 40), .interval = pick(2, 9), .fifo = pick(4, 60)};
  };
  for (StageTiming& timing : config.timing) timing = stage();
  if (random.chance(0.2)) config.timing.fill(stage());
  if (random.chance(0.2)) {
    for (StageTiming& timing : config.timing) timing.interval = 1;
  }
  MemoryTiming& memory = config.memory;
  memory.latency = pick(12, 200);
  memory.width_bytes = 1 << random.integer(0, random.chance(0.2) ? 10 : 5);
  const int line = 1 << random.integer(2, random.chance(0.2) ? 12 : 7);
  memory.cache_line_bytes = std::max(memory.width_bytes, line);
  memory.cache_sets = 1 << random.integer(0, 6);
  memory.cache_ways = static_cast<int>(random.integer(1, 4));
  for (BufferCache* cache : {&memory.depth_cache, &memory.color_cache}) {
    cache->mode = static_cast<BufferCacheMode>(random.integer(0, 2));
    cache->line_bytes = memory.cache_line_bytes;
    cache->sets = 1 << random.integer(0, 5);
    cache->ways = static_cast<int>(random.integer(1, 4));
    cache->hash = random.chance(0.5) ? SetHash::none : SetHash::xor_upper;
  }
  config.row_reciprocal.pipelined = random.chance(0.5);
  config.pixel_reciprocal.pipelined = random.chance(0.7);
}

// Triangles over the same few pixels, some translucent, some textured: what has to wait for one another.
Scene crowded_scene(std::uint64_t seed, int triangles) {
  Random random(seed);
  return random_scene(seed, {.width = 40,
                             .height = 30,
                             .triangles = triangles,
                             .size_min = 4,
                             .size_max = 40,
                             .texture_size_max = random.chance(0.5) ? 8 : 64,
                             .translucent_probability = random.unit()});
}

Scene sparse_scene(std::uint64_t seed, int triangles) {
  return random_scene(seed, {.width = 160, .height = 120, .triangles = triangles, .size_max = 90});
}

// Both, in one call or in batches of some triangles.
void expect_equal_modes_on_a_random_scene(const Config& config, std::uint64_t seed, Random& random,
                                          Totals& totals) {
  const Scene scene = random.chance(0.6) ? crowded_scene(seed, 40) : sparse_scene(seed, 12);
  const std::size_t batch = random.chance(0.5) ? 0 : static_cast<std::size_t>(random.integer(1, 9));
  expect_equal_modes(config, scene, batch, totals);
}

TEST(SpanMode, EqualsCycleModeOnTheDemo) {
  Totals totals;
  const Scene scene = demo_scene(128, 96);
  for (const std::string& name : shipped_names) {
    for (const Perspective mode : all_perspectives) {
      Config config = shipped_config(name);
      config.perspective = mode;
      SCOPED_TRACE(name + " " + std::string(to_string(mode)));
      expect_equal_modes(config, scene, 0, totals);
    }
  }
  EXPECT_GT(totals.fragments, 150000U);
  EXPECT_GT(totals.uncovered, 20U);
  EXPECT_GT(totals.misses, 10000U);
  totals.print();
}

TEST(SpanMode, EqualsCycleModeUnderRandomTimings) {
  Totals totals;
  for (std::uint64_t seed = 1; seed <= 160; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Config config = shipped_config(seed % 3 == 0 ? "depth20" : seed % 3 == 1 ? "depth16" : "narrow");
    config.perspective = all_perspectives[seed / 3 % 4];
    config.filter = random.chance(0.5) ? TextureFilter::nearest : TextureFilter::bilinear;
    config.wrap = random.chance(0.5) ? TextureWrap::cyclic : TextureWrap::clamp;
    randomize_timing(config, random);
    expect_equal_modes_on_a_random_scene(config, seed, random, totals);
    if (HasFailure()) return;
  }
  EXPECT_EQ(totals.runs, 160U);
  EXPECT_GT(totals.records, 400000U);
  EXPECT_GT(totals.blocked, 1000000U);
  EXPECT_GT(totals.memory, 1000000U);
  EXPECT_GT(totals.misses, 10000U);
  EXPECT_GT(totals.killed, 100U);
  EXPECT_GT(totals.full_fifos, 500U);
  EXPECT_GT(totals.uncovered, 200U);
  totals.print();
}

TEST(SpanMode, EqualsCycleModeOnRandomConfigurations) {
  Totals totals;
  const std::vector<Config> bases = shipped_configs();
  std::uint64_t refused = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Config config = random_config(seed, bases);
    randomize_timing(config, random);
    if (first_violation(config)) {  // a reciprocal of some kinds cannot be one at a time
      ++refused;
      continue;
    }
    try {
      expect_equal_modes_on_a_random_scene(config, seed, random, totals);
    } catch (const InputError&) {
      ++refused;  // the scene's range is not the configuration's: no engine draws it
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(totals.runs, 30U);
  EXPECT_EQ(totals.runs + refused, 60U);
  totals.print();
}

// The order of the tests changes between draws; so does what a fragment asks of the memory.
TEST(SpanMode, EqualsCycleModeThroughChangesOfState) {
  Totals totals;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Config config = shipped_config(seed % 3 == 0 ? "depth20" : seed % 3 == 1 ? "depth16" : "narrow");
    config.perspective = all_perspectives[seed / 3 % 4];
    config.filter = random.chance(0.5) ? TextureFilter::nearest : TextureFilter::bilinear;
    const bool chains = random.chance(0.3);
    if (chains) {
      config.mip = MipMode::linear;
      config.lod = has_linear_edges(config.perspective) ? LodMode::zone_s : LodMode::gradient;
    }
    randomize_timing(config, random);
    const Scene scene = random_scene(seed, {.width = 40,
                                            .height = 30,
                                            .triangles = 60,
                                            .size_min = 4,
                                            .size_max = 40,
                                            .mip_chains = chains,
                                            .command_probability = 0.2});
    expect_equal_modes(config, scene, random.chance(0.5) ? 0 : 7, totals);
    if (HasFailure()) return;
  }
  EXPECT_EQ(totals.runs, 60U);
  EXPECT_GT(totals.late, 250U);
  EXPECT_GT(totals.combined, 2000U);
  EXPECT_GT(totals.stencilled, 8000U);
  EXPECT_GT(totals.killed, 1000U);
  EXPECT_GT(totals.memory, 100000U);
  totals.print();
}

TEST(SpanMode, EqualsCycleModeAtTheEndsOfWhatIsLegal) {
  Totals totals;
  const Scene scene = crowded_scene(12, 5);
  for (const int latency : {1, 200}) {
    for (const int interval : {1, 50}) {
      for (const int fifo : {1, 65536}) {
        for (const int width : {1, 1024}) {
          for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
            Config config = shipped_config("depth16");
            config.filter = filter;
            config.timing.fill({.latency = latency, .interval = interval, .fifo = fifo});
            config.memory = {.latency = latency,
                             .width_bytes = width,
                             .cache_line_bytes = 1024,
                             .cache_sets = 1,
                             .cache_ways = 1};
            expect_equal_modes(config, scene, 0, totals);
          }
        }
      }
    }
  }
  EXPECT_EQ(totals.runs, 32U);
}

// Every fragment has to wait for the one before it, in depth and in merge.
TEST(SpanMode, EqualsCycleModeOnOnePixel) {
  Scene scene;
  scene.width = scene.height = 4;
  scene.s_min = 1;
  scene.s_max = 100;
  for (int i = 0; i < 60; ++i) {
    const double s = 50.0 - i / 2.0 + (i * 7 % 5);  // mostly nearer than the last
    const double alpha = i % 3 == 0 ? 1 : i % 3 == 1 ? 0.5 : 0;
    Triangle t;
    t.v[0] = {{1.25, 1.25, s}, {0, 0, {1, 0.5, i / 60.0, alpha}}};
    t.v[1] = {{2.25, 1.25, s}, {0, 0, {1, 0.5, i / 60.0, alpha}}};
    t.v[2] = {{1.25, 2.25, s}, {0, 0, {1, 0.5, i / 60.0, alpha}}};
    scene.triangles.push_back(t);
  }
  Totals totals;
  for (const int latency : {1, 2, 9}) {
    for (const int memory : {1, 2, 3, 30, 200}) {
      Config config = shipped_config("depth16");
      config.timing.fill({.latency = latency, .interval = 1, .fifo = 4});
      config.memory.latency = memory;
      expect_equal_modes(config, scene, 0, totals);
      expect_equal_modes(config, scene, 1, totals);
    }
  }
  EXPECT_GT(totals.killed, 100U);
  EXPECT_GT(totals.memory, 1000U);
}

TEST(SpanMode, EqualsCycleModeOnExtremeScenes) {
  Totals totals;
  for (Scene scene : extreme_scenes()) {
    if (scene.width > 2048) continue;  // minutes of clocks
    SCOPED_TRACE(scene.name);
    if (scene.triangles.size() > 40) scene.triangles.resize(40);
    for (const Perspective mode : {Perspective::delta_f, Perspective::const_depth_rows}) {
      Config config = shipped_config("depth16");
      config.perspective = mode;
      expect_equal_modes(config, scene, 0, totals);
    }
  }
  EXPECT_GE(totals.runs, 10U);
  totals.print();
}

// No row is asked for behind the last triangle that has an area: those triangles must be counted all the
// same, and must not be taken for ones of the next draw call.
TEST(SpanMode, CountsTrianglesWithoutAreaAtTheEndOfADraw) {
  Scene scene = sparse_scene(7, 3);
  Triangle flat = scene.triangles[0];
  flat.v[2] = flat.v[1];
  scene.triangles.insert(scene.triangles.begin() + 1, flat);
  scene.triangles.push_back(flat);
  scene.triangles.push_back(flat);
  Totals totals;
  for (const Perspective mode : all_perspectives) {
    Config config = shipped_config("depth16");
    config.perspective = mode;
    SCOPED_TRACE(to_string(mode));
    for (const std::size_t batch : {0, 1, 2, 4}) expect_equal_modes(config, scene, batch, totals);
    const auto span = make_systemc(config, {.mode = TimedMode::span});
    span->begin(scene);
    span->draw(scene.triangles, 0, nullptr);
    EXPECT_EQ(span->counters().triangles, 6U);
    EXPECT_EQ(span->counters().degenerate, 3U);
  }
}

TEST(SpanMode, TellsAStandstillOfTheSameClock) {
  Config config = shipped_config("depth16");
  config.memory.latency = 10000;
  const Scene scene = crowded_scene(4, 5);
  const auto complaint = [&](TimedMode mode) {
    const auto engine = make_systemc(config, {.mode = mode, .watchdog_clocks = 300});
    engine->begin(scene);
    std::string text;
    try {
      engine->draw(scene.triangles, 0, nullptr);
    } catch (const std::runtime_error& e) {
      text = e.what();
    }
    EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), std::logic_error);
    return text;
  };
  const std::string of_cycle = complaint(TimedMode::cycle);
  const std::string of_span = complaint(TimedMode::span);
  const std::string start = of_cycle.substr(0, of_cycle.find(": setup"));
  EXPECT_NE(start.find("nothing moved for 300 clocks, at clock "), std::string::npos) << of_cycle;
  EXPECT_EQ(of_span.substr(0, start.size()), start);
  for (const char* stage :
       {"setup", "edge_walk", "span_setup", "span ", "depth memory", "texture", "fog", "merge"}) {
    EXPECT_NE(of_span.find(stage), std::string::npos) << stage << ": " << of_span;
  }
  // By its own limit it does not bark, in spite of 10000 clocks without a movement.
  Totals totals;
  expect_equal_modes(config, scene, 0, totals);
}

TEST(SpanMode, TellsItsProgressOnTheSameClocks) {
  const Scene scene = demo_scene(320, 240);
  const auto told = [&](TimedMode mode) {
    std::vector<std::uint64_t> triangles;
    const auto engine =
        make_systemc(shipped_config("depth16"),
                     {.mode = mode, .progress = [&](std::uint64_t n) { triangles.push_back(n); }});
    engine->begin(scene);
    engine->draw(scene.triangles, 0, nullptr);
    return triangles;
  };
  const std::vector<std::uint64_t> of_cycle = told(TimedMode::cycle);
  EXPECT_FALSE(of_cycle.empty());
  EXPECT_EQ(told(TimedMode::span), of_cycle);
}

TEST(SpanMode, RefusesWhatItCannotShowAndWhatTheModelRefuses) {
  const Config config = shipped_config("depth16");
  EXPECT_THROW(make_systemc(config, {.mode = TimedMode::span, .vcd = "run.vcd"}), InputError);
  EXPECT_THROW(make_systemc(config, {.mode = TimedMode::span, .record_handshake = true}), InputError);

  Scene scene = sparse_scene(4, 3);
  const auto engine = make_systemc(config, {.mode = TimedMode::span});
  EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), std::logic_error);
  const double x = std::exchange(scene.triangles[1].v[2].x, std::nan(""));
  engine->begin(scene);
  EXPECT_THROW(engine->draw(scene.triangles, 0, nullptr), InputError);
  EXPECT_EQ(engine->counters().cycles, 0U);
  scene.triangles[1].v[2].x = x;
  engine->draw(scene.triangles, 0, nullptr);  // nothing had been drawn, so nothing is broken
  const std::uint64_t cycles = engine->counters().cycles;
  EXPECT_GT(cycles, 0U);
  engine->draw({}, 3, nullptr);
  EXPECT_EQ(engine->counters().cycles, cycles);
  EXPECT_TRUE(engine->handshake().empty());
  engine->begin(scene);
  EXPECT_EQ(engine->report().cycles, 0U);
  engine->draw(scene.triangles, 0, nullptr);
  EXPECT_EQ(engine->report().cycles, cycles);
}

}  // namespace
}  // namespace bitspan
