// SPDX-License-Identifier: Apache-2.0
// What follows a study's points: the search in the database, what is recommended, and its examination.
#include "study/recommend.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "scene/demo.hpp"
#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/cost.hpp"
#include "tests/study/area_support.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using Metrics = std::map<std::string, double, std::less<>>;

// "tiny" has room for five fraction bits of u and v, and takes more LUTs with each.
StudyPlan plan_of(const std::string& text) {
  return parse_study(text, "test.toml", [](const std::string& name) {
    return name == "tiny" ? with_keys(tiny_config(), {{"formats.span.uv_acc.word", std::int64_t{12}}})
                          : shipped_config(name);
  });
}

// Costs the width of a format; its error is half an ulp; below `narrowest` bits it is refused.
MakeMeter fake_meter(FormatId id = FormatId::span_h, int narrowest = 19) {
  return [=](std::vector<Scene>) -> Measure {
    return [=](const Config& config) {
      const Format& f = config.format(id);
      if (f.word < narrowest) throw InputError("fake: too narrow");
      PointResult r;
      r.metrics["span.u.p999"] = std::ldexp(0.5, -f.fraction());
      r.metrics["cost.register_bits"] = f.word;
      return r;
    };
  };
}

struct Bench {
  TemporaryFolder folder;
  Store store{folder.path("study.db"), "test"};
  StudyPlan plan;
  PointRunner runner;
  explicit Bench(const std::string& text, FormatId id = FormatId::span_h, int narrowest = 19)
      : plan(plan_of(text)),
        runner(plan.base, {demo_scene(64, 48)}, fake_meter(id, narrowest), store, "test") {}
};

// A known area of synthesis, other counts than its LUTs being 1.
void plant_area(Store& store, const Config& config, const std::string& family, std::int64_t luts) {
  store.run(
      "INSERT INTO areas(config_hash, area_key, family, placed, status, message, tools, luts, ffs, "
      "multipliers, memory_bits) VALUES(?, ?, ?, 0, 'ok', '', '', ?, 1, 1, 1)",
      {config_hash(config), area_key(config), family, luts});
}

const std::string search_text = R"(
[study]
name = "widths"
base = "depth16"
[[vary]]
keys = ["formats.span.h.word"]
from = 18
to = 26
[[constraint]]
metric = "span.u.p999"
at_most = 0.01
[search]
algorithm = "max-1"
)";

TEST(Recommend, TheSearchLeavesItsStepsAndItsCertificate) {
  Bench b(search_text);
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  // 16 integer bits: 2^-(f + 1) <= 0.01 from f = 6 on.
  EXPECT_EQ(result.cost, 22);
  const auto steps = b.store.rows("SELECT hash, cost, holds, best FROM search_steps WHERE study = 'widths'");
  ASSERT_EQ(steps.size(), result.evaluations);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto point = b.store.point(text_of(steps[i][0]));
    ASSERT_TRUE(point.has_value());
    EXPECT_EQ(parse_config(point->config, "").format(FormatId::span_h).word,
              18 + static_cast<int>(result.steps[i].point[0]));
  }
  EXPECT_EQ(text_of(b.store.rows("SELECT base_hash FROM studies")[0][0]), b.runner.prepare({}).hash);
  const auto certificate = b.store.rows("SELECT key, from_value, to_value, failed, hash FROM certificate");
  ASSERT_EQ(certificate.size(), 1U);
  EXPECT_EQ(text_of(certificate[0][0]), "formats.span.h.word");
  EXPECT_EQ(text_of(certificate[0][1]), "22");
  EXPECT_EQ(text_of(certificate[0][2]), "21");
  EXPECT_NE(text_of(certificate[0][3]).find("span.u.p999"), std::string::npos) << text_of(certificate[0][3]);
  EXPECT_EQ(b.store.rows("SELECT 1 FROM certificate WHERE settings = '{\"formats.span.h.word\":21}'").size(),
            1U);
  EXPECT_EQ(text_of(certificate[0][4]), b.runner.prepare({{"formats.span.h.word", std::int64_t{21}}}).hash);
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_EQ(recommended.size(), 1U);
  const auto point = b.store.point(recommended[0].hash);
  EXPECT_EQ(parse_config(point->config, "").format(FormatId::span_h).word, 22);

  // Again: the same, and nothing measured.
  PointRunner again(
      b.plan.base, {demo_scene(64, 48)},
      [](std::vector<Scene>) -> Measure {
        return [](const Config&) -> PointResult { throw std::logic_error("measured again"); };
      },
      b.store, "test");
  EXPECT_EQ(run_search(b.plan, again, b.store, {}, {}).point, result.point);
}

