// SPDX-License-Identifier: Apache-2.0
// One point of a study: its numbers against the meters they come from, and what is no point.
#include "study/point.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <thread>

#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "report/error.hpp"
#include "scene/demo.hpp"
#include "scene/random.hpp"
#include "scene/shadow.hpp"
#include "study/truths.hpp"
#include "tests/report/shadow_scenes.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

const FieldError& field(const PointResult& point, std::string_view stage, std::string_view quantity) {
  for (const FieldError& f : point.fields) {
    if (f.stage == stage && f.quantity == quantity) return f;
  }
  throw std::out_of_range("field");
}
const RegisterUse& use_of(const PointResult& point, std::string_view name) {
  for (const RegisterUse& r : point.registers) {
    if (r.name == name) return r;
  }
  throw std::out_of_range("register");
}

TEST(Point, AgreesWithTheErrorMeter) {
  const Scene scene = demo_scene(160, 120);
  const Config config = shipped_config("depth16");
  const PointResult point = PointMeter({scene}).measure(config);
  const auto engine = make_model(config, {.form = ModelForm::scalar});
  engine->begin(scene);
  Trace trace;
  engine->draw(scene.triangles, 0, &trace);
  ErrorMeter meter(config, scene);
  meter.add(scene.triangles, 0, trace);
  for (const ErrorRow& row : meter.report().rows) {
    if (row.stat.count == 0 || row.stage == "picture") continue;
    const FieldError& f = field(point, row.stage, row.quantity);
    EXPECT_EQ(f.count, row.stat.count) << row.stage << ' ' << row.quantity;
    EXPECT_EQ(f.max, row.stat.max);
    const auto metric = [&](const char* statistic) {
      return point.metrics.at(row.stage + "." + row.quantity + "." + statistic);
    };
    EXPECT_NEAR(metric("rms"), row.stat.rms(), 1e-9 * row.stat.rms());
    EXPECT_EQ(metric("max"), f.max);
    EXPECT_LE(metric("mean"), metric("rms"));
    EXPECT_LE(metric("rms"), f.max);
    EXPECT_LE(metric("p999"), f.max);
    EXPECT_LE(std::fabs(metric("bias")), metric("mean"));
  }
}

// A picture with a shadow map, whose biases are those of the configuration.
TEST(Point, OfAShadowMapIsJudgedByRays) {
  Config config = shipped_config("depth16");
  config.project = ProjectUnit::reciprocal;
  const std::vector<Face> faces = box_above_floor();
  const auto lit = [&](std::optional<double> bias, int depth_bits) {
    Scene scene = shadowed(seen_scene(faces), faces,
                           {.light = {-7, -9, 8}, .size = 256, .bias = bias, .depth_bits = depth_bits});
    scene.name = "box";
    return scene;
  };
  const PointResult raised = PointMeter({lit(0, 16), demo_scene(64, 48)}).measure(config);
  EXPECT_GT(raised.metrics.at("shadow.unexplained"), 1000);
  EXPECT_EQ(raised.metrics.at("shadow.unexplained"), raised.scenes[0].metrics.at("shadow.unexplained"));
  EXPECT_FALSE(raised.scenes[1].metrics.contains("shadow.unexplained"));
  EXPECT_TRUE(std::isfinite(raised.scenes[0].metrics.at("picture.psnr_db")));
  EXPECT_FALSE(raised.scenes[0].metrics.contains("span.u.max"));
  EXPECT_TRUE(raised.metrics.contains("span.u.max"));
  EXPECT_GT(use_of(raised, "project.h").count, 0U);

  int loaded = 0;
  const LoadLit again = [&](const Scene& scene, const Config& of) {
    ++loaded;
    EXPECT_EQ(scene.name, "box");
    return lit({}, of.depth_bits);
  };
  const PointMeter meter({lit(0, 16), demo_scene(64, 48)}, half_of_memory(), again);
  const PointResult automatic = meter.measure(config);
  EXPECT_EQ(loaded, 1) << "of what is drawn in passes alone";
  EXPECT_EQ(automatic.metrics.at("shadow.unexplained"), 0);
  EXPECT_GT(automatic.metrics.at("shadow.edges"), 50);
  EXPECT_GT(automatic.metrics.at("shadow.judged"), 5000);
  EXPECT_EQ(meter.ideal(config, 0)->color, drawn(config, lit({}, 16), "ideal").color);

  config.project = ProjectUnit::none;
  expect_refusal([&] { meter.measure(config); }, "project.unit = reciprocal");
  Scene passes = demo_scene(64, 48);
  passes.commands.push_back({.before = 0, .what = ViewChange{}});
  expect_refusal([&] { PointMeter({passes}); },
                 "a study measures one view, or a picture with one shadow map");
}

