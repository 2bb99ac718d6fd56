// SPDX-License-Identifier: Apache-2.0
// Made-up error models for the tests of the word-length search, whose optimum is known by brute force.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "study/search/search.hpp"

namespace bitspan {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline const SearchAlgorithm kAlgorithms[] = {SearchAlgorithm::min_plus_1, SearchAlgorithm::max_minus_1,
                                              SearchAlgorithm::greedy, SearchAlgorithm::annealing};

inline const char* name_of(SearchAlgorithm a) {
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

inline Axis axis_of(const std::string& key, int from, int to) {
  Axis axis;
  axis.keys = {key};
  for (int b = from; b <= to; ++b) axis.values.push_back({std::int64_t{b}});
  return axis;
}

inline std::vector<Axis> axes_of(std::size_t count, int from, int to) {
  std::vector<Axis> axes;
  for (std::size_t i = 0; i < count; ++i) axes.push_back(axis_of(fmt::format("width{}", i), from, to));
  return axes;
}

inline Evaluation metrics(double error, double cost) {
  Evaluation e;
  e.metrics = {{"error", error}, {"cost", cost}};
  return e;
}

inline Constraint at_most(const std::string& metric, double limit) { return {metric, limit, std::nullopt}; }

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
    for (std::size_t i = 0; i < p.size(); ++i) {  // one value up, and two down elsewhere
      for (std::size_t j = 0; j < p.size(); ++j) {
        if (i == j || p[i] + 1 == axes[i].values.size() || p[j] < 2) continue;
        SearchPoint q = p;
        ++q[i];
        q[j] -= 2;
        if (holds(q) && cost(q) < cost(p)) return false;
      }
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

inline void expect_minimal(const Problem& problem, const SearchResult& r, const std::string& what) {
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

inline double whole(double x) { return std::round(x * 1024) / 1024; }

// error = sum of weight 2^-bits, cost = sum of price bits.
inline Problem separable(std::mt19937_64& random, std::size_t count, int from, int to) {
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

// Two axes of 4 values, error 2^-w0 + 2^-w1 at most 3/8, cost w0 + 2 w1: the optimum is (3, 2), cost 7.
inline Problem small() {
  Problem p{axes_of(2, 1, 4), {at_most("error", 0.375)}, {}};
  p.model = [](const Bits& b) { return metrics(std::exp2(-b[0]) + std::exp2(-b[1]), b[0] + 2 * b[1]); };
  return p;
}

// An error of 0 or 1, and a cost that is linear in the indices.
inline Problem table(const std::vector<std::size_t>& sizes, const std::vector<double>& prices,
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

}  // namespace bitspan