std::string csv_of(const StudyPlan& plan, Store& store) {
  std::string out;
  write_csv(plan, store, "again", [&](std::string_view text) { out += text; });
  return out;
}

TEST(Recommend, TheCsvOfASearchHasARowAnEvaluation) {
  Bench b(search_text);
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  const std::string csv = csv_of(b.plan, b.store);
  std::string expected =
      "i,formats.span.h.word,status,holds,cost.register_bits,span.u.p999,seconds,config_hash,hash,message,"
      "replay\r\n";
  std::size_t at = 0;
  ASSERT_EQ(csv.substr(0, expected.size()), expected);
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    at = csv.find("\r\n", at) + 2;
    const SearchStep& step = result.steps[i];
    const std::size_t word = 18 + step.point[0];
    expected = fmt::format("{},{},ok,{},{},{},", i, word, step.holds ? 1 : 0, word,
                           std::ldexp(0.5, 16 - static_cast<int>(word)));
    EXPECT_EQ(csv.substr(at, expected.size()), expected);
  }
  EXPECT_EQ(csv.find("\r\n", at) + 2, csv.size());
  // The same where every point was known.
  run_search(b.plan, b.runner, b.store, {}, {});
  EXPECT_EQ(csv_of(b.plan, b.store), csv);
}

TEST(Recommend, ASearchCutShortExportsWhatIsThere) {
  Bench b(search_text);
  std::stop_source stop;
  int calls = 0;
  PointRunner runner(
      b.plan.base, {demo_scene(64, 48)},
      [&](const std::vector<Scene>& scenes) -> Measure {
        return [&, measure = fake_meter()(scenes)](const Config& config) {
          if (++calls == 4) stop.request_stop();  // the base, and three of the search
          return measure(config);
        };
      },
      b.store, "test");
  RunOptions options;
  options.stop = stop.get_token();
  const SearchResult result = run_search(b.plan, runner, b.store, options, {});
  EXPECT_EQ(result.stopped_by, StoppedBy::interrupt);
  EXPECT_EQ(result.steps.size(), 3U);
  const std::string csv = csv_of(b.plan, b.store);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_NE(csv.find("\r\n2,24,ok,1,24,"), std::string::npos) << csv;
  const auto certificate = b.store.rows("SELECT to_value, hash, failed FROM certificate");
  ASSERT_EQ(certificate.size(), 1U);
  EXPECT_EQ(text_of(certificate[0][0]), "23");
  EXPECT_EQ(text_of(certificate[0][1]), "");
  EXPECT_TRUE(text_of(certificate[0][2]).starts_with("not evaluated")) << text_of(certificate[0][2]);
}

// Each rounding has its own cost; the last one is none.
const std::string category_text =
    "[[vary]]\nname = \"rounding\"\nkeys = [\"depth.round\"]\nvalues = [\"SC_RND\", \"SC_TRN\", "
    "\"SC_MAGIC\"]\n";

MakeMeter rounding_meter() {
  return [](const std::vector<Scene>& scenes) -> Measure {
    return [measure = fake_meter()(scenes)](const Config& config) {
      PointResult r = measure(config);
      if (value_of_key(config, "depth.round") == KeyValue("SC_TRN")) r.metrics["cost.register_bits"] -= 10;
      return r;
    };
  };
}