// The metrics of each scene are those of a meter that has it alone.
TEST(Point, EachSceneHasItsMetrics) {
  const std::vector<Scene> scenes{demo_scene(96, 72), floor_scene(96, 72)};
  const Config config = shipped_config("depth16");
  const PointResult both = PointMeter(scenes).measure(config);
  ASSERT_EQ(both.scenes.size(), 2U);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const PointResult alone = PointMeter({scenes[i]}).measure(config);
    EXPECT_EQ(both.scenes[i].scene, scenes[i].name);
    EXPECT_FALSE(both.scenes[i].metrics.contains("cost.register_bits"));
    for (const auto& [name, value] : both.scenes[i].metrics) {
      EXPECT_EQ(value, alone.metrics.at(name)) << name;
    }
    EXPECT_GT(both.scenes[i].metrics.size(), 100U);
  }
  EXPECT_EQ(both.metrics.at("span.u.max"),
            std::max(both.scenes[0].metrics.at("span.u.max"), both.scenes[1].metrics.at("span.u.max")));
}

TEST(Point, RegistersSayWhatTheyHeld) {
  const PointResult point = PointMeter({demo_scene(160, 120)}).measure(shipped_config("depth16"));
  for (const RegisterUse& r : point.registers) {
    EXPECT_LE(r.min, r.max) << r.name;
    EXPECT_EQ(r.used_bits + r.headroom, r.format.integer) << r.name;
    const auto values = std::accumulate(r.octave.begin(), r.octave.end(), r.zeros);
    EXPECT_GT(values, 0U) << r.name << " was seen, and stands in some record";
  }
  // Values of 2^12 to 2^13: the octave that holds the largest magnitude is the last one used.
  const RegisterUse& h = use_of(point, "span.h");
  const auto top = static_cast<std::size_t>(std::floor(std::log2(h.max))) + 64;
  EXPECT_GT(h.octave[top], 0U);
  EXPECT_EQ(std::accumulate(h.octave.begin() + static_cast<std::ptrdiff_t>(top) + 1, h.octave.end(), 0U), 0U);
  const PointResult plain = PointMeter({demo_scene(160, 120)}).measure(shipped_config("depth16"), false);
  EXPECT_EQ(use_of(plain, "span.h").zeros, 0U);
  EXPECT_EQ(plain.metrics, point.metrics);
}

TEST(Point, ABitMoreIsNotWorseAndOneThatIsMissingIsSeen) {
  const PointMeter meter({demo_scene(160, 120)});
  Config config = shipped_config("depth16");
  const double base = meter.measure(config, false).metrics.at("span.u.rms");
  config.format(FormatId::span_uv).word += 6;
  EXPECT_LT(meter.measure(config, false).metrics.at("span.u.rms"), base);
  config.format(FormatId::span_uv).word -= 9;
  EXPECT_GT(meter.measure(config, false).metrics.at("span.u.rms"), 2 * base);
}

