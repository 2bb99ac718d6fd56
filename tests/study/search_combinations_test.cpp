// SPDX-License-Identifier: Apache-2.0
// A search with categories: an inner search per combination, the shares of the limits, the answer of all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "study/search/search.hpp"
#include "tests/study/search_support.hpp"

namespace bitspan {
namespace {

using Points = std::vector<std::vector<KeySetting>>;

Axis kinds(std::vector<std::string> names) {
  Axis axis;
  axis.keys = {"kind"};
  for (std::string& name : names) axis.values.push_back({KeyValue(std::move(name))});
  return axis;
}

Axis flags() {
  Axis axis;
  axis.keys = {"flag"};
  axis.values = {{KeyValue(false)}, {KeyValue(true)}};
  return axis;
}

// Two widths between two axes of categories. "rough" needs two bits more of each, "cheap" costs half, "none"
// is refused. With the flag a bit of width1 costs one and not two.
struct Mixed {
  std::vector<Axis> axes{kinds({"exact", "none", "rough", "cheap"}), axis_of("width0", 1, 8), flags(),
                         axis_of("width1", 1, 8)};
  std::vector<Constraint> constraints{at_most("error", 0.05)};
  std::size_t asked = 0;

  static Evaluation model(const std::vector<KeySetting>& s) {
    EXPECT_EQ(s.size(), 4U);
    EXPECT_EQ(s[0].path, "kind");
    EXPECT_EQ(s[2].path, "flag");
    const auto kind = std::get<std::string>(s[0].value);
    if (kind == "none") return {.refused = true, .reason = "there is no such unit"};
    const auto a = static_cast<double>(std::get<std::int64_t>(s[1].value));
    const auto b = static_cast<double>(std::get<std::int64_t>(s[3].value));
    const double more = kind == "rough" ? 2 : 0;
    const double cost = 3 * a + (std::get<bool>(s[2].value) ? 1 : 2) * b;
    return metrics(std::exp2(more - a) + std::exp2(more - b), kind == "cheap" ? cost / 2 : cost);
  }
  Evaluate evaluate() {
    return [this](const Points& points) {
      asked += points.size();
      std::vector<Evaluation> out;
      for (const auto& s : points) out.push_back(model(s));
      return out;
    };
  }
};

SearchPlan plan_of(SearchAlgorithm algorithm = SearchAlgorithm::greedy, int evaluations = 100000) {
  SearchPlan plan;
  plan.algorithm = algorithm;
  plan.cost = "cost";
  plan.evaluations = evaluations;
  plan.seconds = 1000;
  return plan;
}

TEST(Combinations, EachIsASearchOfItsOwnAndTheCheapestWins) {
  for (const SearchAlgorithm algorithm : {SearchAlgorithm::min_plus_1, SearchAlgorithm::greedy}) {
    SCOPED_TRACE(name_of(algorithm));
    Mixed m;
    const SearchResult r = search(plan_of(algorithm), m.axes, m.constraints, m.evaluate());
    ASSERT_TRUE(r.found);
    EXPECT_FALSE(r.refused);
    EXPECT_EQ(r.stopped_by, StoppedBy::done);
    EXPECT_EQ(r.evaluations, m.asked);
    EXPECT_EQ(r.steps.size(), m.asked);
    EXPECT_TRUE(r.failing.empty());
    ASSERT_EQ(r.combinations.size(), 8U);
    std::size_t sum = 0, at = 0;
    double least = kInfinity;
    for (std::size_t c = 0; c < 8; ++c) {
      const Combination& one = r.combinations[c];
      const std::size_t kind = c / 2, flag = c % 2;
      EXPECT_EQ(one.text,
                fmt::format("kind = {}, flag = {}", std::get<std::string>(m.axes[0].values[kind][0]),
                            flag == 1 ? "true" : "false"));
      // The same search over the widths alone.
      const std::vector<Axis> widths{m.axes[1], m.axes[3]};
      const SearchResult alone = search(plan_of(algorithm), widths, m.constraints, [&](const Points& points) {
        std::vector<Evaluation> out;
        for (const auto& s : points) {
          out.push_back(Mixed::model({{"kind", m.axes[0].values[kind][0]}, s[0], {"flag", flag == 1}, s[1]}));
        }
        return out;
      });
      EXPECT_EQ(one.found, alone.found);
      EXPECT_EQ(one.evaluations, alone.evaluations);
      EXPECT_EQ(one.refused, kind == 1);
      sum += one.evaluations;
      for (const SearchStep& step : alone.steps) {
        EXPECT_EQ(r.steps[at].point, (SearchPoint{kind, step.point[0], flag, step.point[1]}));
        ++at;
      }
      if (!one.found) {
        EXPECT_EQ(one.failing, "the widest point does not hold: refused: there is no such unit");
        EXPECT_EQ(one.evaluations, 1U);
        continue;
      }
      EXPECT_EQ(one.point, (SearchPoint{kind, alone.point[0], flag, alone.point[1]}));
      EXPECT_EQ(one.cost, alone.cost);
      EXPECT_TRUE(one.certificate.minimal());
      EXPECT_EQ(to_text(one.certificate), to_text(alone.certificate));
      for (const Reduction& reduction : one.certificate.reductions) {
        EXPECT_EQ(reduction.point[0], kind);
        EXPECT_EQ(reduction.point[2], flag);
      }
      least = std::min(least, one.cost);
    }
    EXPECT_EQ(sum, r.evaluations);
    EXPECT_EQ(r.cost, least);
    EXPECT_EQ(r.point[0], 3U);
    EXPECT_EQ(r.point[2], 1U);
    EXPECT_EQ(to_text(r.certificate), to_text(r.combinations[7].certificate));
    // The last best step is the answer, and each best one is cheaper than the best of the combinations
    // before.
    const auto best =
        std::find_if(r.steps.rbegin(), r.steps.rend(), [](const SearchStep& s) { return s.best; });
    ASSERT_NE(best, r.steps.rend());
    EXPECT_EQ(best->point, r.point);
    double before = kInfinity;
    for (const SearchStep& s : r.steps) {
      if (!s.best) continue;
      EXPECT_LE(s.cost, before);
      before = s.cost;
    }
  }
}

TEST(Combinations, EqualCostGoesToTheEarlier) {
  Mixed m;
  m.axes[0] = kinds({"exact", "other", "cheaper"});
  const SearchResult r = search(plan_of(), m.axes, m.constraints, m.evaluate());
  EXPECT_EQ(r.combinations[1].cost, r.combinations[3].cost);
  EXPECT_EQ(r.cost, r.combinations[1].cost);
  EXPECT_EQ(r.point[0], 0U);
  EXPECT_EQ(r.point[2], 1U);
}

// Of "other" and "exact", which cost the same, "other" has the lower tie; "dear" costs 4 % more and has none.
TEST(Combinations, TiesDecideBetweenThem) {
  Mixed m;
  m.axes[0] = kinds({"exact", "other", "dear"});
  const Evaluate tied = [&](const Points& points) {
    std::vector<Evaluation> out = m.evaluate()(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto kind = std::get<std::string>(points[i][0].value);
      out[i].metrics["second"] = kind == "exact" ? 2 : kind == "other" ? 1 : 0;
      if (kind == "dear") out[i].metrics["cost"] *= 1.04;
    }
    return out;
  };
  SearchPlan plan = plan_of();
  plan.tie = "second";
  for (const auto& [within, kind] : {std::pair(0.0, 1U), std::pair(0.05, 2U)}) {
    plan.tie_within = within;
    const SearchResult r = search(plan, m.axes, m.constraints, tied);
    EXPECT_EQ(r.point[0], kind);
    EXPECT_EQ(r.tie, 2.0 - kind);
    EXPECT_EQ(to_text(r.certificate), to_text(r.combinations[2 * kind + 1].certificate));
    const auto best =
        std::find_if(r.steps.rbegin(), r.steps.rend(), [](const SearchStep& s) { return s.best; });
    EXPECT_EQ(best->point, r.point);
  }
}

TEST(Combinations, EachGetsItsShareAndWhatTheOthersLeave) {
  Mixed m;
  const SearchResult full = search(plan_of(), m.axes, m.constraints, m.evaluate());
  ASSERT_GT(full.combinations[0].evaluations, 10U);
  m.asked = 0;
  const SearchResult r = search(plan_of(SearchAlgorithm::greedy, 40), m.axes, m.constraints, m.evaluate());
  EXPECT_LE(m.asked, 40U);
  EXPECT_EQ(r.evaluations, m.asked);
  EXPECT_EQ(r.stopped_by, StoppedBy::evaluations);
  std::size_t left = 40;
  for (std::size_t c = 0; c < 8; ++c) {
    const Combination& one = r.combinations[c];
    const std::size_t share = left / (8 - c);
    EXPECT_EQ(one.evaluations, std::min(share, full.combinations[c].evaluations)) << c;
    EXPECT_EQ(one.stopped_by,
              share < full.combinations[c].evaluations ? StoppedBy::evaluations : StoppedBy::done);
    left -= one.evaluations;
  }
  // "none" took one evaluation each, and left the rest.
  EXPECT_GT(r.combinations[4].evaluations, r.combinations[0].evaluations);

  // Fewer evaluations than combinations: the last ones are not begun.
  m.asked = 0;
  const SearchResult few = search(plan_of(SearchAlgorithm::greedy, 3), m.axes, m.constraints, m.evaluate());
  EXPECT_EQ(m.asked, 3U);
  EXPECT_TRUE(few.found);
  EXPECT_EQ(few.combinations[2].evaluations, 1U);
  EXPECT_EQ(few.combinations[7].evaluations, 0U);
  EXPECT_EQ(few.combinations[7].stopped_by, StoppedBy::evaluations);
  EXPECT_EQ(few.combinations[7].failing, "stopped before the widest point was evaluated");
}

TEST(Combinations, TheSecondsAreShared) {
  Mixed m;
  m.axes[0] = kinds({"exact", "rough"});
  SearchPlan plan = plan_of();
  plan.seconds = 0.4;
  const SearchResult r = search(plan, m.axes, m.constraints, [&](const Points& points) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20) * points.size());
    return m.evaluate()(points);
  });
  EXPECT_EQ(r.stopped_by, StoppedBy::seconds);
  for (const Combination& c : r.combinations) {
    EXPECT_EQ(c.stopped_by, StoppedBy::seconds) << c.text;
    EXPECT_GE(c.evaluations, 1U) << c.text;
  }
}