TEST(Recommend, ASearchOfCategoriesKeepsEachCertificate) {
  std::string text = search_text;
  text.insert(text.find("[[vary]]"), category_text);
  Bench b(text);
  PointRunner runner(b.plan.base, {demo_scene(64, 48)}, rounding_meter(), b.store, "test");
  const SearchResult result = run_search(b.plan, runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.cost, 12);
  EXPECT_EQ(result.point, (SearchPoint{1, 4}));
  const auto rows = b.store.rows(
      "SELECT combination, hash, cost, evaluations, stopped_by, minimal, failing FROM combinations WHERE "
      "study = "
      "'widths' ORDER BY i");
  ASSERT_EQ(rows.size(), 3U);
  const auto hash = [&](const char* rounding, std::int64_t word) {
    return b.runner.prepare({{"depth.round", std::string(rounding)}, {"formats.span.h.word", word}}).hash;
  };
  const auto count = [&](std::size_t i) {
    return static_cast<std::int64_t>(result.combinations[i].evaluations);
  };
  EXPECT_EQ(rows[0],
            (Row{"rounding = SC_RND", hash("SC_RND", 22), 22.0, count(0), "done", std::int64_t{1}, ""}));
  EXPECT_EQ(rows[1],
            (Row{"rounding = SC_TRN", hash("SC_TRN", 22), 12.0, count(1), "done", std::int64_t{1}, ""}));
  EXPECT_EQ(text_of(rows[2][1]), "");
  EXPECT_EQ(rows[2][2], Cell());
  EXPECT_EQ(rows[2][3], Cell(std::int64_t{1}));
  EXPECT_NE(text_of(rows[2][6]).find("refused: depth.round: \"SC_MAGIC\" is no value"), std::string::npos)
      << text_of(rows[2][6]);
  const auto certificate =
      b.store.rows("SELECT combination, key, from_value, to_value, hash FROM certificate ORDER BY rowid");
  const Row first{"rounding = SC_RND", "formats.span.h.word", "22", "21", hash("SC_RND", 21)};
  const Row second{"rounding = SC_TRN", "formats.span.h.word", "22", "21", hash("SC_TRN", 21)};
  EXPECT_EQ(certificate, (std::vector<Row>{first, second}));
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_EQ(recommended.size(), 1U);
  EXPECT_EQ(recommended[0].hash, hash("SC_TRN", 22));
  const std::string csv = csv_of(b.plan, b.store);
  EXPECT_TRUE(csv.starts_with("i,rounding,depth.round,formats.span.h.word,status,")) << csv;
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), 1 + result.evaluations);
}

// The true cost of the registers; the error is that of both widths together.
MakeMeter true_cost_meter() {
  return [](const std::vector<Scene>&) -> Measure {
    return [](const Config& config) {
      PointResult r;
      add_costs(config, r.metrics);
      for (const FormatId id : {FormatId::span_h, FormatId::span_uv}) {
        r.metrics["span.u.p999"] += std::ldexp(0.5, -config.format(id).fraction());
      }
      return r;
    };
  };
}

TEST(Recommend, PairedStepsAreMeasuredWhereTheirKnownCostIsLower) {
  std::string text = search_text;
  text.insert(text.find("[[vary]]"), "[[vary]]\nkeys = [\"formats.span.uv.fraction\"]\nfrom = 1\nto = 9\n");
  Bench b(text);
  PointRunner runner(b.plan.base, {demo_scene(64, 48)}, true_cost_meter(), b.store, "test");
  StudyPlan singles = b.plan;
  singles.search->pairs = false;
  const SearchResult plain = run_search(singles, runner, b.store, {}, {});
  const SearchResult result = run_search(b.plan, runner, b.store, {}, {});
  ASSERT_TRUE(plain.found);
  EXPECT_EQ(result.point, plain.point);
  // u and v have two registers each, h has one: one bit of h more and two of u and v less is the pair that
  // saves.
  ASSERT_EQ(result.certificate.pairs.size(), 1U);
  EXPECT_EQ(result.certificate.pairs[0].key, "formats.span.h.word up, formats.span.uv.fraction down");
  EXPECT_EQ(result.certificate.pairs[0].outcome, ReductionOutcome::fails);
  ASSERT_EQ(result.steps.size(), plain.steps.size() + 1);
  EXPECT_LT(result.steps.back().cost, plain.cost);
  const auto rows = b.store.rows(
      "SELECT from_value, to_value, hash FROM certificate WHERE key = 'formats.span.h.word up, "
      "formats.span.uv.fraction down' AND failed LIKE 'fails: span.u.p999 is %'");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(text_of(rows[0][2]),
            runner.prepare(settings_of(b.plan.axes, result.certificate.pairs[0].point)).hash);
}

TEST(Recommend, ASearchWithoutALegalCombinationIsAnError) {
  std::string text = search_text;
  text.insert(text.find("[[vary]]"), category_text);
  Bench b(text, FormatId::span_h, 60);
  EXPECT_EQ(
      input_error([&] { run_search(b.plan, b.runner, b.store, {}, {}); }),
      "widths: not one of 3 combinations of categories can be measured; the first: rounding = SC_RND: the "
      "widest point does not hold: refused: fake: too narrow");
}

TEST(Recommend, WhatHoldsNowhereIsNotRecommended) {
  std::string text = search_text;
  text.replace(text.find("0.01"), 4, "1e-9");
  Bench b(text);
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  EXPECT_FALSE(result.found);
  EXPECT_FALSE(result.failing.empty());
  EXPECT_TRUE(recommendations(b.plan, b.store).empty());
}

// The narrowest errs too much.
const std::string area_search_text = R"(
[study]
name = "areas"
base = "tiny"
[[vary]]
keys = ["formats.span.uv.word"]
values = [7, 8, 10]
[[constraint]]
metric = "span.u.p999"
at_most = 0.3
[search]
algorithm = "max-1"
cost = "area.ecp5.luts"
)";

