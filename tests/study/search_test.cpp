// SPDX-License-Identifier: Apache-2.0
// Word-length search on made-up error models whose optimum is known by brute force.
#include "study/search/search.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "tests/study/search_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

// A number in [0, 1) that depends on every width and has no order.
double noise(const Bits& bits, std::uint64_t salt) {
  std::uint64_t h = salt;
  for (const int b : bits) {
    h = (h ^ static_cast<std::uint64_t>(b)) * 0x9e3779b97f4a7c15U;
    h ^= h >> 29;
  }
  return std::ldexp(static_cast<double>((h * 0xbf58476d1ce4e5b9U) >> 11), -53);
}

struct Worst {
  std::map<SearchAlgorithm, double> factor = {}, sum = {};
  std::map<SearchAlgorithm, std::size_t> evaluations = {};
  int runs = 0;
  void note(SearchAlgorithm a, double f, std::size_t n) {
    factor[a] = std::max(factor[a], f);
    sum[a] += f;
    evaluations[a] += n;
  }
  void print(const char* what) const {
    for (const SearchAlgorithm a : kAlgorithms) {
      fmt::print("{}, {}: cost over the optimum worst {:.3f}, mean {:.3f}; {:.0f} evaluations per search\n",
                 what, name_of(a), factor.at(a), sum.at(a) / runs,
                 static_cast<double>(evaluations.at(a)) / runs);
    }
  }
};

void against_brute_force(const char* what, int runs, const std::map<SearchAlgorithm, double>& factors,
                         const std::function<Problem(std::mt19937_64&)>& make) {
  std::mt19937_64 random(7);
  Worst worst;
  for (int run = 0; run < runs; ++run) {
    Problem problem = make(random);
    const double optimum = problem.optimum();
    if (!problem.holds(SearchPoint(problem.axes.size(), problem.axes[0].values.size() - 1))) continue;
    ++worst.runs;
    ASSERT_LT(optimum, kInfinity);
    for (const SearchAlgorithm a : kAlgorithms) {
      const SearchResult r = problem.run(a);
      expect_minimal(problem, r, fmt::format("{} {} {}", what, run, name_of(a)));
      worst.note(a, r.cost / optimum, r.evaluations);
      EXPECT_LE(r.cost, optimum * factors.at(a)) << what << " " << run << " " << name_of(a);
    }
  }
  ASSERT_GT(worst.runs, runs / 3);
  worst.print(what);
}

std::map<SearchAlgorithm, double> factors(double min_plus_1, double max_minus_1, double greedy,
                                          double annealing) {
  return {{SearchAlgorithm::min_plus_1, min_plus_1},
          {SearchAlgorithm::max_minus_1, max_minus_1},
          {SearchAlgorithm::greedy, greedy},
          {SearchAlgorithm::annealing, annealing}};
}

TEST(Search, SeparableErrorsNearTheOptimum) {
  against_brute_force("separable", 60, factors(1.25, 1.1, 1.1, 1.02),
                      [](std::mt19937_64& random) { return separable(random, 4, 2, 8); });
}

TEST(Search, ErrorsThatAreNotMonotone) {
  against_brute_force("noisy", 60, factors(1.6, 1.6, 1.45, 1.1), [](std::mt19937_64& random) {
    Problem p = separable(random, 4, 2, 8);
    const std::uint64_t salt = random();
    p.model = [model = p.model, salt](const Bits& bits) {
      Evaluation e = model(bits);
      e.metrics["error"] *= std::exp2(2 * noise(bits, salt) - 1);
      return e;
    };
    return p;
  });
}

TEST(Search, PlateausAndCountsThatMustBeZero) {
  // An error only the worst term of which counts, and a count of wrong pixels that stays 0 down to a cliff.
  against_brute_force("plateaus", 60, factors(1.15, 1.25, 1.15, 1.02), [](std::mt19937_64& random) {
    Problem p = separable(random, 4, 2, 8);
    const int cliff = std::uniform_int_distribution<int>(9, 14)(random);
    p.constraints[0].metric = "stairs";
    p.constraints.push_back(at_most("wrong", 0));
    p.model = [model = p.model, cliff](const Bits& bits) {
      Evaluation e = model(bits);
      e.metrics["stairs"] = std::exp2(std::ceil(std::log2(e.metrics["error"])));
      e.metrics["wrong"] =
          std::max(0, cliff - bits[0] - bits[1]) + (std::min(bits[2], bits[3]) < 3 ? 100 : 0);
      return e;
    };
    p.constraints[0].at_most = *p.constraints[0].at_most * 2;
    return p;
  });
}

