// SPDX-License-Identifier: Apache-2.0
// Paired steps: one value up on one axis, two values down on another, after the single steps down.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "study/search/search.hpp"
#include "tests/study/search_support.hpp"

namespace bitspan {
namespace {

// max-1 goes down axis 0 first and ends on (2, 3), of which no single step down holds. The pair (3, 1) does.
Problem stairs() {
  return table({5, 5}, {1, 1},
               [](const Bits& b) { return (b[0] >= 2 && b[1] >= 3) || (b[0] >= 3 && b[1] >= 1); });
}

SearchPlan plan_of(bool pairs, int evaluations = 1000) {
  SearchPlan plan;
  plan.algorithm = SearchAlgorithm::max_minus_1;
  plan.evaluations = evaluations;
  plan.cost = "cost";
  plan.pairs = pairs;
  return plan;
}

TEST(Pairs, TheSearchGoesOnFromAPairThatHolds) {
  Problem p = stairs();
  const SearchResult singles = p.run(plan_of(false));
  EXPECT_EQ(singles.point, (SearchPoint{2, 3}));
  EXPECT_TRUE(singles.certificate.minimal());
  EXPECT_TRUE(singles.certificate.pairs.empty());
  EXPECT_EQ(singles.certificate.pairs_missing(), 0U);
  EXPECT_TRUE(
      to_text(singles.certificate).starts_with("the point holds, and none of its single steps down does\n"));

  const SearchResult r = p.run(plan_of(true));
  EXPECT_EQ(r.point, (SearchPoint{3, 1}));
  EXPECT_EQ(r.cost, 4);
  EXPECT_EQ(r.stopped_by, StoppedBy::done);
  EXPECT_TRUE(r.certificate.minimal());
  // One pair is left: (1, 2), which costs less and fails.
  ASSERT_EQ(r.certificate.pairs.size(), 1U);
  const PairedStep& pair = r.certificate.pairs[0];
  EXPECT_EQ(pair.up, 1U);
  EXPECT_EQ(pair.down, 0U);
  EXPECT_EQ(pair.key, "width1 up, width0 down");
  EXPECT_EQ(pair.from_values, "1, 3");
  EXPECT_EQ(pair.to_values, "2, 1");
  EXPECT_EQ(pair.point, (SearchPoint{1, 2}));
  EXPECT_EQ(pair.outcome, ReductionOutcome::fails);
  EXPECT_EQ(pair.text, "error is 1, at most 0");
  EXPECT_EQ(to_text(r.certificate),
            "the point holds, and none of its single steps down does, and none of 1 paired steps\n"
            "  width0 3 -> 2: error is 1, at most 0\n"
            "  width1 1 -> 0: error is 1, at most 0\n");
  // Until the pairs, the order of evaluations is the same.
  ASSERT_GT(r.steps.size(), singles.steps.size());
  for (std::size_t i = 0; i < singles.steps.size(); ++i) EXPECT_EQ(r.steps[i].point, singles.steps[i].point);
}

TEST(Pairs, OnlyThoseThatCostLessAreEvaluated) {
  // With these prices one value up on axis 2 costs more than two down save. Nothing holds but the start of
  // the pairs and what is wider.
  Problem p = table({6, 6, 6}, {2, 3, 9}, [](const Bits& b) { return b[0] >= 3 && b[1] >= 3 && b[2] >= 3; });
  const SearchResult singles = p.run(plan_of(false));
  const SearchResult all = p.run(plan_of(true));
  EXPECT_EQ(all.evaluations, singles.evaluations + 6);
  EXPECT_EQ(all.certificate.pairs.size(), 4U);

  p.seen.clear();
  const CostOf cost_of = [&](const std::vector<KeySetting>& s) {
    const Bits bits = Problem::bits_of(s);
    return bits[1] == 1 ? kNaN : p.model(bits).metrics.at("cost");  // no configuration, or its cost
  };
  const SearchResult r = search(plan_of(true), p.axes, p.constraints, p.evaluate(), {}, {}, cost_of);
  EXPECT_EQ(r.point, singles.point);
  // Up 0 or 1 and down 2; up 1 and down 0. Up 0 and down 1 has no cost.
  EXPECT_EQ(r.evaluations, singles.evaluations + 3);
  ASSERT_EQ(r.certificate.pairs.size(), 3U);
  EXPECT_EQ(r.certificate.pairs_missing(), 0U);
  EXPECT_EQ(r.certificate.pairs[0].point, (SearchPoint{4, 3, 1}));  // the cheapest first
  EXPECT_EQ(r.certificate.pairs[1].point, (SearchPoint{3, 4, 1}));
  EXPECT_EQ(r.certificate.pairs[2].point, (SearchPoint{1, 4, 3}));
  EXPECT_EQ(r.steps[singles.steps.size()].point, (SearchPoint{4, 3, 1}));
}

TEST(Pairs, ALimitSaysHowManyWereNotEvaluated) {
  Problem p = table({6, 6, 6}, {2, 3, 9}, [](const Bits& b) { return b[0] >= 3 && b[1] >= 3 && b[2] >= 3; });
  const int singles = static_cast<int>(p.run(plan_of(false)).evaluations);
  const SearchResult r = p.run(plan_of(true, singles + 2));
  EXPECT_EQ(r.stopped_by, StoppedBy::evaluations);
  EXPECT_EQ(r.point, (SearchPoint{3, 3, 3}));
  EXPECT_TRUE(r.certificate.complete());
  EXPECT_TRUE(r.certificate.minimal());
  EXPECT_TRUE(r.certificate.missing.empty());
  const auto evaluated = static_cast<std::size_t>(
      std::ranges::count(r.certificate.pairs, ReductionOutcome::fails, &PairedStep::outcome));
  EXPECT_EQ(r.certificate.pairs_missing(), 4U);
  EXPECT_EQ(r.certificate.pairs.size(), evaluated + 4);
  EXPECT_NE(to_text(r.certificate).find("4 of 6 paired steps were not evaluated\n"), std::string::npos)
      << to_text(r.certificate);
}

TEST(Pairs, ACertificateFindsAPairThatHolds) {
  Problem p = stairs();
  const Certificate c = certify("cost", p.axes, p.constraints, {2, 3}, p.evaluate());
  EXPECT_TRUE(c.point_holds);
  EXPECT_FALSE(c.minimal());
  EXPECT_EQ(to_text(c),
            "not minimal: a paired step holds\n"
            "  width0 2 -> 1: error is 1, at most 0\n"
            "  width1 3 -> 2: error is 1, at most 0\n"
            "  width0 up, width1 down 2, 3 -> 3, 1: holds; cost is 4 against 5\n");
}

TEST(Pairs, StayInTheirCombinationOfCategories) {
  Problem p = stairs();
  Axis kind;
  kind.keys = {"kind"};
  kind.values = {{KeyValue("a")}, {KeyValue("b")}};
  p.axes.insert(p.axes.begin(), kind);
  const Evaluate evaluate = [&](const std::vector<std::vector<KeySetting>>& points) {
    std::vector<Evaluation> out;
    for (const auto& s : points) out.push_back(p.model(Problem::bits_of({s[1], s[2]})));
    return out;
  };
  const SearchResult r = search(plan_of(true), p.axes, p.constraints, evaluate);
  ASSERT_EQ(r.combinations.size(), 2U);
  EXPECT_EQ(r.combinations[1].point, (SearchPoint{1, 3, 1}));
  ASSERT_EQ(r.combinations[1].certificate.pairs.size(), 1U);
  EXPECT_EQ(r.combinations[1].certificate.pairs[0].point, (SearchPoint{1, 1, 2}));
}

}  // namespace
}  // namespace bitspan