struct AreaBench : Bench {
  AreaBench() : Bench(area_search_text, FormatId::span_uv, 7) {}
  Config at(std::int64_t word) const { return with_keys(plan.base, {{"formats.span.uv.word", word}}); }
};

TEST(Recommend, ASearchIsForTheSynthesisedArea) {
  AreaBench b;
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  EXPECT_EQ(b.plan.axes[0].values[result.point[0]][0], KeyValue(std::int64_t{8}));
  const AreaResult area = measure_area(b.at(8), {Family::ecp5}, false);
  EXPECT_EQ(area.status, AreaStatus::ok) << area.message;
  EXPECT_EQ(result.cost, static_cast<double>(area.counts.luts));
  // The points that hold have a row, and in this family alone.
  // Which of them is larger is Yosys's affair: a bit more may take fewer LUTs.
  const auto rows = b.store.rows("SELECT area_key, family, placed, luts FROM areas");
  ASSERT_EQ(rows.size(), 2U);
  const std::size_t first = rows[0][0] == Cell(area_key(b.at(8))) ? 0 : 1;
  EXPECT_EQ(rows[first], (Row{area_key(b.at(8)), "ecp5", std::int64_t{0}, area.counts.luts}));
  EXPECT_EQ(rows[1 - first][0], Cell(area_key(b.at(10))));
}

// Areas that no tool would find: the narrower point is the larger in ECP5, and in nothing else.
TEST(Recommend, ASearchTakesKnownAreasAndStaysWhereTheyAreSmallest) {
  AreaBench b;
  plant_area(b.store, b.at(8), "ice40", 10);
  plant_area(b.store, b.at(10), "ice40", 20);
  plant_area(b.store, b.at(8), "ecp5", 2000);
  plant_area(b.store, b.at(10), "ecp5", 1000);
  const Environment path("PATH", "/nonexistent");  // no Yosys
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.cost, 1000);
  ASSERT_EQ(result.certificate.reductions.size(), 1U);
  EXPECT_EQ(result.certificate.reductions[0].outcome, ReductionOutcome::costs_more);
  EXPECT_EQ(result.certificate.reductions[0].to_value, "8");
}

