// SPDX-License-Identifier: Apache-2.0
#include "study/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "scene/demo.hpp"
#include "tests/study/sweep_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

TEST(Sweep, MeasuresEachPointOnceAndKeepsIt) {
  Bench b;
  const StudyPlan plan = sweep_plan(words + below);
  const SweepResult first = b.sweep(plan);
  EXPECT_EQ(first.points, 4U);
  EXPECT_EQ(first.measured, 4U);  // the base is one of them
  EXPECT_EQ(first.known, 0U);
  EXPECT_EQ(first.refused, 1U);
  EXPECT_EQ(first.holding, 2U);  // 100 * 2^-14, 2^-18
  EXPECT_TRUE(first.finished());
  EXPECT_EQ(b.fake.calls, 4);
  EXPECT_EQ(b.count("points WHERE status = 'ok'"), 3);
  EXPECT_EQ(b.count("points WHERE status = 'refused' AND message = 'fake: formats.span.h.word: too narrow'"),
            1);
  EXPECT_EQ(b.count("study_points WHERE holds"), 2);
  const auto study = b.store->rows("SELECT plan, kind, base_hash FROM studies WHERE name = 's'");
  EXPECT_EQ(text_of(study.at(0)[0]), plan.text);
  EXPECT_EQ(text_of(study[0][1]), "sweep");
  EXPECT_EQ(text_of(study[0][2]), point_hash(plan.base, {small_scene()}, "1"));
  EXPECT_EQ(b.count("studies WHERE cost = 'cost.register_bits'"), 1);
  EXPECT_EQ(b.count("axes WHERE axis = 0 AND i = 0 AND key = 'formats.span.h.word' AND base = '34'"), 1);
  EXPECT_EQ(b.count("axes"), 1);
  EXPECT_EQ(
      b.count("constraints WHERE i = 0 AND metric = 'span.u.max' AND at_most = 0.01 AND at_least IS NULL"),
      1);
  const auto rows = b.store->rows("SELECT i, hash, settings FROM study_points ORDER BY i");
  EXPECT_EQ(text_of(rows[1][2]), "{\"formats.span.h.word\":24}");
  Config config = plan.base;
  config.format(FormatId::span_h).word = 24;
  const auto point = b.store->point(text_of(rows[1][1]));
  ASSERT_TRUE(point);
  EXPECT_EQ(point->config, to_toml(config));
  EXPECT_EQ(point->config_hash, config_hash(config));
  EXPECT_EQ(point->scenes, scenes_json({small_scene()}, std::nullopt));
  EXPECT_EQ(b.store->metrics(point->hash).all.at("span.u.max"), std::ldexp(100.0, -8));

  // The same again: nothing is measured. Other constraints need nothing new either.
  const SweepResult again = b.sweep(plan);
  EXPECT_EQ(b.fake.calls, 4);
  EXPECT_EQ(b.fake.meters, 1);
  EXPECT_EQ(again.known, 4U);
  EXPECT_EQ(again.measured, 0U);
  EXPECT_EQ(again.holding, 2U);
  EXPECT_EQ(b.sweep(sweep_plan(words + "[[constraint]]\nmetric = \"span.u.max\"\nat_most = 10\n")).holding,
            3U);
  EXPECT_EQ(b.fake.calls, 4);
  // One value more: one point more.
  EXPECT_EQ(b.sweep(sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 33\nto = 34\n")).measured,
            1U);
  EXPECT_EQ(b.count("study_points"), 2);
}

// A point keeps the metrics that are asked for, the costs, and its configuration as what it changes on the
// base.
TEST(Sweep, OnlyWhatIsAskedForIsKept) {
  Bench b;
  const std::string named = "metrics = [\"span.u.max\"]\n";
  EXPECT_EQ(b.sweep(sweep_plan(words, named)).measured, 4U);
  const std::string hash = text_of(b.store->rows("SELECT hash FROM study_points WHERE i = 1")[0][0]);
  const std::string base = text_of(b.store->rows("SELECT base_hash FROM studies")[0][0]);
  const auto has = [&](const std::string& of, const std::string& metric) {
    return b.store->metrics(of).all.contains(metric);
  };
  EXPECT_TRUE(has(hash, "span.u.max"));
  EXPECT_TRUE(has(hash, "cost.register_bits"));
  EXPECT_FALSE(has(hash, "span.v.max"));
  EXPECT_TRUE(has(base, "span.v.max")) << "the report compares with the base";
  EXPECT_EQ(b.count("fields WHERE hash = '" + hash + "'"), 0);
  EXPECT_EQ(b.count("fields WHERE hash = '" + base + "'"), 1);
  EXPECT_EQ(b.count("scene_metrics WHERE hash = '" + hash + "' AND scene = 0 AND name = 'span.u.max'"), 1);
  EXPECT_EQ(b.count("configurations"), 1) << "that of the base";
  const auto point = b.store->point(hash);
  ASSERT_TRUE(point);
  Config config = shipped_config("depth16");
  config.format(FormatId::span_h).word = 24;
  EXPECT_EQ(point->config, to_toml(config));
  EXPECT_EQ(point->scenes, scenes_json({small_scene()}, std::nullopt));

  // Who asks for more has the points measured again, and what was kept stays.
  const int calls = b.fake.calls;
  EXPECT_EQ(b.sweep(sweep_plan(words, "metrics = [\"span.v.max\"]\n")).measured, 3U) << "all but the refused";
  EXPECT_GT(b.fake.calls, calls);
  EXPECT_TRUE(has(hash, "span.u.max"));
  EXPECT_TRUE(has(hash, "span.v.max"));
  EXPECT_EQ(b.sweep(sweep_plan(words, named)).measured, 0U);
  EXPECT_EQ(b.sweep(sweep_plan(words + below, named)).measured, 0U);
}

TEST(Sweep, TheHashCoversWhatDeterminesAPoint) {
  const Config config = shipped_config("depth16");
  const std::vector<Scene> scenes{small_scene()};
  std::set<std::string> seen{point_hash(config, scenes, "1")};
  EXPECT_EQ(seen.begin()->size(), 32U);
  const auto is_new = [&](const Config& c, const std::vector<Scene>& s, const char* version) {
    return seen.insert(point_hash(c, s, version)).second;
  };
  EXPECT_TRUE(is_new(config, scenes, "2"));
  EXPECT_TRUE(is_new(shipped_config("depth20"), scenes, "1"));
  EXPECT_TRUE(is_new(config, {small_scene(), small_scene()}, "1"));
  EXPECT_TRUE(is_new(config, {}, "1"));
  const auto changed = [&](const std::function<void(Scene&)>& change) {
    Scene scene = small_scene();
    change(scene);
    return is_new(config, {scene}, "1");
  };
  EXPECT_TRUE(changed([](Scene& s) { s.width = 9; }));
  EXPECT_TRUE(changed([](Scene& s) { s.height = 9; }));
  EXPECT_TRUE(changed([](Scene& s) { s.s_min = 1; }));
  EXPECT_TRUE(changed([](Scene& s) { s.s_max = 201; }));
  EXPECT_TRUE(changed([](Scene& s) { s.focal = 501; }));
  EXPECT_TRUE(changed([](Scene& s) { s.background[2] = 1; }));
  EXPECT_TRUE(changed([](Scene& s) { s.fog.reset(); }));
  EXPECT_TRUE(changed([](Scene& s) { s.fog->distance = 21; }));
  EXPECT_TRUE(changed([](Scene& s) { s.fog->color[0] = 9; }));
  EXPECT_TRUE(changed([](Scene& s) { s.triangles[0].v[2].c[3] = 0.5; }));
  EXPECT_TRUE(changed([](Scene& s) { s.triangles[0].v[1].u = 6; }));
  EXPECT_TRUE(changed([](Scene& s) { s.triangles[0].texture = 0; }));
  EXPECT_TRUE(changed([](Scene& s) { s.triangles.clear(); }));
  EXPECT_TRUE(changed([](Scene& s) { s.textures.push_back({"t", 1, 1, {1, 2, 3, 4}}); }));
  EXPECT_TRUE(changed([](Scene& s) { s.textures.push_back({"t", 1, 1, {1, 2, 3, 5}}); }));
  EXPECT_FALSE(changed([](Scene& s) { s.name = "other"; }));
  EXPECT_FALSE(changed([](Scene& s) { s.textures.push_back({"other", 1, 1, {1, 2, 3, 4}}); }));
  Config renamed = config;
  renamed.name = "other";
  EXPECT_FALSE(is_new(renamed, scenes, "1"));
}

TEST(Sweep, PointsAlikeAreMeasuredOnce) {
  Bench b;
  // Steps are of no account without a Newton unit: both points are one.
  const SweepResult r =
      b.sweep(sweep_plan("[[vary]]\nkeys = [\"reciprocal.pixel.kind\"]\nvalues = [\"restoring\"]\n"
                         "[[vary]]\nkeys = [\"reciprocal.pixel.steps\"]\nvalues = [1, 2]\n"));
  EXPECT_EQ(r.points, 2U);
  EXPECT_EQ(b.fake.calls, 2);  // and the base
  EXPECT_EQ(b.count("study_points"), 2);
  EXPECT_EQ(b.count("study_points JOIN points USING (hash)"), 2);
  EXPECT_EQ(r.holding, 2U);
}

TEST(Sweep, IllegalCombinationsAreRefusedPoints) {
  Bench b;
  const SweepResult r =
      b.sweep(sweep_plan("[[vary]]\nkeys = [\"reciprocal.pixel.operand_bits\"]\nvalues = [10, 22]\n"
                         "[[vary]]\nkeys = [\"reciprocal.pixel.index_bits\"]\nvalues = [8, 11]\n"));
  EXPECT_EQ(r.points, 4U);
  EXPECT_EQ(r.refused, 1U);
  EXPECT_EQ(r.holding, 3U);
  const auto rows = b.store->rows("SELECT config, message FROM points WHERE status = 'refused'");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(text_of(rows[0][0]), "");
  EXPECT_TRUE(names(text_of(rows[0][1]), "index_bits: is 11 with operand_bits = 10"));
  const int calls = b.fake.calls;
  EXPECT_EQ(b.sweep(sweep_plan("[[vary]]\nkeys = [\"reciprocal.pixel.operand_bits\"]\nvalues = [10, 22]\n"
                               "[[vary]]\nkeys = [\"reciprocal.pixel.index_bits\"]\nvalues = [8, 11]\n"))
                .measured,
            0U);
  EXPECT_EQ(b.fake.calls, calls);
}

TEST(Sweep, AStudyOfRefusedPointsIsAnError) {
  Bench b;
  EXPECT_TRUE(
      names(input_error([&] {
              b.sweep(sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [18, 19]\n"));
            }),
            "s: not one of 2 points can be measured; the first: fake: formats.span.h.word: too narrow"));
  EXPECT_EQ(b.count("points WHERE status = 'refused'"), 2);
}

TEST(Sweep, MetricsThatNoPointHasAreAnError) {
  Bench b;
  const std::string wrong = "[[constraint]]\nmetric = \"fog.factor.max\"\nat_most = 1\n";
  EXPECT_TRUE(names(input_error([&] { b.sweep(sweep_plan(words + wrong)); }),
                    "fog.factor.max: the scenes give no such metric; nearest: span.u.max"));
  EXPECT_GE(b.count("points WHERE status = 'ok'"), 1);  // what was measured stays
  EXPECT_THROW(b.sweep(sweep_plan(words, "metrics = [\"fog.factor.max\"]\n")), InputError);
  // A NaN is there, and holds nothing.
  EXPECT_EQ(b.sweep(sweep_plan(words + "[[constraint]]\nmetric = \"span.v.max\"\nat_most = 1\n")).holding,
            0U);
}

TEST(Sweep, AStopFinishesWhatRunsAndARestartDoesTheRest) {
  Bench b;
  const StudyPlan plan = sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 20\nto = 49\n");
  std::stop_source stop;
  b.options.stop = stop.get_token();
  b.options.threads = 2;
  b.fake.hook = [&](const Config&) {
    if (b.fake.calls == 5) stop.request_stop();
  };
  const SweepResult cut = b.sweep(plan);
  EXPECT_FALSE(cut.finished());
  EXPECT_EQ(cut.measured, static_cast<std::size_t>(b.fake.calls.load()));
  EXPECT_GE(b.fake.calls, 5);
  EXPECT_LE(b.fake.calls, 7);
  EXPECT_EQ(b.count("points"), b.fake.calls);
  EXPECT_EQ(b.count("study_points WHERE holds IS NULL"), 30 - b.fake.calls);
  b.options.stop = {};
  b.fake.hook = nullptr;
  const SweepResult rest = b.sweep(plan);
  EXPECT_TRUE(rest.finished());
  EXPECT_EQ(rest.known, cut.measured);
  EXPECT_EQ(b.fake.calls, 30);  // the base, with 34 bits, is among them
  EXPECT_EQ(rest.holding, 30U);
}

TEST(Sweep, ALimitLeavesTheRest) {
  Bench b;
  b.options.limit = 2;
  EXPECT_EQ(b.sweep(sweep_plan(words)).missing, 2U);
  EXPECT_EQ(b.fake.calls, 2);
  EXPECT_EQ(b.sweep(sweep_plan(words)).missing, 0U);
  EXPECT_EQ(b.fake.calls, 4);
}

TEST(Sweep, RunsOnSeveralThreadsAndTellsProgress) {
  Bench b;
  std::mutex mutex;
  std::condition_variable came;
  std::set<std::thread::id> threads;
  const std::size_t wanted = std::min<std::size_t>(2, std::thread::hardware_concurrency());
  b.options.threads = 2;
  b.fake.hook = [&](const Config&) {
    std::unique_lock lock(mutex);
    threads.insert(std::this_thread::get_id());
    came.notify_all();
    // On a busy machine the second thread comes late.
    came.wait_for(lock, std::chrono::seconds(10), [&] { return threads.size() >= wanted; });
  };
  std::vector<std::pair<std::size_t, std::size_t>> progress;
  b.options.progress = [&](std::size_t done, std::size_t total) { progress.emplace_back(done, total); };
  b.sweep(sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 30\nto = 39\n"));
  EXPECT_EQ(threads.size(), wanted);
  ASSERT_EQ(progress.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i)
    EXPECT_EQ(progress[i], (std::pair<std::size_t, std::size_t>(i + 1, 10)));
}

TEST(Sweep, WhatIsNoRefusalEndsTheRunAndKeepsWhatIsDone) {
  Bench b;
  b.options.threads = 2;
  b.fake.hook = [&](const Config&) {
    const int call = b.fake.calls;
    if (call == 6) throw std::runtime_error("bug");
    // On a busy machine the other thread would measure all points before this one's end is noticed.
    if (call > 6) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  };
  const StudyPlan plan = sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 20\nto = 49\n");
  EXPECT_THROW(b.sweep(plan), std::runtime_error);
  const auto kept = b.count("points");
  EXPECT_GE(kept, 1);
  EXPECT_LE(kept, 7);
  b.fake.hook = nullptr;
  EXPECT_EQ(b.sweep(plan).known, static_cast<std::size_t>(kept));
}

TEST(Sweep, AFullDiskEndsTheRunAndLosesNothing) {
  Bench b;
  const StudyPlan plan = sweep_plan(
      "[[vary]]\nkeys = [\"formats.span.h.word\"]\nfrom = 20\nto = 49\n"
      "[[vary]]\nkeys = [\"formats.span.uv.word\"]\nfrom = 21\nto = 30\n");
  const auto pages = integer_of(b.store->rows("PRAGMA page_count")[0][0]);
  b.store->run("PRAGMA max_page_count = " + std::to_string(pages + 20));
  EXPECT_TRUE(names(input_error([&] { b.sweep(plan); }), "a.db: the disk is full"));
  const auto kept = b.count("points");
  EXPECT_GT(kept, 1);
  EXPECT_LT(kept, 300);
  b.store = std::make_unique<Store>(b.folder.path("a.db"), "1");
  const SweepResult rest = b.sweep(plan);
  EXPECT_EQ(rest.known, static_cast<std::size_t>(kept));
  EXPECT_EQ(rest.holding, 300U);
}

TEST(Sweep, StretchesScenesAndMakesOneMeterForEach) {
  Bench b;
  const SweepResult r =
      b.sweep(sweep_plan("[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [30, 34]\n"
                         "[[vary]]\nkeys = [\"scene.s_ratio\"]\nvalues = [10, 1000.5]\n"));
  EXPECT_EQ(r.points, 4U);
  EXPECT_EQ(b.fake.calls, 5);  // the base keeps its 100
  ASSERT_EQ(b.fake.ratios.size(), 3U);
  EXPECT_EQ(b.fake.ratios[0], 100);
  EXPECT_EQ(b.fake.ratios[1], 10);
  EXPECT_DOUBLE_EQ(b.fake.ratios[2], 1000.5);
  const auto rows =
      b.store->rows("SELECT settings, scenes FROM study_points JOIN points USING (hash) ORDER BY i");
  EXPECT_EQ(text_of(rows[1][0]), "{\"formats.span.h.word\":30,\"scene.s_ratio\":1000.5}");
  EXPECT_TRUE(names(text_of(rows[1][1]), "\"s_ratio\":1000.5"));
}

TEST(Sweep, SettingsComeBackFromTheirText) {
  const std::vector<KeySetting> settings{{"z", std::int64_t{-34}},
                                         {"a", true},
                                         {"scene.s_ratio", 0.1 + 0.2},
                                         {"whole", 1000.0},
                                         {"texture.transparent", std::string("[255, 0, 255]")}};
  EXPECT_EQ(parse_settings(settings_json(settings)), settings);
  EXPECT_TRUE(parse_settings("{}").empty());
  EXPECT_TRUE(names(input_error([] { parse_settings("{\"a\":"); }), "unreadable"));
  EXPECT_TRUE(names(input_error([] { parse_settings("{\"a\":null}"); }), "unreadable"));
}

TEST(Sweep, ScenesTellTheirRatio) {
  EXPECT_EQ(s_ratio_of(scenes_json({small_scene()}, std::nullopt)), std::nullopt);
  EXPECT_EQ(s_ratio_of(scenes_json({small_scene(), small_scene()}, 0.1 + 0.2)), 0.1 + 0.2);
  EXPECT_TRUE(names(input_error([] { s_ratio_of("[{"); }), "unreadable"));
  EXPECT_TRUE(names(input_error([] { s_ratio_of("[]"); }), "unreadable"));
}

TEST(Sweep, StretchingKeepsThePictureAndTheOrder) {
  const Scene from = small_scene();
  const Scene to = with_s_ratio(from, 10000);
  EXPECT_EQ(to.s_min, 2);
  EXPECT_EQ(to.s_max, 20000);
  EXPECT_EQ(to.triangles[0].v[0].s, 2);
  EXPECT_NEAR(to.triangles[0].v[1].s, 200, 1e-9);  // half way in log s
  EXPECT_EQ(to.triangles[0].v[2].s, 20000);
  EXPECT_NEAR(to.fog->distance, 200, 1e-9);
  EXPECT_EQ(to.triangles[0].v[1].x, 8);
  EXPECT_EQ(to.triangles[0].v[1].u, 5);
  EXPECT_EQ(scene_hash(with_s_ratio(from, 100)), scene_hash(from));
  Scene projected = from;
  projected.projector.emplace();
  EXPECT_THROW(with_s_ratio(projected, 10), InputError);
  EXPECT_NE(scene_hash(projected), scene_hash(from));
  Scene farther = projected;
  farther.projector->s_max *= 2;
  EXPECT_NE(scene_hash(farther), scene_hash(projected));
  const Scene demo = demo_scene(64, 48);
  for (const double ratio : {1.001, 10.0, 99999.0}) {
    const Scene s = with_s_ratio(demo, ratio);
    for (std::size_t t = 0; t < demo.triangles.size(); ++t) {
      for (std::size_t v = 0; v < 3; ++v) {
        ASSERT_GE(s.triangles[t].v[v].s, s.s_min);
        ASSERT_LE(s.triangles[t].v[v].s, s.s_max);
      }
    }
  }
}

TEST(Sweep, ANamedAxisHasAColumnOfItsOwn) {
  Bench b;
  const StudyPlan plan = sweep_plan(
      "[[vary]]\nname = \"width\"\nkeys = [\"formats.span.h.word\", \"depth.bits\"]\n"
      "values = [30, 34]\noffsets = [0, -18]\n");
  b.sweep(plan);
  std::string text;
  write_csv(plan, *b.store, "x", [&](std::string_view s) { text += s; });
  EXPECT_TRUE(text.starts_with("i,width,formats.span.h.word,depth.bits,status,holds,")) << text;
  EXPECT_NE(text.find("\r\n0,30,30,12,ok,"), std::string::npos) << text;
  EXPECT_NE(text.find("\r\n1,34,34,16,ok,"), std::string::npos) << text;
  EXPECT_EQ(b.count("axes WHERE name = 'width' AND key = 'depth.bits' AND \"offset\" = -18"), 1);
  // No other column can be called so.
  std::string header = text.substr(0, text.find("\r\n"));
  for (std::size_t at = 0; at < header.size();) {
    const std::size_t end = std::min(header.find(',', at), header.size());
    const std::string column = header.substr(at, end - at);
    at = end + 1;
    if (column == "width") continue;
    const std::string named = "[[vary]]\nname = \"" + column + "\"\nkeys = [\"depth.bits\"]\nvalues = [16]\n";
    EXPECT_NE(input_error([&] { sweep_plan(named); }).find("vary[1].name: is \"" + column),
              std::string::npos);
  }
}

TEST(Sweep, CsvHasARowAPoint) {
  Bench b;
  const StudyPlan plan = sweep_plan(
      "[[vary]]\nkeys = [\"formats.span.h.word\"]\nvalues = [18, 30]\n"
      "[[vary]]\nkeys = [\"depth.code\"]\nvalues = [\"linear\"]\n" +
          below,
      "arrangement = \"one_at_a_time\"\nmetrics = [\"span.u.max\", \"span.v.max\"]\n");
  b.sweep(plan);
  std::string text;
  write_csv(plan, *b.store, "bitspan study --db \"a b.db\" --replay", [&](std::string_view s) { text += s; });
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size()) {
    const auto end = text.find("\r\n", at);
    lines.push_back(text.substr(at, end - at));
    at = end + 2;
  }
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(
      lines[0],
      "i,formats.span.h.word,depth.code,status,holds,span.u.max,span.v.max,seconds,config_hash,hash,message,"
      "replay");
  EXPECT_TRUE(lines[1].starts_with("0,34,inverse,ok,1,0.0003814697265625,,")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("1,18,inverse,refused,0,,,")) << lines[2];
  EXPECT_TRUE(names(lines[2], ",fake: formats.span.h.word: too narrow,")) << lines[2];
  EXPECT_TRUE(lines[3].starts_with("2,30,inverse,ok,1,0.006103515625,,")) << lines[3];
  EXPECT_TRUE(lines[4].starts_with("3,34,linear,ok,1,")) << lines[4];
  const std::string hash = text_of(b.store->rows("SELECT hash FROM study_points WHERE i = 3")[0][0]);
  EXPECT_TRUE(lines[4].ends_with(hash + ",,\"bitspan study --db \"\"a b.db\"\" --replay " + hash + "\""))
      << lines[4];
  // Without names, all metrics.
  StudyPlan all = plan;
  all.metrics.clear();
  text.clear();
  write_csv(all, *b.store, "x", [&](std::string_view s) { text += s; });
  EXPECT_TRUE(names(text, ",holds,cost.register_bits,span.u.max,span.v.max,seconds,")) << text;
  // By scene: what is not measured by scene is of the point, and what is refused has no line.
  text.clear();
  write_scenes_csv(all, *b.store, "x", [&](std::string_view s) { text += s; });
  EXPECT_TRUE(text.starts_with("i,scene,formats.span.h.word,depth.code,status,holds,cost.register_bits,"))
      << text;
  EXPECT_TRUE(names(text, "\r\n0,small,34,inverse,ok,1,34,0.0003814697265625,,")) << text;
  EXPECT_FALSE(names(text, "\r\n1,")) << text;
  EXPECT_TRUE(names(text, "\r\n2,small,30,inverse,ok,1,30,0.006103515625,,")) << text;
}

TEST(Sweep, DifferencesNameWhatDiffers) {
  PointResult result;
  result.metrics = {{"a.b.max", 0.25}, {"c.d.max", no_number}};
  result.fields.push_back({"span", "u", "texel", 0.5, 3, 0.1});
  result.registers.push_back({});
  result.registers[0].name = "span.h";
  const ResultRows stored = rows_of(result);
  EXPECT_TRUE(differences(stored, rows_of(result)).empty());
  result.metrics["a.b.max"] = std::nextafter(0.25, 1.0);
  result.metrics["e.f.max"] = 1;
  result.fields[0].count = 4;
  result.registers[0].octave[3] = 1;
  const auto d = differences(stored, rows_of(result));
  ASSERT_EQ(d.size(), 4U);
  EXPECT_EQ(d[0], "metric a.b.max: stored 0.25, measured 0.25000000000000006");
  EXPECT_EQ(d[1], "metric e.f.max: only measured");
  EXPECT_EQ(d[2], "field span.u count: stored 3, measured 4");
  EXPECT_TRUE(d[3].starts_with("register span.h octaves: stored [0,0,0,0,"));
}

}  // namespace
}  // namespace bitspan
