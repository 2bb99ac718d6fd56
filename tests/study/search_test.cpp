// Word-length search on made-up error models whose optimum is known by brute force.
#include "study/search/search.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const SearchAlgorithm kAlgorithms[] = {SearchAlgorithm::min_plus_1, SearchAlgorithm::max_minus_1,
                                       SearchAlgorithm::greedy, SearchAlgorithm::annealing};

const char* name_of(SearchAlgorithm a) {
  switch (a) {
    case SearchAlgorithm::min_plus_1:
      return "min+1";
    case SearchAlgorithm::max_minus_1:
      return "max-1";
    case SearchAlgorithm::greedy:
      return "greedy";
    case SearchAlgorithm::annealing:
      return "annealing";
  }
  return "?";
}

using Bits = std::vector<int>;

Axis axis_of(const std::string& key, int from, int to) {
  Axis axis;
  axis.keys = {key};
  for (int b = from; b <= to; ++b) axis.values.push_back({std::int64_t{b}});
  return axis;
}

std::vector<Axis> axes_of(std::size_t count, int from, int to) {
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < count; ++i) axes.push_back(axis_of(fmt::format("width{}", i), from, to));
  return axes;
}

Evaluation metrics(double error, double cost) {
  Evaluation e;
  e.metrics = {{"error", error}, {"cost", cost}};
  return e;
}

Constraint at_most(const std::string& metric, double limit) { return {metric, limit, std::nullopt}; }

// A made-up pipeline: what a point's widths give. Fails the test where a point is asked for twice.
struct Problem {
  std::vector<Axis> axes;
  std::vector<Constraint> constraints;
  std::function<Evaluation(const Bits&)> model;

  std::set<Bits> seen = {};
  std::size_t batches = 0;

  static Bits bits_of(const std::vector<KeySetting>& settings) {
    Bits bits;
    for (const KeySetting& s : settings) bits.push_back(static_cast<int>(std::get<std::int64_t>(s.value)));
    return bits;
  }

  Evaluate evaluate() {
    return [this](const std::vector<std::vector<KeySetting>>& points) {
      ++batches;
      std::vector<Evaluation> results;
      for (const auto& settings : points) {
        EXPECT_EQ(settings.size(), axes.size());
        const Bits bits = bits_of(settings);
        EXPECT_TRUE(seen.insert(bits).second)
            << "evaluated twice: " << fmt::format("{}", fmt::join(bits, " "));
        results.push_back(model(bits));
      }
      return results;
    };
  }

  SearchResult run(SearchPlan plan) {
    seen.clear();
    batches = 0;
    plan.cost = "cost";
    SearchResult r = search(plan, axes, constraints, evaluate());
    EXPECT_EQ(r.evaluations, seen.size());
    EXPECT_EQ(r.steps.size(), seen.size());
    return r;
  }
  SearchResult run(SearchAlgorithm algorithm, std::uint64_t seed = 1) {
    SearchPlan plan;
    plan.algorithm = algorithm;
    plan.evaluations = 100000;
    plan.seconds = 1000;
    plan.seed = seed;
    if (algorithm == SearchAlgorithm::annealing) plan.evaluations = 2000;  // its length follows from them
    return run(plan);
  }

  // The plain truth about a point, without the code under test.
  bool holds(const SearchPoint& p) const {
    const Evaluation e = model(bits_at(p));
    return !e.refused && std::ranges::all_of(constraints, [&](const Constraint& c) {
      const auto found = e.metrics.find(c.metric);
      return found != e.metrics.end() && !std::isnan(found->second) && c.holds(found->second);
    });
  }
  double cost(const SearchPoint& p) const { return model(bits_at(p)).metrics.at("cost"); }
  Bits bits_at(const SearchPoint& p) const { return bits_of(settings_of(axes, p)); }