TEST(Search, RefusedPoints) {
  // Two widths that must not part by more than 3, and a wall in the middle of the space.
  against_brute_force("refusals", 60, factors(1.45, 1.75, 1.1, 1.02), [](std::mt19937_64& random) {
    Problem p = separable(random, 4, 2, 8);
    p.model = [model = p.model](const Bits& bits) {
      if (std::abs(bits[0] - bits[1]) > 3) return Evaluation{true, "widths part", {}};
      if (bits[2] == 5 && bits[3] > 5) return Evaluation{true, "wall", {}};
      return model(bits);
    };
    return p;
  });
}

TEST(Search, CostsThatAreNotMonotone) {
  // As synthesis gives them.
  against_brute_force("noisy cost", 60, factors(1.2, 1.2, 1.1, 1.02), [](std::mt19937_64& random) {
    Problem p = separable(random, 4, 2, 8);
    const std::uint64_t salt = random();
    p.model = [model = p.model, salt](const Bits& bits) {
      Evaluation e = model(bits);
      e.metrics["cost"] = whole(e.metrics["cost"] * (0.9 + 0.2 * noise(bits, salt)));
      return e;
    };
    return p;
  });
}

TEST(Search, AtLeastAndInfiniteMetrics) {
  // A signal-to-noise ratio, infinite where nothing is cut.
  against_brute_force("at least", 40, factors(1.1, 1.1, 1.1, 1.05), [](std::mt19937_64& random) {
    Problem p = separable(random, 4, 2, 8);
    p.constraints = {{"sqnr", std::nullopt, -20 * std::log10(*p.constraints[0].at_most)}};
    p.model = [model = p.model](const Bits& bits) {
      Evaluation e = model(bits);
      const bool exact = std::ranges::all_of(bits, [](int b) { return b > 6; });
      e.metrics["sqnr"] = exact ? kInfinity : -20 * std::log10(e.metrics["error"]);
      return e;
    };
    return p;
  });
}

TEST(Search, ManyPointsOfTheSameCost) {
  // Four axes that nothing tells apart: what is found is still one of them, and the last best step.
  for (const SearchAlgorithm a : kAlgorithms) {
    Problem p{axes_of(4, 1, 6), {at_most("error", 0.4)}, {}};
    p.model = [](const Bits& b) {
      double error = 0, cost = 0;
      for (const int bits : b) error += std::exp2(-bits);
      for (const int bits : b) cost += bits;
      return metrics(error, cost);
    };
    const SearchResult r = p.run(a);
    expect_minimal(p, r, name_of(a));
    EXPECT_EQ(r.cost, p.optimum());
  }
}

TEST(Search, ManyWideAxes) {
  // Twelve axes of 25 values: 6e16 points.
  std::mt19937_64 random(3);
  for (int run = 0; run < 3; ++run) {
    Problem problem = separable(random, 12, 8, 32);
    for (const SearchAlgorithm a : kAlgorithms) {
      const SearchResult r = problem.run(a);
      expect_minimal(problem, r, name_of(a));
      fmt::print("12 axes of 25 values, {}: cost {:.1f} after {} evaluations in {} batches\n", name_of(a),
                 r.cost, r.evaluations, problem.batches);
    }
  }
}

TEST(Search, SeedsReproduce) {
  std::mt19937_64 random(11);
  Problem p = separable(random, 6, 4, 20);
  const auto steps = [&](SearchAlgorithm a, std::uint64_t seed) {
    std::vector<SearchPoint> points;
    for (const SearchStep& s : p.run(a, seed).steps) points.push_back(s.point);
    return points;
  };
  for (const SearchAlgorithm a : kAlgorithms) {
    SCOPED_TRACE(name_of(a));
    const std::vector<SearchPoint> first = steps(a, 5);
    EXPECT_GT(first.size(), 50U);
    EXPECT_EQ(first, steps(a, 5));
    EXPECT_EQ(first == steps(a, 6), a != SearchAlgorithm::annealing);
  }
}

