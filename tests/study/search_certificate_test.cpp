// SPDX-License-Identifier: Apache-2.0
// The certificate of a search: what single steps down do, and what the answer says where nothing holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "study/search/search.hpp"
#include "tests/study/search_support.hpp"

namespace bitspan {
namespace {

TEST(Search, TheCertificateNamesWhatFails) {
  for (const SearchAlgorithm a : kAlgorithms) {
    SCOPED_TRACE(name_of(a));
    Problem p = small();
    const SearchResult r = p.run(a);
    ASSERT_TRUE(r.found);
    EXPECT_EQ(r.point, (SearchPoint{2, 1}));
    EXPECT_EQ(r.cost, 7);
    ASSERT_EQ(r.certificate.reductions.size(), 2U);
    const Reduction& first = r.certificate.reductions[0];
    EXPECT_EQ(first.key, "width0");
    EXPECT_EQ(first.from_value, "3");
    EXPECT_EQ(first.to_value, "2");
    EXPECT_EQ(first.point, (SearchPoint{1, 1}));
    EXPECT_EQ(first.outcome, ReductionOutcome::fails);
    EXPECT_EQ(first.text, "error is 0.5, at most 0.375");
    EXPECT_EQ(r.certificate.reductions[1].text, "error is 0.625, at most 0.375");
    EXPECT_EQ(to_text(r.certificate),
              "the point holds, and none of its single steps down does\n"
              "  width0 3 -> 2: error is 0.5, at most 0.375\n"
              "  width1 2 -> 1: error is 0.625, at most 0.375\n");
  }
}

TEST(Search, ANamedAxisStandsForItsKeys) {
  Problem p = small();
  p.axes[0].name = "depth";
  p.axes[0].keys = {"width0", "width1"};
  p.axes[0].offsets = {1, 5};
  for (auto& values : p.axes[0].values) values = {values[0], std::get<std::int64_t>(values[0]) + 4};
  p.axes[1].keys = {"width2"};
  const SearchResult r = search({.cost = "cost"}, p.axes, p.constraints,
                                [&](const std::vector<std::vector<KeySetting>>& points) {
                                  std::vector<Evaluation> results;
                                  for (const auto& s : points) {
                                    const Bits bits = Problem::bits_of(s);
                                    EXPECT_EQ(bits[1], bits[0] + 4);
                                    results.push_back(p.model({bits[0], bits[2]}));
                                  }
                                  return results;
                                });
  EXPECT_EQ(to_text(r.certificate),
            "the point holds, and none of its single steps down does\n"
            "  depth 2 -> 1: error is 0.5, at most 0.375\n"
            "  width2 2 -> 1: error is 0.625, at most 0.375\n");
}

TEST(Search, EveryConstraintThatFailsIsNamed) {
  Problem p = small();
  p.constraints.push_back({"sqnr", std::nullopt, 20.0});
  p.constraints.push_back({"both", 3.0, 1.0});
  p.model = [](const Bits& b) {
    Evaluation e = metrics(std::exp2(-b[0]) + std::exp2(-b[1]), b[0] + 2 * b[1]);
    e.metrics["sqnr"] = b[0] < 3 ? 19.5 : 21;
    if (b[1] >= 2) e.metrics["both"] = b[0] < 3 ? kNaN : 2;
    return e;
  };
  const SearchResult r = p.run(SearchAlgorithm::greedy);
  ASSERT_TRUE(r.found);
  EXPECT_EQ(
      r.certificate.reductions[0].text,
      "error is 0.5, at most 0.375; sqnr is 19.5, at least 20; both is not a number, at least 1, at most 3");
  EXPECT_EQ(r.certificate.reductions[1].text,
            "error is 0.625, at most 0.375; both has no value here, at least 1, at most 3");
}

TEST(Search, AtTheSmallestValueThereIsNothingToFail) {
  for (const SearchAlgorithm a : kAlgorithms) {
    Problem p = small();
    p.constraints = {at_most("error", 2)};
    const SearchResult r = p.run(a);
    expect_minimal(p, r, name_of(a));
    EXPECT_EQ(r.point, (SearchPoint{0, 0}));
    EXPECT_EQ(r.certificate.reductions[0].outcome, ReductionOutcome::at_smallest);
    EXPECT_EQ(r.certificate.reductions[0].text, "at its smallest");
    EXPECT_EQ(r.certificate.reductions[0].to_value, "");
  }
}

TEST(Search, ARefusalIsACertificateToo) {
  Problem p = small();
  p.model = [model = p.model](const Bits& b) {
    if (b[0] < 3) return Evaluation{true, "span.h is too narrow", {}};
    if (b[1] < 2) return Evaluation{true, "", {}};
    return model(b);
  };
  const SearchResult r = p.run(SearchAlgorithm::greedy);
  expect_minimal(p, r, "refused");
  EXPECT_EQ(r.certificate.reductions[0].text, "refused: span.h is too narrow");
  EXPECT_EQ(r.certificate.reductions[1].text, "refused: no reason given");
  EXPECT_TRUE(
      std::ranges::any_of(r.steps, [](const SearchStep& s) { return std::isnan(s.cost) && !s.holds; }));
}

TEST(Search, AReductionThatCostsMoreIsSaid) {
  for (const SearchAlgorithm a : kAlgorithms) {
    Problem p{axes_of(1, 1, 4), {at_most("error", 10)}, {}};
    const std::vector<double> costs{9, 8, 5, 7};
    p.model = [costs](const Bits& b) { return metrics(0, costs[static_cast<std::size_t>(b[0] - 1)]); };
    const SearchResult r = p.run(a);
    expect_minimal(p, r, name_of(a));
    EXPECT_EQ(r.point, (SearchPoint{2}));
    EXPECT_EQ(r.certificate.reductions[0].outcome, ReductionOutcome::costs_more);
    EXPECT_EQ(r.certificate.reductions[0].text, "holds, but cost rises from 5 to 8");
  }
}

TEST(Search, EqualCostGoesToTheNarrower) {
  // A key that costs nothing is cut all the same.
  for (const SearchAlgorithm a : kAlgorithms) {
    Problem p = small();
    p.axes.push_back(axis_of("free", 1, 9));
    p.model = [model = p.model](const Bits& b) {
      Evaluation e = model({b[0], b[1]});
      e.metrics["error"] += b[2] < 4 ? 1 : 0;
      return e;
    };
    const SearchResult r = p.run(a);
    expect_minimal(p, r, name_of(a));
    EXPECT_EQ(r.point[2], 3U);
  }
}

// Two widths whose sum must be 10. Every sum of 10 costs the same but for `tilt`, and the second width is
// three times as dear by the tie.
Problem tied_problem(double tilt) {
  return {axes_of(2, 2, 8), {at_most("error", 0)}, [tilt](const Bits& bits) {
            Evaluation e = metrics(bits[0] + bits[1] >= 10 ? 0 : 1, bits[0] + bits[1] + tilt * bits[0]);
            e.metrics["tie"] = bits[0] + 3 * bits[1];
            return e;
          }};
}

TEST(Search, EqualCostGoesToTheLowerTie) {
  Problem problem = tied_problem(0);
  SearchPlan plan;
  plan.evaluations = 100000;
  EXPECT_EQ(problem.bits_at(problem.run(plan).point), (Bits{2, 8})) << "without a tie";
  plan.tie = "tie";
  const SearchResult r = problem.run(plan);
  EXPECT_EQ(problem.bits_at(r.point), (Bits{8, 2}));
  EXPECT_TRUE(r.certificate.minimal()) << to_text(r.certificate);
}

TEST(Search, ANearTieGoesToTheLowerTie) {
  Problem problem = tied_problem(0.1);
  SearchPlan plan;
  plan.evaluations = 100000;
  plan.tie = "tie";
  for (const SearchAlgorithm algorithm : kAlgorithms) {
    plan.algorithm = algorithm;
    if (algorithm == SearchAlgorithm::annealing) plan.evaluations = 500;
    plan.tie_within = 0;
    const SearchResult cheapest = problem.run(plan);
    // 10.2 at (2, 8), and 10.8 at (8, 2).
    if (algorithm == SearchAlgorithm::greedy) {
      EXPECT_EQ(problem.bits_at(cheapest.point), (Bits{2, 8}));
    }
    plan.tie_within = 0.05;
    const SearchResult r = problem.run(plan);
    ASSERT_TRUE(r.found);
    EXPECT_TRUE(r.certificate.complete()) << to_text(r.certificate);
    EXPECT_TRUE(r.certificate.minimal()) << to_text(r.certificate);
    double least_cost = kInfinity;
    for (const SearchStep& step : r.steps) {
      if (step.holds) least_cost = std::min(least_cost, step.cost);
    }
    const auto tie_of = [&](const SearchPoint& p) {
      return problem.model(problem.bits_at(p)).metrics.at("tie");
    };
    EXPECT_LE(r.cost, 1.05 * least_cost);
    const SearchStep* last_best = nullptr;
    for (const SearchStep& step : r.steps) {
      if (step.best) last_best = &step;
      if (step.holds && step.cost <= 1.05 * least_cost) {
        EXPECT_GE(tie_of(step.point), tie_of(r.point));
      }
    }
    ASSERT_NE(last_best, nullptr);
    EXPECT_EQ(last_best->point, r.point) << "what is recommended";
  }
}

// A tie that rises with each bit that goes: the search ends, and keeps the bits.
TEST(Search, ATieMayRise) {
  Problem problem{axes_of(2, 2, 8), {at_most("error", 0)}, [](const Bits& bits) {
                    Evaluation e = metrics(0, 5);
                    e.metrics["tie"] = 100 - bits[0] - bits[1];
                    return e;
                  }};
  for (const SearchAlgorithm algorithm : kAlgorithms) {
    SearchPlan plan;
    plan.algorithm = algorithm;
    plan.tie = "tie";
    const SearchResult r = problem.run(plan);
    EXPECT_EQ(problem.bits_at(r.point), (Bits{8, 8})) << name_of(algorithm);
    EXPECT_TRUE(r.certificate.minimal());
    EXPECT_EQ(r.certificate.reductions[0].text, "holds, but tie rises from 84 to 85");
  }
}

TEST(Search, NothingFoundSaysWhatFailsAtTheWidest) {
  for (const SearchAlgorithm a : kAlgorithms) {
    SCOPED_TRACE(name_of(a));
    Problem p = small();
    p.constraints = {at_most("error", 0.1), at_most("cost", 5)};
    const SearchResult r = p.run(a);
    EXPECT_FALSE(r.found);
    EXPECT_EQ(r.stopped_by, StoppedBy::done);
    EXPECT_EQ(r.evaluations, 1U);
    EXPECT_TRUE(r.point.empty());
    EXPECT_TRUE(r.certificate.reductions.empty());
    EXPECT_FALSE(r.certificate.minimal());
    EXPECT_EQ(r.failing,
              std::vector<std::string>{"the widest point does not hold: error is 0.125, at most 0.1; "
                                       "cost is 12, at most 5"});
  }
  Problem refused = small();
  refused.model = [](const Bits&) { return Evaluation{true, "draws nothing", {}}; };
  EXPECT_EQ(refused.run(SearchAlgorithm::greedy).failing,
            std::vector<std::string>{"the widest point does not hold: refused: draws nothing"});
  Problem unknown = small();
  unknown.model = [](const Bits&) { return metrics(0, kNaN); };
  EXPECT_EQ(unknown.run(SearchAlgorithm::greedy).failing,
            std::vector<std::string>{"the widest point does not hold: the cost cost is not finite"});
}

TEST(Search, ACostThatIsMissingSomewhereDoesNotHoldThere) {
  Problem p = small();
  p.model = [model = p.model](const Bits& b) {
    Evaluation e = model(b);
    if (b[0] == 3) e.metrics.erase("cost");
    return e;
  };
  SearchPlan plan;
  plan.algorithm = SearchAlgorithm::max_minus_1;
  plan.pairs = false;  // one of them costs as much and has fewer bits
  const SearchResult r = p.run(plan);
  ASSERT_TRUE(r.found);
  EXPECT_EQ(r.point, (SearchPoint{3, 1}));
  EXPECT_EQ(r.certificate.reductions[0].text, "the cost cost has no value here");
}

TEST(Search, AnIncompleteCertificateSaysWhatIsMissing) {
  Problem p = small();
  SearchPlan plan;
  plan.algorithm = SearchAlgorithm::max_minus_1;
  plan.evaluations = 2;
  const SearchResult r = p.run(plan);
  EXPECT_EQ(r.stopped_by, StoppedBy::evaluations);
  EXPECT_EQ(r.point, (SearchPoint{2, 3}));
  EXPECT_FALSE(r.certificate.minimal());
  EXPECT_EQ(r.certificate.missing, (std::vector<std::string>{"width0 from 3 to 2 was not evaluated",
                                                             "width1 from 4 to 3 was not evaluated"}));
  EXPECT_EQ(to_text(r.certificate),
            "incomplete: 2 of 2 single steps down were not evaluated\n"
            "1 of 1 paired steps were not evaluated\n"
            "  width0 3 -> 2: not evaluated\n"
            "  width1 4 -> 3: not evaluated\n");
}

TEST(Certificate, FindsAPlantedPointThatIsNotMinimal) {
  Problem p = small();
  const auto certificate = [&p](const SearchPoint& point) {
    p.seen.clear();
    return certify("cost", p.axes, p.constraints, point, p.evaluate());
  };
  // The optimum, from outside the search.
  EXPECT_TRUE(certificate({2, 1}).minimal());
  // One bit too many.
  const Certificate loose = certificate({3, 1});
  EXPECT_TRUE(loose.point_holds);
  EXPECT_TRUE(loose.complete());
  EXPECT_FALSE(loose.minimal());
  EXPECT_EQ(loose.reductions[0].outcome, ReductionOutcome::passes);
  EXPECT_EQ(loose.reductions[0].text, "holds; cost is 7 against 8");
  EXPECT_EQ(loose.reductions[1].outcome, ReductionOutcome::fails);
  EXPECT_EQ(to_text(loose),
            "not minimal: a single step down holds\n"
            "  width0 4 -> 3: holds; cost is 7 against 8\n"
            "  width1 2 -> 1: error is 0.5625, at most 0.375\n");
  // A step down that changes the cost by nothing passes too.
  Problem level = table({3}, {0}, [](const Bits& b) { return b[0] > 0; });
  const Certificate equal = certify("cost", level.axes, level.constraints, {2}, level.evaluate());
  EXPECT_EQ(equal.reductions[0].outcome, ReductionOutcome::passes);
  EXPECT_FALSE(equal.minimal());
  // One bit too few: all its reductions fail as well, and that proves nothing.
  const Certificate tight = certificate({1, 1});
  EXPECT_FALSE(tight.point_holds);
  EXPECT_FALSE(tight.minimal());
  EXPECT_TRUE(to_text(tight).starts_with("the point does not hold\n"));
  // Locally minimal and not the cheapest: a certificate speaks of single steps, no more.
  EXPECT_TRUE(certificate({1, 2}).minimal());
}

TEST(Certificate, OfEveryPointOfASmallSpace) {
  std::mt19937_64 random(9);
  Problem p = separable(random, 3, 2, 5);
  int minimal = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    const SearchPoint point{i % 4, i / 4 % 4, i / 16};
    p.seen.clear();
    const bool says = certify("cost", p.axes, p.constraints, point, p.evaluate()).minimal();
    EXPECT_EQ(says, p.minimal(point)) << i;
    minimal += says ? 1 : 0;
  }
  EXPECT_GT(minimal, 0);
  EXPECT_LT(minimal, 32);
}

}  // namespace
}  // namespace bitspan