  bool minimal(const SearchPoint& p) const {
    if (!holds(p)) return false;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p[i] == 0) continue;
      SearchPoint q = p;
      --q[i];
      if (holds(q) && cost(q) <= cost(p)) return false;
    }
    return true;
  }

  // The least cost of all points; infinite where none holds.
  double optimum() const {
    double least = kInfinity;
    SearchPoint p(axes.size(), 0);
    for (;;) {
      if (holds(p)) least = std::min(least, cost(p));
      std::size_t i = 0;
      while (i < p.size() && ++p[i] == axes[i].values.size()) p[i++] = 0;
      if (i == p.size()) return least;
    }
  }
};

void expect_minimal(const Problem& problem, const SearchResult& r, const std::string& what) {
  SCOPED_TRACE(what);
  ASSERT_TRUE(r.found) << fmt::format("{}", fmt::join(r.failing, "; "));
  EXPECT_EQ(r.stopped_by, StoppedBy::done);
  EXPECT_TRUE(problem.minimal(r.point));
  EXPECT_EQ(r.cost, problem.cost(r.point));
  EXPECT_TRUE(r.certificate.complete());
  EXPECT_TRUE(r.certificate.minimal()) << to_text(r.certificate);
  EXPECT_EQ(r.certificate.reductions.size(), problem.axes.size());
  // Nothing that was evaluated is better, and the last step marked best is the answer.
  const SearchStep* best = nullptr;
  for (const SearchStep& s : r.steps) {
    if (s.holds) {
      EXPECT_GE(s.cost, r.cost);
    }
    if (s.best) best = &s;
  }
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->point, r.point);
}

double whole(double x) { return std::round(x * 1024) / 1024; }

// error = sum of weight 2^-bits, cost = sum of price bits.
Problem separable(std::mt19937_64& random, std::size_t count, int from, int to) {
  std::uniform_real_distribution<double> exponent(-3, 3), price(1, 8);
  std::vector<double> weights, prices;
  double widest = 0, narrowest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    weights.push_back(std::exp2(exponent(random)));
    prices.push_back(whole(price(random)));
    widest += weights.back() * std::exp2(-to);
    narrowest += weights.back() * std::exp2(-from);
  }
  const double share = std::uniform_real_distribution<double>(0.2, 0.6)(random);
  const double limit = std::pow(widest, share) * std::pow(narrowest, 1 - share);
  Problem p{axes_of(count, from, to), {at_most("error", limit)}, {}};
  p.model = [weights, prices](const Bits& bits) {
    double error = 0, cost = 0;
    for (std::size_t i = 0; i < bits.size(); ++i) {
      error += weights[i] * std::exp2(-bits[i]);
      cost += prices[i] * bits[i];
    }
    return metrics(error, cost);
  };
  return p;
}

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

// Two axes of 4 values, error 2^-w0 + 2^-w1 at most 3/8, cost w0 + 2 w1: the optimum is (3, 2), cost 7.
Problem small() {
  Problem p{axes_of(2, 1, 4), {at_most("error", 0.375)}, {}};
  p.model = [](const Bits& b) { return metrics(std::exp2(-b[0]) + std::exp2(-b[1]), b[0] + 2 * b[1]); };
  return p;
}

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
  const SearchResult r = p.run(SearchAlgorithm::max_minus_1);
  ASSERT_TRUE(r.found);
  EXPECT_EQ(r.point, (SearchPoint{3, 1}));
  EXPECT_EQ(r.certificate.reductions[0].text, "the cost cost has no value here");
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