// A bit of span.h costs what a bit of depth buffer of a quarter of the pixels does.
TEST(Recommend, ASearchLowersAnExpression) {
  std::string text = search_text + "cost = \"min(1e9, 2 * cost.register_bits) + memory.depth_bits / 100\"\n";
  text.replace(text.find("metric = "), 22, "metric = \"2 * span.u.p999\"");
  Bench b(text);
  PointRunner runner(
      b.plan.base, {demo_scene(64, 48)},
      [](const std::vector<Scene>& scenes) -> Measure {
        return [measure = fake_meter()(scenes), scenes](const Config& c) {
          PointResult r = measure(c);
          add_memory(c, scenes, r.metrics);
          return r;
        };
      },
      b.store, "test");
  const SearchResult result = run_search(b.plan, runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  // One bit more than where twice the error counts once.
  EXPECT_EQ(result.cost, 2 * 23 + 64 * 48 * 16 / 100.0);
  EXPECT_EQ(result.certificate.reductions[0].text, "2 * span.u.p999 is 0.015625, at most 0.01");
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_EQ(recommended.size(), 1U);
  EXPECT_EQ(recommended[0].reason, "found by the search: " + b.plan.search->cost + " = 537.52");
  const std::string csv = csv_of(b.plan, b.store);
  EXPECT_NE(
      csv.find(",2 * span.u.p999,\"min(1e9, 2 * cost.register_bits) + memory.depth_bits / 100\",seconds,"),
      std::string::npos)
      << csv.substr(0, 300);
  EXPECT_NE(csv.find(",0.0078125,537.52,"), std::string::npos) << csv;
}

TEST(Recommend, ASweepIsJudgedByExpressions) {
  std::string text = search_text.substr(0, search_text.find("[search]"));
  text.replace(text.find("metric = "), 22, "metric = \"1 / span.u.p999\"");
  text.replace(text.find("at_most = 0.01"), 14, "at_least = 100");
  text.replace(text.find("[[vary]]"), 0, "cost = \"1000 - cost.register_bits\"\n");
  Bench b(text);
  const SweepResult result = run_sweep(b.plan, b.runner, b.store, {});
  EXPECT_EQ(result.holding, 5U);
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_FALSE(recommended.empty());
  EXPECT_NE(recommended[0].reason.find("1000 - cost.register_bits = 974"), std::string::npos)
      << recommended[0].reason;
  // The base has its values, too, and what is measured again is compared with what was measured alone.
  const std::string base = b.runner.prepare({}).hash;
  EXPECT_EQ(b.store.metrics(base).all.at("1000 - cost.register_bits"),
            1000 - b.store.metrics(base).all.at("cost.register_bits"));
  for (const Row& row : b.store.result_rows(base).metrics) EXPECT_NE(text_of(row[0]), "1 / span.u.p999");
  // A study with another expression finds the same points known.
  text.replace(text.find("1000 -"), 6, "2000 -");
  b.plan = plan_of(text);
  EXPECT_EQ(run_sweep(b.plan, b.runner, b.store, {}).measured, 0U);
  EXPECT_NE(recommendations(b.plan, b.store)[0].reason.find("2000 - cost.register_bits = 1974"),
            std::string::npos);
}

TEST(Recommend, AnExpressionNamesTheMetricThatTheScenesLack) {
  for (const bool search : {true, false}) {
    std::string text = search ? search_text : search_text.substr(0, search_text.find("[search]"));
    text.replace(text.find("metric = "), 22, "metric = \"1 - span.v.p999\"");
    Bench b(text);
    try {
      search ? (void)run_search(b.plan, b.runner, b.store, {}, {})
             : (void)run_sweep(b.plan, b.runner, b.store, {});
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_EQ(
          std::string(error.what()),
          "widths: span.v.p999: the scenes give no such metric; nearest: span.u.p999, cost.register_bits");
    }
  }
}

// Synthesis is a constraint: of the points that hold otherwise, those with up to 1500 LUTs.
TEST(Recommend, AreasAndEstimatesMayBeConstraints) {
  std::string text = area_search_text;
  text.replace(text.find("[search]"), 0,
               "[[constraint]]\nmetric = \"area.ecp5.luts + area.ecp5.ffs\"\nat_most = 1500\n");
  text.replace(text.find("area.ecp5.luts\"\n", text.find("[search]")), 14, "cost.register_bits");
  Bench b(text, FormatId::span_uv, 7);
  const auto at = [&](std::int64_t word) { return with_keys(b.plan.base, {{"formats.span.uv.word", word}}); };
  plant_area(b.store, at(8), "ecp5", 2000);
  plant_area(b.store, at(10), "ecp5", 1499);
  const Environment path("PATH", "/nonexistent");  // no Yosys
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.cost, 10);
  EXPECT_EQ(result.certificate.reductions[0].text, "area.ecp5.luts + area.ecp5.ffs is 2001, at most 1500");
}

// No real area: the clock rate of a placed row that is planted.
TEST(Recommend, AClockRateMayBeAConstraint) {
  std::string text = area_search_text;
  text.replace(text.find("[search]"), 0, "[[constraint]]\nmetric = \"area.ecp5.fmax_mhz\"\nat_least = 100\n");
  Bench b(text, FormatId::span_uv, 7);
  for (const std::int64_t word : {8, 10}) {
    const Config c = with_keys(b.plan.base, {{"formats.span.uv.word", word}});
    plant_area(b.store, c, "ecp5", 1000);  // not placed, which says nothing of the clock
    b.store.run(
        "INSERT INTO areas(config_hash, area_key, family, placed, status, message, tools, luts, ffs, "
        "multipliers, memory_bits, fmax_mhz) VALUES(?, ?, 'ecp5', 1, 'ok', '', '', ?, 1, 1, 1, ?)",
        {config_hash(c), area_key(c), 1000 + word, word == 8 ? 99.0 : 101.0});
  }
  const Environment path("PATH", "/nonexistent");  // no Yosys
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.cost, 1010);
  EXPECT_EQ(result.certificate.reductions[0].text, "area.ecp5.fmax_mhz is 99, at least 100");
}

// Where the widest point does not hold otherwise, it has no area, which is no misspelt metric.
TEST(Recommend, AWidestPointThatDoesNotHoldIsNotSynthesised) {
  std::string text = area_search_text;
  text.replace(text.find("at_most = 0.3"), 13, "at_most = 1e-9");
  Bench b(text, FormatId::span_uv, 7);
  const Environment path("PATH", "/nonexistent");  // no Yosys
  const SearchResult result = run_search(b.plan, b.runner, b.store, {}, {});
  EXPECT_FALSE(result.found);
  ASSERT_FALSE(result.failing.empty());
  EXPECT_NE(result.failing[0].find("span.u.p999 is "), std::string::npos) << result.failing[0];
}