TEST(Point, TheIdealPictureIsDrawnOnce) {
  const std::vector<Scene> scenes{demo_scene(64, 48), demo_scene(48, 64)};
  const auto same = [&](const Frame& frame, const Config& config, std::size_t scene) {
    const auto ideal = make_ideal(config);
    ideal->begin(scenes[scene]);
    ideal->draw(scenes[scene].triangles, 0, nullptr);
    const Frame& expected = ideal->frame();
    return frame.width == expected.width && frame.color == expected.color && frame.depth == expected.depth &&
           frame.triangle == expected.triangle;
  };
  auto meter = std::make_unique<PointMeter>(scenes);
  Config config = shipped_config("depth16");
  EXPECT_TRUE(same(*meter->ideal(config, 1), config, 1));  // nothing is measured yet
  meter->measure(config, false);
  const auto kept = meter->ideal(config, 1);
  EXPECT_TRUE(same(*kept, config, 1));
  EXPECT_TRUE(same(*meter->ideal(config, 0), config, 0));
  config.format(FormatId::span_uv).word += 6;  // has the same truth
  EXPECT_EQ(meter->ideal(config, 1), kept);
  const Config other = shipped_config("depth20");
  EXPECT_TRUE(same(*meter->ideal(other, 1), other, 1));
  meter.reset();
  EXPECT_TRUE(same(*kept, config, 1));
}

// What does not fit is computed again, and changes nothing.
TEST(Point, TruthsStayWithinTheirMemory) {
  const std::vector<Scene> scenes{demo_scene(64, 48), demo_scene(160, 120), demo_scene(48, 64)};
  const Config first = shipped_config("depth16"), second = shipped_config("narrow");
  const Metrics expected = PointMeter(scenes).measure(first).metrics;
  Truths all(scenes, half_of_memory());
  std::vector<std::size_t> sizes;
  for (std::size_t i = 0; i < scenes.size(); ++i) sizes.push_back(all.of(first, i)->bytes());
  EXPECT_EQ(all.bytes(), sizes[0] + sizes[1] + sizes[2]);
  EXPECT_GT(sizes[0], 64U * 48U * sizeof(IdealFragment));
  all.of(second, 0);
  EXPECT_NE(all.kept(first, 0), nullptr);
  const std::size_t both = all.bytes();

  for (const std::size_t limit : {std::size_t{0}, sizes[0], sizes[0] + sizes[2], both}) {
    SCOPED_TRACE(limit);
    Truths some(scenes, limit);
    for (const Config& config : {first, second, first}) {
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        EXPECT_EQ(some.of(config, i)->frame.color, all.of(config, i)->frame.color);
        EXPECT_LE(some.bytes(), limit);
      }
    }
    EXPECT_EQ(some.kept(first, 0) != nullptr, limit >= sizes[0]);
    EXPECT_EQ(some.kept(first, 1) != nullptr, limit >= both);
    EXPECT_EQ(PointMeter(scenes, limit).measure(first).metrics, expected);
  }
}

TEST(Point, IsTheSameFromEveryThread) {
  const PointMeter meter({demo_scene(120, 90)});
  const Config config = shipped_config("depth20");
  std::array<PointResult, 4> results;
  std::vector<std::jthread> threads;
  for (PointResult& result : results) {
    threads.emplace_back([&] { result = meter.measure(config); });
  }
  threads.clear();
  for (const PointResult& result : results) EXPECT_EQ(result.metrics, results[0].metrics);
}

TEST(Point, WhatDrawsNothingIsNoPerfectScore) {
  EXPECT_THROW(PointMeter({}), InputError);
  Scene empty = demo_scene(64, 48);
  empty.triangles.clear();
  expect_refusal([&] { PointMeter({empty}).measure(shipped_config("depth16")); }, "nothing is drawn");
}

TEST(Point, RefusesWhatTheConfigurationCannotHold) {
  const PointMeter meter({demo_scene(64, 48)});
  Config config = shipped_config("depth16");
  config.format(FormatId::setup_uv).integer -= 6;
  config.format(FormatId::setup_uv).word -= 6;
  EXPECT_THROW(meter.measure(config), InputError);
  config = shipped_config("depth16");
  config.format(FormatId::span_uv).word = 99;
  EXPECT_THROW(meter.measure(config), InputError);
}

}  // namespace
}  // namespace bitspan
