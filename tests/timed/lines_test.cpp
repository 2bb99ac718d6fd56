// SPDX-License-Identifier: Apache-2.0
// Lines in the timed model: every record is the functional model's, both modes agree on the clock, and
// triangles take the clocks that they took without lines.
#include <gtest/gtest.h>

#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "scene/random.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

Scene scene_of(std::uint64_t seed, double lines) {
  Scene scene = random_scene(
      seed, {.width = 96, .height = 64, .triangles = 40, .size_max = 80, .command_probability = 0.1});
  Random random(seed);
  draw_lines(random, scene, lines);
  return scene;
}

Config with(LineForm walk) {
  Config c = shipped_config("depth16");
  c.line_walk = walk;
  return c;
}

Trace draw_all(Engine& engine, const Scene& scene) {
  Trace out;
  engine.begin(scene);
  draw_scene(engine, scene, 0, scene.triangles.size(), &out);
  return out;
}

TEST(TimedLines, EqualTheModelInBothModes) {
  std::size_t lines = 0;
  for (const LineForm walk : {LineForm::exact, LineForm::dda}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Config c = with(walk);
      const Scene scene = scene_of(seed, 0.6);
      const auto model = make_model(c);
      const auto cycle = make_systemc(c, {.mode = TimedMode::cycle});
      const auto span = make_systemc(c, {.mode = TimedMode::span});
      const Trace expected = draw_all(*model, scene);
      for (Engine* engine : {cycle.get(), span.get()}) {
        const Trace got = draw_all(*engine, scene);
#define BITSPAN_EXPECT_EQUAL(Record, LIST, name, member) EXPECT_TRUE(got.member == expected.member) << name;
        BITSPAN_RECORDS(BITSPAN_EXPECT_EQUAL)
#undef BITSPAN_EXPECT_EQUAL
        expect_same_frame(engine->frame(), model->frame());
        Counters counters = engine->counters();
        counters.cycles = 0;
        EXPECT_TRUE(counters == model->counters());
      }
      EXPECT_EQ(cycle->counters().cycles, span->counters().cycles);
      // Span mode without a trace.
      span->begin(scene);
      draw_scene(*span, scene, 0, scene.triangles.size(), nullptr);
      EXPECT_EQ(cycle->counters().cycles, span->counters().cycles);
      expect_same_frame(span->frame(), model->frame());
      lines += expected.line_walk.size();
    }
  }
  EXPECT_GT(lines, 60U);
}

TEST(TimedLines, LeaveTheClocksOfTrianglesAsTheyAre) {
  const Scene scene = scene_of(4, 0);
  const auto clocks = [&](LineForm walk) {
    const auto engine = make_systemc(with(walk), {.mode = TimedMode::cycle});
    draw_all(*engine, scene);
    return engine->counters().cycles;
  };
  EXPECT_EQ(clocks(LineForm::exact), clocks(LineForm::none));
  EXPECT_EQ(clocks(LineForm::dda), clocks(LineForm::none));
}

TEST(TimedLines, ALineIsARowOfTheWalk) {
  // Alone, a line of n pixels takes one clock per pixel and the latencies of the stages, as a row of a
  // triangle does.
  Scene scene = scene_of(5, 0);
  scene.commands.clear();
  const auto clocks = [&](double length) {
    Triangle line;
    line.is_line = true;
    for (Vertex& v : line.v) {
      v.x = v.y = 3.5;
      v.s = scene.s_min;
    }
    line.v[1].x = line.v[2].x = 3.5 + length;
    line.v[1].y = line.v[2].y = 3.5 + length / 2;
    scene.triangles = {line};
    const auto engine = make_systemc(with(LineForm::exact), {.mode = TimedMode::cycle});
    draw_all(*engine, scene);
    EXPECT_EQ(engine->counters().fragments, static_cast<std::uint64_t>(length) + 1);
    return engine->counters().cycles;
  };
  const std::uint64_t of_20 = clocks(20), of_50 = clocks(50);
  EXPECT_GE(of_50, of_20 + 30);
  EXPECT_LE(of_50, of_20 + 60);  // the memory takes its part
}

}  // namespace
}  // namespace bitspan