// An estimate at most what the middle width has.
TEST(Recommend, EstimatesAndClocksMayBeConstraints) {
  const auto limited = [](const std::string& metric, double limit) {
    std::string text = search_text;
    text.replace(text.find("[search]"), 0,
                 fmt::format("[[constraint]]\nmetric = \"{}\"\nat_most = {}\n", metric, limit));
    return text;
  };
  const auto found = [&](const std::string& metric, double limit) {
    Bench b(limited(metric, limit));
    PointRunner runner(
        b.plan.base, {demo_scene(64, 48)},
        [](const std::vector<Scene>& scenes) -> Measure {
          return [measure = fake_meter()(scenes)](const Config& c) {
            PointResult r = measure(c);
            add_timing(c, r.metrics);
            add_estimates(c, r.metrics);
            return r;
          };
        },
        b.store, "test");
    return run_search(b.plan, runner, b.store, {}, {}).found;
  };
  Metrics widest;
  const Config widest_config =
      with_keys(shipped_config("depth16"), {{"formats.span.h.word", std::int64_t{26}}});
  add_timing(widest_config, widest);
  add_estimates(widest_config, widest);
  for (const char* metric : {"estimate.ecp5.multipliers", "estimate.ecp5.luts", "timing.pixel_unit"}) {
    EXPECT_TRUE(found(metric, widest.at(metric))) << metric;
    EXPECT_FALSE(found(metric, widest.at(metric) - 1)) << metric;
  }
}

TEST(Recommend, AxesThatDoNotMoveTheCostAreNamed) {
  const std::string axes = R"([[vary]]
keys = ["depth.bits"]
values = [12, 16]
[[vary]]
keys = ["formats.texture.mix.word", "formats.texture.color.word"]
values = [10, 12]
[[vary]]
keys = ["reciprocal.edge.bits_per_cycle"]
values = [1]
)";
  std::string text = search_text;
  text.replace(text.find("[[constraint]]"), 0, axes);
  const auto idle = [&](const std::string& cost) {
    const StudyPlan plan = plan_of(text + "cost = \"" + cost + "\"\n");
    return idle_axes(plan, {demo_scene(64, 48)});
  };
  const std::string mix = "formats.texture.mix.word, formats.texture.color.word",
                    fixed = "reciprocal.edge.bits_per_cycle";
  EXPECT_EQ(idle("estimate.ecp5.luts"), (std::vector<std::string>{"depth.bits", mix, fixed}));
  EXPECT_EQ(idle("estimate.ecp5.luts + memory.depth_bits / 1000"), (std::vector<std::string>{mix, fixed}));
  EXPECT_EQ(idle("cost.register_bits"), std::vector{fixed});
  EXPECT_EQ(idle("cost.table_bits"),
            (std::vector<std::string>{"formats.span.h.word", "depth.bits", mix, fixed}));
  EXPECT_TRUE(idle("span.u.max").empty()) << "known only after a measurement";
}

TEST(Recommend, ASweepRecommendsTheCheapestThatHoldsAndTheKnee) {
  std::string text = search_text.substr(0, search_text.find("[search]"));
  Bench b(text);
  const SweepResult result = run_sweep(b.plan, b.runner, b.store, {});
  EXPECT_EQ(result.points, 9U);
  EXPECT_EQ(result.refused, 1U);
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_GE(recommended.size(), 1U);
  EXPECT_EQ(parse_config(b.store.point(recommended[0].hash)->config, "").format(FormatId::span_h).word, 22);
  EXPECT_NE(recommended[0].reason.find("cheapest"), std::string::npos);
}

// Cheapest by what the study says, which here falls with the width; a point without it is not recommended.
TEST(Recommend, TheCostIsTheStudys) {
  std::string text = search_text.substr(0, search_text.find("[search]"));
  text.replace(text.find("[[vary]]"), 0, "cost = \"cost.table_bits\"\n");
  Bench b(text);
  PointRunner runner(
      b.plan.base, {demo_scene(64, 48)},
      [](const std::vector<Scene>& scenes) -> Measure {
        return [measure = fake_meter()(scenes)](const Config& c) {
          PointResult r = measure(c);
          const int word = c.format(FormatId::span_h).word;
          r.metrics["cost.table_bits"] = word == 26 ? std::nan("") : 100 - word;
          return r;
        };
      },
      b.store, "test");
  run_sweep(b.plan, runner, b.store, {});
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_GE(recommended.size(), 1U);
  EXPECT_EQ(recommended[0].reason, "the cheapest that holds all constraints: cost.table_bits = 75");
}

