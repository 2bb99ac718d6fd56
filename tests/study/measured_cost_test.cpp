// SPDX-License-Identifier: Apache-2.0
// The end of a search for an estimated cost: which points are synthesised, and which is recommended.
#include "study/measured_cost.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <stop_token>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/demo.hpp"
#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/recommend.hpp"
#include "tests/study/area_support.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"

namespace bitspan {
namespace {

// Widths 7 errs too much; the others hold, and the estimate rises with each bit.
const std::string estimate_search_text = R"(
[study]
name = "estimates"
base = "tiny"
[[vary]]
keys = ["formats.span.uv.word"]
values = [7, 8, 9, 10, 11, 12]
[[constraint]]
metric = "span.u.p999"
at_most = 0.3
[area]
families = ["ecp5"]
[search]
algorithm = "max-1"
cost = "estimate.ecp5.luts"
)";

// Reads a study whose base "tiny" has room for the widths.
StudyPlan estimate_plan(const std::string& text) {
  return parse_study(text, "test.toml", [](const std::string&) {
    return with_keys(tiny_config(), {{"formats.span.uv_acc.word", std::int64_t{12}}});
  });
}

// An error of half an ulp of u; the estimates are those of the configuration.
Measure estimating_meter(const std::vector<Scene>&) {
  return [](const Config& config) {
    PointResult r;
    r.metrics["span.u.p999"] = std::ldexp(0.5, -config.format(FormatId::span_uv).fraction());
    r.metrics["cost.register_bits"] = config.format(FormatId::span_uv).word;
    add_estimates(config, r.metrics);
    return r;
  };
}

struct EstimateBench {
  TemporaryFolder folder;
  Store store{folder.path("study.db"), "test"};
  StudyPlan plan;
  PointRunner runner;
  explicit EstimateBench(const std::string& text = estimate_search_text)
      : plan(estimate_plan(text)),
        runner(plan.base, {demo_scene(64, 48)}, estimating_meter, store, "test", asked_of(plan)) {}
  Config at(std::int64_t word) const { return with_keys(plan.base, {{"formats.span.uv.word", word}}); }
  std::int64_t word_of(const MeasuredCost& c) const {
    return std::get<std::int64_t>(plan.axes[0].values[c.point[0]][0]);
  }
  void plant(std::int64_t word, std::int64_t luts, AreaPart part = AreaPart::spans) {
    const std::string table = part == AreaPart::spans ? "areas" : "pixel_areas";
    store.run("INSERT INTO " + table +
                  "(config_hash, area_key, family, placed, status, message, tools, luts, ffs, multipliers, "
                  "memory_bits) VALUES(?, ?, 'ecp5', 0, 'ok', '', '', ?, 1, 2, 1)",
              {config_hash(at(word)), area_key(at(word), part), luts});
  }
  SearchResult found() { return run_search(plan, runner, store, {}, {}); }
  MeasuredCosts measure(const SearchResult& result, std::stop_token stop = {}) {
    return measure_best(
        plan, result, runner, store, [](const std::string&) {}, std::move(stop));
  }
};

// What a cost of LUTs changes by where the estimate is larger by its ±, rounded as it is computed.
double change_by_error(const AreaEstimate& e) { return e.luts + e.luts_error - e.luts; }

// The second narrowest is the smallest as measured. No tool is there to measure another point.
TEST(MeasuredCost, RanksByWhatWasMeasured) {
  EstimateBench b;
  for (const auto& [word, luts] : {std::pair{8, 300}, {9, 100}, {10, 200}, {11, 250}, {12, 220}})
    b.plant(word, luts);
  const Environment path("PATH", "/nonexistent");
  const SearchResult result = b.found();
  ASSERT_TRUE(result.found);
  EXPECT_EQ(b.plan.axes[0].values[result.point[0]][0], KeyValue(std::int64_t{8}));
  const AreaEstimate best = estimate_area(b.at(8), Family::ecp5);
  EXPECT_DOUBLE_EQ(result.cost, best.luts);
  EXPECT_DOUBLE_EQ(result.cost_error, change_by_error(best));

  const MeasuredCosts costs = b.measure(result);
  // Those that a search has seen, and that lie within the error of the best estimate.
  std::vector<std::int64_t> expected_words;
  for (const std::int64_t word : {8, 9, 10, 11, 12}) {
    const bool near = estimate_area(b.at(word), Family::ecp5).luts <= best.luts + best.luts_error;
    if (near || expected_words.size() < 3) expected_words.push_back(word);
  }
  ASSERT_EQ(costs.points.size(), expected_words.size());
  EXPECT_EQ(costs.left_out, 0U);
  EXPECT_EQ(b.word_of(costs.points[0]), 9);
  EXPECT_EQ(costs.points[0].measured, 100);
  EXPECT_DOUBLE_EQ(costs.points[0].estimated, estimate_area(b.at(9), Family::ecp5).luts);
  EXPECT_DOUBLE_EQ(costs.points[0].error, change_by_error(estimate_area(b.at(9), Family::ecp5)));
  for (std::size_t i = 1; i < costs.points.size(); ++i)
    EXPECT_GT(costs.points[i].measured, costs.points[i - 1].measured);

  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_EQ(recommended.size(), 1U);
  EXPECT_EQ(recommended[0].hash, costs.points[0].hash);
  EXPECT_EQ(recommended[0].reason,
            fmt::format("the least of {} synthesised: estimate.ecp5.luts = 100 measured, {} estimated",
                        costs.points.size(), cost_text(costs.points[0].estimated, costs.points[0].error)));
  EXPECT_NE(recommended[0].reason.find(" ± "), std::string::npos);
  // The certificate is that of the search's point, and stays so.
  EXPECT_EQ(result.certificate.reductions[0].from_value, "8");
  // A search that is run again forgets what it measured until it measures again.
  const auto before = b.store.rows("SELECT * FROM measured_costs ORDER BY i");
  EXPECT_EQ(before.size(), costs.points.size());
  const SearchResult again = b.found();
  EXPECT_TRUE(b.store.rows("SELECT * FROM measured_costs").empty());
  b.measure(again);
  EXPECT_EQ(b.store.rows("SELECT * FROM measured_costs ORDER BY i"), before);
}

TEST(MeasuredCost, StaysBelowItsLimit) {
  EstimateBench b(estimate_search_text + "measure = 2\n");
  for (const auto& [word, luts] : {std::pair{8, 300}, {9, 310}, {10, 1}, {11, 1}, {12, 1}})
    b.plant(word, luts);
  const Environment path("PATH", "/nonexistent");
  const SearchResult result = b.found();
  const MeasuredCosts costs = b.measure(result);
  ASSERT_EQ(costs.points.size(), 2U);
  EXPECT_EQ(b.word_of(costs.points[0]), 8);
  EXPECT_EQ(b.word_of(costs.points[1]), 9);
  std::size_t near = 0;
  for (const std::int64_t word : {10, 11, 12}) {
    near += estimate_area(b.at(word), Family::ecp5).luts <= result.cost + result.cost_error ? 1 : 0;
  }
  EXPECT_EQ(costs.left_out, near);
}

TEST(MeasuredCost, IsOffWhereNothingIsToBeMeasured) {
  const auto ends = [](const std::string& from, const std::string& to) {
    std::string text = estimate_search_text;
    text.replace(text.find(from), from.size(), to);
    return ends_with_synthesis(estimate_plan(text));
  };
  EXPECT_TRUE(ends("\"max-1\"", "\"max-1\""));
  EXPECT_TRUE(ends("estimate.ecp5.luts", "cost.register_bits + 2 * estimate.ecp5.multipliers"));
  EXPECT_FALSE(ends("\"max-1\"", "\"max-1\"\nmeasure = 0"));
  EXPECT_FALSE(ends("estimate.ecp5.luts", "cost.register_bits"));
  EXPECT_FALSE(ends("estimate.ecp5.luts", "estimate.ice40.luts"));
  EXPECT_FALSE(ends("estimate.ecp5.luts", "estimate.ice40.luts + estimate.ecp5.luts"));
  EXPECT_FALSE(ends("[area]\nfamilies = [\"ecp5\"]\n", ""));
  // Then the search's own point is recommended, with the ± of its cost.
  EstimateBench b(estimate_search_text + "measure = 0\n");
  const SearchResult result = b.found();
  EXPECT_TRUE(b.measure(result).points.empty());
  const auto recommended = recommendations(b.plan, b.store);
  ASSERT_EQ(recommended.size(), 1U);
  EXPECT_EQ(recommended[0].reason,
            "found by the search: estimate.ecp5.luts = " + cost_text(result.cost, result.cost_error));
}

TEST(MeasuredCost, AStopLeavesOutTheRest) {
  EstimateBench b;
  const SearchResult result = b.found();
  std::stop_source stop;
  stop.request_stop();
  const MeasuredCosts costs = b.measure(result, stop.get_token());
  EXPECT_TRUE(costs.points.empty());
  EXPECT_GE(costs.left_out, 1U);
  // What the search found is recommended.
  EXPECT_EQ(recommendations(b.plan, b.store).at(0).reason.substr(0, 20), "found by the search:");
}

// The counts stand for all estimates in an expression; what is not estimated stays as it was.
TEST(MeasuredCost, AnExpressionTakesTheCounts) {
  std::string text = estimate_search_text;
  text.replace(text.find("\"estimate.ecp5.luts\""), 20,
               "\"estimate.ecp5.luts + 100 * estimate.ecp5.multipliers + 10 * span.u.p999\"\nmeasure = 1");
  EstimateBench b(text);
  b.plant(8, 300);
  const Environment path("PATH", "/nonexistent");
  const SearchResult result = b.found();
  const MeasuredCosts costs = b.measure(result);
  ASSERT_EQ(costs.points.size(), 1U);
  const double p999 = std::ldexp(0.5, -b.at(8).format(FormatId::span_uv).fraction());
  EXPECT_DOUBLE_EQ(costs.points[0].measured, 300 + 100 * 2 + 10 * p999);
  const AreaEstimate e = estimate_area(b.at(8), Family::ecp5);
  const auto cost = [&](double luts) { return luts + 100 * e.multipliers + 10 * p999; };
  EXPECT_DOUBLE_EQ(costs.points[0].error, cost(e.luts + e.luts_error) - cost(e.luts));
}

// The pixel stages are a netlist of their own, and the two sums are taken together.
TEST(MeasuredCost, CountsThePartsOfTheCost) {
  std::string text = estimate_search_text;
  text.replace(text.find("\"estimate.ecp5.luts\""), 20,
               "\"estimate.ecp5.luts + estimate.ecp5.pixel_luts\"\nmeasure = 3");
  EstimateBench b(text);
  for (const auto& [word, luts, pixel_luts] : {std::tuple{8, 300, 900}, {9, 310, 800}, {10, 320, 880}}) {
    b.plant(word, luts);
    b.plant(word, pixel_luts, AreaPart::pixels);
  }
  const Environment path("PATH", "/nonexistent");
  const SearchResult result = b.found();
  const MeasuredCosts costs = b.measure(result);
  ASSERT_EQ(costs.points.size(), 3U);
  EXPECT_EQ(b.word_of(costs.points[0]), 9);
  EXPECT_EQ(costs.points[0].measured, 310 + 800);
  EXPECT_EQ(costs.points[1].measured, 300 + 900);
}

// A constraint on an estimate holds by the counts, or the point is not recommended.
TEST(MeasuredCost, ACountThatBreaksAConstraintIsNotRecommended) {
  const auto limited = [](double luts, const std::string& cost) {
    std::string text = estimate_search_text;
    text.replace(text.find("[area]"), 6,
                 fmt::format("[[constraint]]\nmetric = \"estimate.ecp5.luts\"\nat_most = {}\n[area]", luts));
    return text.replace(text.find("cost = \"estimate.ecp5.luts\""), 27, fmt::format("cost = \"{}\"", cost));
  };
  EstimateBench b(limited(10000, "estimate.ecp5.luts") + "measure = 3\n");
  for (const auto& [word, luts] : {std::pair{8, 10001}, {9, 10000}, {10, 9999}}) b.plant(word, luts);
  const Environment path("PATH", "/nonexistent");
  const MeasuredCosts costs = b.measure(b.found());
  ASSERT_EQ(costs.points.size(), 3U);
  EXPECT_EQ(b.word_of(costs.points[0]), 10);
  EXPECT_EQ(b.word_of(costs.points[2]), 8);
  EXPECT_TRUE(std::isnan(costs.points[2].measured));
  EXPECT_EQ(costs.points[2].message, "estimate.ecp5.luts is 10001 by its counts; at most 10000");
  EXPECT_EQ(recommendations(b.plan, b.store).at(0).hash, costs.points[0].hash);

  // Where the cost is no estimate, the answer of the search is counted all the same, and the message says
  // what its limit is not.
  EstimateBench alone(limited(10000, "cost.register_bits") + "measure = 1\n");
  alone.plant(8, 12000);
  EXPECT_EQ(alone.measure(alone.found()).points.size(), 1U);
  EXPECT_EQ(recommendations(alone.plan, alone.store).at(0).reason,
            "found by the search: cost.register_bits = 8; estimate.ecp5.luts is 12000 by its counts; at most "
            "10000");
}

// Yosys itself, on a netlist of some hundred LUTs.
TEST(MeasuredCost, IsThatOfTheTools) {
  EstimateBench b(estimate_search_text + "measure = 1\n");
  const SearchResult result = b.found();
  const MeasuredCosts costs = b.measure(result);
  ASSERT_EQ(costs.points.size(), 1U);
  EXPECT_EQ(costs.points[0].measured,
            static_cast<double>(measure_area(b.at(8), {Family::ecp5}, false).counts.luts));
}

TEST(MeasuredCost, TheErrorOfAnExpressionIsTheRootOfTheSummedSquares) {
  const Metrics metrics{{"estimate.ecp5.luts", 1000},
                        {"estimate.ecp5.luts_error", 30},
                        {"estimate.ecp5.ffs", 2000},
                        {"estimate.ecp5.ffs_error", 20},
                        {"cost.table_bits", 7}};
  const auto error = [&](const std::string& text) {
    Expression expression(text);
    return cost_error(expression, metrics);
  };
  EXPECT_DOUBLE_EQ(error("estimate.ecp5.luts"), 30);
  EXPECT_DOUBLE_EQ(error("estimate.ecp5.luts + 2 * estimate.ecp5.ffs + cost.table_bits"), 50);
  EXPECT_EQ(error("cost.table_bits"), 0);
  EXPECT_EQ(error("estimate.ice40.luts"), 0);
  EXPECT_EQ(cost_text(4512.3, 163), "4512 ± 160");
  EXPECT_EQ(cost_text(1234.567, 0), "1234.57");
}

}  // namespace
}  // namespace bitspan