TEST(Search, TheLimitOnEvaluationsIsHard) {
  std::mt19937_64 random(5);
  Problem p = separable(random, 5, 4, 16);
  for (const SearchAlgorithm a : kAlgorithms) {
    const std::size_t full = p.run(a).evaluations;
    for (int limit = 1; limit < 120; limit += 3) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(a), limit));
      SearchPlan plan;
      plan.algorithm = a;
      plan.evaluations = limit;
      plan.seconds = 1000;
      const SearchResult r = p.run(plan);
      ASSERT_TRUE(r.found);
      EXPECT_LE(r.evaluations, static_cast<std::size_t>(limit));
      if (a == SearchAlgorithm::annealing || static_cast<std::size_t>(limit) >= full) continue;
      EXPECT_EQ(r.stopped_by, StoppedBy::evaluations);
      EXPECT_EQ(r.evaluations, static_cast<std::size_t>(limit));
      double least = kInfinity;
      for (const SearchStep& s : r.steps) least = s.holds ? std::min(least, s.cost) : least;
      EXPECT_EQ(r.cost, least);
      EXPECT_TRUE(p.holds(r.point));
      // What was not evaluated is listed, and only that.
      for (const Reduction& reduction : r.certificate.reductions) {
        const bool asked =
            std::ranges::any_of(r.steps, [&](const SearchStep& s) { return s.point == reduction.point; });
        EXPECT_EQ(reduction.outcome == ReductionOutcome::not_evaluated, !asked);
      }
      EXPECT_EQ(r.certificate.missing.size(),
                static_cast<std::size_t>(std::ranges::count(
                    r.certificate.reductions, ReductionOutcome::not_evaluated, &Reduction::outcome)));
      EXPECT_EQ(r.certificate.complete(), r.certificate.missing.empty());
    }
  }
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
            "  width0 3 -> 2: not evaluated\n"
            "  width1 4 -> 3: not evaluated\n");
}

TEST(Search, TheLimitOnSecondsIsHard) {
  std::mt19937_64 random(5);
  Problem p = separable(random, 5, 4, 16);
  const auto slow = [&p](const std::vector<std::vector<KeySetting>>& points) {
    // As a caller with all cores would take.
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    std::this_thread::sleep_for(std::chrono::milliseconds(10) * ((points.size() + cores - 1) / cores));
    std::vector<Evaluation> results;
    for (const auto& s : points) results.push_back(p.model(Problem::bits_of(s)));
    return results;
  };
  for (const SearchAlgorithm a : kAlgorithms) {
    SCOPED_TRACE(name_of(a));
    SearchPlan plan;
    plan.algorithm = a;
    plan.cost = "cost";
    plan.seconds = 0.04;
    const auto start = std::chrono::steady_clock::now();
    const SearchResult r = search(plan, p.axes, p.constraints, slow);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    EXPECT_TRUE(r.found);
    EXPECT_EQ(r.stopped_by, StoppedBy::seconds);
    EXPECT_LT(r.evaluations,
              4 * static_cast<std::size_t>(std::max(1U, std::thread::hardware_concurrency())) + 1);
    EXPECT_LT(took.count(), 2);  // a busy machine may be late; a search without the limit takes longer still
  }
}

TEST(Search, AnInterruptKeepsTheBest) {
  std::mt19937_64 random(5);
  Problem p = separable(random, 5, 4, 16);
  for (const SearchAlgorithm a : kAlgorithms) {
    for (const std::size_t after : {std::size_t{0}, std::size_t{1}, std::size_t{20}}) {
      SCOPED_TRACE(fmt::format("{} {}", name_of(a), after));
      std::stop_source source;
      if (after == 0) source.request_stop();
      std::size_t asked = 0;
      SearchPlan plan;
      plan.algorithm = a;
      plan.cost = "cost";
      const SearchResult r = search(
          plan, p.axes, p.constraints,
          [&](const std::vector<std::vector<KeySetting>>& points) {
            std::vector<Evaluation> results;
            for (const auto& s : points) {
              if (asked == after) source.request_stop();
              if (source.stop_requested()) {
                results.push_back({.missing = true});
              } else {
                results.push_back(p.model(Problem::bits_of(s)));
                ++asked;
              }
            }
            return results;
          },
          source.get_token());
      EXPECT_EQ(r.stopped_by, StoppedBy::interrupt);
      EXPECT_EQ(r.evaluations, after);
      EXPECT_EQ(r.found, after > 0);
      if (after == 0) {
        EXPECT_EQ(r.failing, std::vector<std::string>{"stopped before the widest point was evaluated"});
      } else {
        EXPECT_TRUE(p.holds(r.point));
      }
    }
  }
}