TEST(Recommend, WhatIsRecommendedHoldsAtEveryDepthRange) {
  std::string text = search_text.substr(0, search_text.find("[search]"));
  text += "[[vary]]\nkeys = [\"scene.s_ratio\"]\nvalues = [80, 20, 40]\n";
  Bench b(text);
  PointRunner runner(
      b.plan.base, {demo_scene(64, 48)},
      [](const std::vector<Scene>& scenes) -> Measure {
        return [measure = fake_meter()(scenes), ratio = scenes[0].s_max / scenes[0].s_min](const Config& c) {
          PointResult r = measure(c);
          r.metrics["span.u.p999"] *= ratio / 20;  // 22 bits hold at 20 alone
          return r;
        };
      },
      b.store, "test");
  run_sweep(b.plan, runner, b.store, {});
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_GE(recommended.size(), 1U);
  EXPECT_EQ(parse_config(b.store.point(recommended[0].hash)->config, "").format(FormatId::span_h).word, 24);
  EXPECT_EQ(recommended[0].reason,
            "the cheapest that holds all constraints at every scene.s_ratio: cost.register_bits = 24");
  // The one that errs most of its three points is chosen.
  const auto settings =
      b.store.rows("SELECT settings FROM study_points WHERE hash = ?", {recommended[0].hash});
  EXPECT_NE(text_of(settings.at(0).at(0)).find("80"), std::string::npos) << text_of(settings.at(0).at(0));
}

TEST(Recommend, TheKneeIsTheBendOfTheFront) {
  // The last two are dominated; the third bends most.
  const std::vector<std::pair<double, double>> points{{1, 1},      {2, 0.5}, {2.2, 0.01}, {8, 0.008},
                                                      {16, 0.007}, {4, 2},   {3, 0.4}};
  EXPECT_EQ(knee(points), std::optional<std::size_t>(2));
  EXPECT_EQ(knee({{1, 1}, {2, 0.5}}), std::nullopt);
  EXPECT_EQ(knee({{1, 0}, {2, -1}, {3, std::nan("")}, {4, 1}}), std::nullopt);
}

TEST(Recommend, EstimatesAreMetrics) {
  std::map<std::string, double, std::less<>> metrics;
  add_estimates(shipped_config("narrow"), metrics);
  EXPECT_GT(metrics.at("estimate.ice40.luts"), 100);
  EXPECT_GT(metrics.at("estimate.ecp5.multipliers"), 0);
  std::map<std::string, double, std::less<>> none;
  Config config = shipped_config("depth16");
  config.pixel_reciprocal.pipelined = false;
  add_estimates(config, none);
  // The pixel stages need no such unit, as long as nothing in them is linear in the distance.
  EXPECT_FALSE(none.contains("estimate.ecp5.luts"));
  EXPECT_GT(none.at("estimate.ecp5.pixel_luts"), 1000);
  EXPECT_GT(none.at("estimate.ecp5.late_pixel_luts"), 1000);
  config.depth_code = DepthCode::linear;
  none.clear();
  add_estimates(config, none);
  EXPECT_TRUE(none.empty());
}

TEST(Recommend, ARecommendedPointIsExaminedWhole) {
  TemporaryFolder folder;
  Store store(folder.path("study.db"), "test");
  const StudyPlan plan = plan_of(R"(
[study]
name = "examined"
base = "narrow"
metrics = ["span.u.rms"]
[[vary]]
keys = ["formats.span.uv.word"]
values = [22]
[area]
families = ["ecp5"]
place = true
[report]
budget = true
bounds = true
)");
  // Known counts, and no nextpnr for the clock.
  const Environment nextpnr("BITSPAN_NEXTPNR_ECP5", "/nonexistent/nextpnr");
  plant_area(store, plan.base, "ecp5", 5281);
  const std::vector<Scene> scenes{demo_scene(96, 72)};
  PointRunner runner(
      plan.base, scenes,
      [](std::vector<Scene> s) -> Measure {
        return [meter = std::make_shared<PointMeter>(std::move(s))](const Config& c) {
          return meter->measure(c);
        };
      },
      store, "test");
  const Point base = runner.prepare({});
  runner.run({base}, {});
  std::vector<std::string> told;
  const Examination e = examine(plan, {base.hash, "the base"}, scenes, store,
                                [&](const std::string& what) { told.push_back(what); }, {});
  EXPECT_TRUE(e.held) << (e.lines.empty() ? "" : e.lines[0]);
  EXPECT_GE(told.size(), 3U);
  const auto count = [&](const std::string& table) {
    return integer_of(store.rows("SELECT count(*) FROM " + table)[0][0]);
  };
  EXPECT_EQ(count("recommended"), 1);
  EXPECT_GT(count("budget"), 20);
  EXPECT_GT(count("causes"), 1);
  EXPECT_EQ(count("pictures"), 6);
  EXPECT_EQ(count("bounds WHERE observed > bound"), 0);
  EXPECT_GT(count("bounds WHERE observed > 0"), 3);
  for (const Row& row : store.rows("SELECT place, bound, observed FROM bounds")) {
    const std::string place = fmt::format("bound {}: ", text_of(row[0]));
    const auto line =
        std::ranges::find_if(e.lines, [&](const std::string& l) { return l.starts_with(place); });
    ASSERT_NE(line, e.lines.end()) << place;
    EXPECT_TRUE(line->ends_with(fmt::format(", {:.1f} %", 100 * number_of(row[2]) / number_of(row[1]))))
        << *line;
  }
  // The clock is missed, and tried for the next time; the rest is as it is with one.
  EXPECT_EQ(e.lines.back(),
            "area ecp5: 5281 LUTs, 1 flip-flops, 1 multipliers, 1 memory bits, failed: no clock in "
            "ecp5: cannot start /nonexistent/nextpnr; ./dev setup installs it for ./dev run, "
            "$BITSPAN_NEXTPNR_ECP5 names another");
  EXPECT_EQ(count("areas WHERE placed = 1 AND status = 'failed' AND luts = 5281"), 1);
  EXPECT_THROW(examine(plan, {"0123", ""}, scenes, store, [](const std::string&) {}, {}), InputError);
}