TEST(Greedy, StepsOverAValueThatFails) {
  Problem p = table({4}, {1}, [](const Bits& b) { return b[0] != 1; });
  EXPECT_EQ(p.run(SearchAlgorithm::greedy).point, (SearchPoint{0}));
}

TEST(Greedy, ExchangesOneForOne) {
  // The dear axis may go down to 1, if the cheap one stays at 1.
  Problem p = table({4, 4}, {1, 1.5}, [](const Bits& b) { return b[1] >= (b[0] >= 1 ? 1 : 2); });
  const SearchResult r = p.run(SearchAlgorithm::greedy);
  EXPECT_EQ(r.point, (SearchPoint{1, 1}));
  EXPECT_EQ(r.cost, p.optimum());
}

TEST(Greedy, ExchangesAcrossAPointThatFails) {
  // The way from (0, 1) to (1, 0) leads over points that fail.
  const std::set<Bits> good{{2, 2}, {1, 2}, {0, 2}, {0, 1}, {1, 0}};
  Problem p = table({3, 3}, {1, 1.5}, [good](const Bits& b) { return good.contains(b); });
  EXPECT_EQ(p.run(SearchAlgorithm::greedy).point, (SearchPoint{1, 0}));
}

TEST(Greedy, ExchangesOneForMany) {
  // One more of the first lets both others go; with one of them alone it does not pay.
  Problem p =
      table({2, 2, 2}, {3, 2, 2}, [](const Bits& b) { return b[0] == 1 || (b[1] == 1 && b[2] == 1); });
  const SearchResult r = p.run(SearchAlgorithm::greedy);
  EXPECT_EQ(r.point, (SearchPoint{1, 0, 0}));
  EXPECT_EQ(r.cost, p.optimum());
}

TEST(MinPlusOne, LeavesAPlateauByOneAxis) {
  // Each of the first two may be 0 alone, and together they must reach 7: no single value more helps until
  // then. The third, which has nothing to do with it, stays where it is.
  Problem p = table({9, 9, 9}, {1, 1, 1}, [](const Bits& b) { return b[0] + b[1] >= 7 && b[2] >= 2; });
  const SearchResult r = p.run(SearchAlgorithm::min_plus_1);
  EXPECT_EQ(r.cost, p.optimum());
  EXPECT_TRUE(std::ranges::none_of(r.steps, [](const SearchStep& s) {
    return s.point == SearchPoint{1, 1, 3};
  }));
}

TEST(MinPlusOne, RaisesEverythingWhereNoAxisAloneHelps) {
  // With two axes at their least all is refused, however wide the third.
  Problem p = table({4, 4, 4}, {1, 1, 1}, [](const Bits& b) { return std::ranges::count(b, 0) <= 1; });
  p.model = [model = p.model](const Bits& b) {
    return std::ranges::count(b, 0) > 1 ? Evaluation{true, "narrow", {}} : model(b);
  };
  const SearchResult r = p.run(SearchAlgorithm::min_plus_1);
  EXPECT_EQ(r.cost, p.optimum());
  EXPECT_TRUE(std::ranges::any_of(r.steps, [](const SearchStep& s) {
    return s.point == SearchPoint{1, 1, 1};
  }));
}

TEST(Search, LinkedKeysMoveTogether) {
  Problem p;
  p.axes.resize(1);
  p.axes[0].keys = {"h.word", "h.round"};
  for (const int w : {8, 10, 14}) p.axes[0].values.push_back({std::int64_t{w}, std::string("SC_RND")});
  p.constraints = {at_most("error", 0.001)};
  std::vector<std::vector<KeySetting>> asked;
  SearchPlan plan;
  plan.cost = "cost";
  const SearchResult r =
      search(plan, p.axes, p.constraints, [&](const std::vector<std::vector<KeySetting>>& points) {
        std::vector<Evaluation> results;
        for (const auto& s : points) {
          asked.push_back(s);
          const auto w = static_cast<double>(std::get<std::int64_t>(s.at(0).value));
          results.push_back(metrics(std::exp2(-w), w));
        }
        return results;
      });
  ASSERT_TRUE(r.found);
  EXPECT_EQ(r.point, (SearchPoint{1}));
  EXPECT_EQ(r.certificate.reductions[0].key, "h.word, h.round");
  EXPECT_EQ(r.certificate.reductions[0].from_value, "10, SC_RND");
  EXPECT_EQ(r.certificate.reductions[0].to_value, "8, SC_RND");
  EXPECT_EQ(asked.front(),
            (std::vector<KeySetting>{{"h.word", std::int64_t{14}}, {"h.round", std::string("SC_RND")}}));
}

