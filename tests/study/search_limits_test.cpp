// SPDX-License-Identifier: Apache-2.0
// The limits of a search: evaluations, seconds, a stop from outside; and what is told on the way.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "study/search/search.hpp"
#include "tests/study/search_support.hpp"

namespace bitspan {
namespace {

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

}  // namespace
}  // namespace bitspan