TEST(Combinations, AnInterruptEndsAll) {
  Mixed m;
  std::stop_source source;
  const SearchResult r = search(plan_of(), m.axes, m.constraints, m.evaluate(), source.get_token(),
                                [&](const SearchProgress& p) {
                                  if (p.evaluations > 30) source.request_stop();
                                });
  EXPECT_EQ(r.stopped_by, StoppedBy::interrupt);
  EXPECT_TRUE(r.found);
  EXPECT_EQ(r.combinations.back().evaluations, 0U);
  EXPECT_EQ(r.combinations.back().stopped_by, StoppedBy::interrupt);
}

TEST(Combinations, ProgressIsOfTheWhole) {
  Mixed m;
  std::vector<SearchProgress> seen;
  const SearchResult r = search(plan_of(), m.axes, m.constraints, m.evaluate(), {},
                                [&](const SearchProgress& p) { seen.push_back(p); });
  EXPECT_EQ(seen.back().evaluations, r.evaluations);
  EXPECT_EQ(seen.back().cost, r.cost);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_LT(seen[i - 1].evaluations, seen[i].evaluations);
    EXPECT_LE(seen[i].cost, seen[i - 1].cost);
    EXPECT_TRUE(seen[i].found);
  }
}

TEST(Combinations, NothingFoundSaysWhatFailsInEach) {
  Mixed m;
  m.axes[0] = kinds({"none", "rough"});
  m.constraints = {at_most("error", 0.001)};
  const SearchResult r = search(plan_of(), m.axes, m.constraints, m.evaluate());
  EXPECT_FALSE(r.found);
  EXPECT_FALSE(r.refused);
  ASSERT_EQ(r.failing.size(), 4U);
  EXPECT_EQ(r.failing[0],
            "kind = none, flag = false: the widest point does not hold: refused: there is no such unit");
  EXPECT_EQ(r.failing[2],
            "kind = rough, flag = false: the widest point does not hold: error is 0.03125, at most 0.001");
  m.axes[0] = kinds({"none"});
  EXPECT_TRUE(search(plan_of(), m.axes, m.constraints, m.evaluate()).refused);
}

TEST(Combinations, ACertificateStaysInItsCombination) {
  Mixed m;
  const SearchResult r = search(plan_of(), m.axes, m.constraints, m.evaluate());
  const Certificate c = certify("cost", m.axes, m.constraints, r.combinations[5].point, m.evaluate());
  EXPECT_TRUE(c.minimal());
  EXPECT_EQ(to_text(c), to_text(r.combinations[5].certificate));
  ASSERT_EQ(c.reductions.size(), 2U);
  SearchPoint reduced = r.combinations[5].point;
  --reduced[3];
  EXPECT_EQ(c.reductions[1].point, reduced);
}

}  // namespace
}  // namespace bitspan