TEST(Search, AnAxisOfOneValueStays) {
  for (const SearchAlgorithm a : kAlgorithms) {
    Problem p = small();
    p.axes.push_back(axis_of("fixed", 7, 7));
    p.model = [model = p.model](const Bits& b) { return model({b[0], b[1]}); };
    const SearchResult r = p.run(a);
    expect_minimal(p, r, name_of(a));
    EXPECT_EQ(r.point, (SearchPoint{2, 1, 0}));
    Problem fixed{{axis_of("fixed", 7, 7)}, {at_most("error", 1)}, {}};
    fixed.model = [](const Bits&) { return metrics(0, 1); };
    expect_minimal(fixed, fixed.run(a), name_of(a));
  }
}

TEST(Search, BadInputIsSaidPlainly) {
  const auto run = [](const std::function<void(Problem&, SearchPlan&)>& change) {
    Problem p = small();
    SearchPlan plan;
    plan.cost = "cost";
    change(p, plan);
    return error_of([&] { search(plan, p.axes, p.constraints, p.evaluate()); });
  };
  EXPECT_EQ(run([](Problem&, SearchPlan&) {}), "");
  EXPECT_EQ(run([](Problem&, SearchPlan& plan) { plan.evaluations = 0; }),
            "search.evaluations is 0; expected 1 or more");
  EXPECT_EQ(run([](Problem&, SearchPlan& plan) { plan.seconds = 0; }),
            "search.seconds is 0; expected more than 0");
  EXPECT_EQ(run([](Problem&, SearchPlan& plan) { plan.seconds = kNaN; }),
            "search.seconds is nan; expected more than 0");
  EXPECT_EQ(run([](Problem&, SearchPlan& plan) { plan.cost = "costs"; }),
            "search cost \"costs\" is no metric; nearest: cost, error");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.constraints[0].metric = "eror"; }),
            "constraint \"eror\" is no metric; nearest: error, cost");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.model = [](const Bits&) { return Evaluation{}; }; }),
            "constraint \"error\" is no metric; nearest: none, there are no metrics");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.constraints.clear(); }),
            "search: no [[constraint]]; without one the smallest value of every key is the answer");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.constraints[0].at_most.reset(); }),
            "constraint error: no limit; expected at_most, at_least");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.constraints[0].at_most = kNaN; }),
            "constraint error: a limit is not a number");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.constraints[0].at_least = 1; }),
            "constraint error: nothing is at least 1, at most 0.375");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes.clear(); }),
            "search: nothing varies; expected at least one [[vary]]");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes[1].keys.clear(); }), "search: a [[vary]] without keys");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes[1].values.clear(); }), "search: width1: no values");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes[1].keys = {"width0"}; }),
            "search: width0: varies twice; expected once");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes[1].keys.emplace_back("more"); }),
            "search: width1, more: value 1 has 1 parts for 2 keys");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { p.axes[1].values[3] = p.axes[1].values[1]; }),
            "search: width1: the value 2 twice");
  EXPECT_EQ(run([](Problem& p, SearchPlan&) { std::swap(p.axes[1].values[2], p.axes[1].values[3]); }),
            "search: width1: 4 before 3; expected values from few bits to many");

  const auto planted = [](const SearchPoint& point) {
    Problem p = small();
    return error_of([&] { certify("cost", p.axes, p.constraints, point, p.evaluate()); });
  };
  EXPECT_EQ(planted({2}), "certificate: a point of 1 values for 2 axes");
  EXPECT_EQ(planted({2, 4}), "certificate: width1: value 5 of 4");
}

TEST(Search, WhatEvaluateThrowsComesThrough) {
  Problem p = small();
  SearchPlan plan;
  plan.cost = "cost";
  EXPECT_THROW(search(plan, p.axes, p.constraints,
                      [](const std::vector<std::vector<KeySetting>>&) -> std::vector<Evaluation> {
                        throw InputError("the database is locked");
                      }),
               InputError);
  EXPECT_THROW(search(plan, p.axes, p.constraints,
                      [](const std::vector<std::vector<KeySetting>>&) { return std::vector<Evaluation>{}; }),
               std::logic_error);
}

}  // namespace
}  // namespace bitspan