TEST(Search, AfterAStopRequestNothingIsBegun) {
  // A caller that does not look at the token itself.
  std::mt19937_64 random(5);
  Problem p = separable(random, 5, 4, 16);
  SearchPlan plan;
  plan.cost = "cost";
  std::stop_source source;
  const SearchResult r = search(plan, p.axes, p.constraints, p.evaluate(), source.get_token(),
                                [&](const SearchProgress& progress) {
                                  EXPECT_FALSE(source.stop_requested());
                                  if (progress.evaluations > 15) source.request_stop();
                                });
  EXPECT_EQ(r.stopped_by, StoppedBy::interrupt);
  EXPECT_TRUE(p.holds(r.point));

  source.request_stop();
  p.batches = 0;
  EXPECT_FALSE(search(plan, p.axes, p.constraints, p.evaluate(), source.get_token()).found);
  EXPECT_EQ(p.batches, 0U);
}

TEST(Search, ARoundThatWouldEndTooLateIsNotBegun) {
  Problem p = small();
  SearchPlan plan;
  plan.cost = "cost";
  plan.seconds = 0.05;
  const SearchResult r =
      search(plan, p.axes, p.constraints, [&p](const std::vector<std::vector<KeySetting>>& points) {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        std::vector<Evaluation> results;
        for (const auto& s : points) results.push_back(p.model(Problem::bits_of(s)));
        return results;
      });
  EXPECT_EQ(r.stopped_by, StoppedBy::seconds);
  EXPECT_EQ(r.evaluations, 1U);
  EXPECT_EQ(r.point, (SearchPoint{3, 3}));
}

TEST(Search, AnnealingLeavesTimeForItsCertificate) {
  std::mt19937_64 random(5);
  Problem p = separable(random, 5, 4, 16);
  SearchPlan plan;
  plan.algorithm = SearchAlgorithm::annealing;
  plan.cost = "cost";
  plan.evaluations = 10000000;
  plan.seconds = 1.5;
  const SearchResult r =
      search(plan, p.axes, p.constraints, [&p](const std::vector<std::vector<KeySetting>>& points) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        std::vector<Evaluation> results;
        for (const auto& s : points) results.push_back(p.model(Problem::bits_of(s)));
        return results;
      });
  EXPECT_EQ(r.stopped_by, StoppedBy::seconds);
  EXPECT_TRUE(r.certificate.minimal()) << to_text(r.certificate);
  EXPECT_TRUE(p.minimal(r.point));
}

// An error of 0 or 1, and a cost that is linear in the indices.
Problem table(const std::vector<std::size_t>& sizes, const std::vector<double>& prices,
              const std::function<bool(const Bits&)>& holds) {
  Problem p;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    p.axes.push_back(axis_of(fmt::format("width{}", i), 0, static_cast<int>(sizes[i]) - 1));
  }
  p.constraints = {at_most("error", 0)};
  p.model = [prices, holds](const Bits& bits) {
    double cost = 0;
    for (std::size_t i = 0; i < bits.size(); ++i) cost += prices[i] * bits[i];
    return metrics(holds(bits) ? 0 : 1, cost);
  };
  return p;
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

TEST(Search, ProgressIsTold) {
  Problem p = small();
  SearchPlan plan;
  plan.cost = "cost";
  std::vector<SearchProgress> seen;
  const SearchResult r = search(plan, p.axes, p.constraints, p.evaluate(), {},
                                [&](const SearchProgress& progress) { seen.push_back(progress); });
  ASSERT_EQ(seen.size(), p.batches);
  EXPECT_EQ(seen.front().phase, "widest");
  EXPECT_EQ(seen.front().evaluations, 1U);
  EXPECT_TRUE(seen.front().found);
  EXPECT_EQ(seen.front().cost, 12);
  EXPECT_EQ(seen.back().evaluations, r.evaluations);
  EXPECT_EQ(seen.back().cost, r.cost);
  EXPECT_TRUE(std::ranges::is_sorted(seen, {}, &SearchProgress::evaluations));
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