// A limit between what two views need: one of them fails, openly, with its name and value.
TEST(Recommend, ViewsThatChoseNoPointValidate) {
  TemporaryFolder folder;
  Store store(folder.path("study.db"), "test");
  const Config config = shipped_config("narrow");
  const auto error = [&](const Scene& scene) {
    return PointMeter({scene}).measure(config).metrics.at("span.u.p999");
  };
  const auto named = [](Scene scene, const std::string& name) {
    scene.name = name;
    return scene;
  };
  const Scene easy = named(demo_scene(48, 36), "easy");
  const Scene hard = named(demo_scene(96, 72), "hard");
  const double of_easy = error(easy);
  const double of_hard = error(hard);
  const double low = std::min(of_easy, of_hard);
  const double high = std::max(of_easy, of_hard);
  ASSERT_LT(low, high);
  const double limit = (low + high) / 2;
  StudyPlan plan = plan_of(fmt::format(R"(
[study]
name = "validated"
base = "narrow"
[[vary]]
keys = ["formats.span.uv.word"]
values = [22]
[[constraint]]
metric = "span.u.p999"
at_most = {}
)",
                                       limit));
  plan.validation = {"easy", "hard", "none"};
  const auto load = [&](const std::string& name) {
    return name == "none" ? std::vector<Scene>{} : name == "easy" ? std::vector{easy} : std::vector{hard};
  };
  PointRunner runner(
      plan.base, {easy},
      [](std::vector<Scene> s) -> Measure {
        return [meter = std::make_shared<PointMeter>(std::move(s))](const Config& c) {
          return meter->measure(c);
        };
      },
      store, "test", asked_of(plan));
  run_sweep(plan, runner, store, {});
  const std::string hash = text_of(store.rows("SELECT hash FROM study_points")[0][0]);
  const Validation v = validate(plan, {hash, ""}, load, store, [](const std::string&) {}, {});
  EXPECT_EQ(v.views, 2U);
  EXPECT_EQ(v.held, 1U);
  ASSERT_EQ(v.lines.size(), 2U);
  EXPECT_EQ(v.lines[0], "validated on 2 views that no point was chosen by: all constraints hold on 1");
  const std::string worst = of_hard > of_easy ? "hard" : "easy";
  EXPECT_NE(v.lines[1].find(fmt::format("1 of 2 hold; the worst: {:.4g} on {}, ", high, worst)),
            std::string::npos)
      << v.lines[1];
  const auto findings = store.rows("SELECT line FROM findings ORDER BY rowid");
  ASSERT_EQ(findings.size(), v.lines.size());
  EXPECT_EQ(text_of(findings[0][0]), v.lines[0]);
  const auto rows = store.rows("SELECT scene, value, holds FROM validation ORDER BY value");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1], (Row{worst, high, std::int64_t{0}}));
  // What it held by is told of the scenes that chose it, too.
  const auto lines = margin_lines(plan, store.metrics(hash));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find(fmt::format("span.u.p999 is {:.6g} on easy, at most ", of_easy)), std::string::npos)
      << lines[0];
  EXPECT_NE(lines[0].find(" of 1 scenes hold"), std::string::npos) << lines[0];
}

}  // namespace
}  // namespace bitspan
