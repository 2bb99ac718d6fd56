// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "study/search/searcher.hpp"
#include "study/search/texts.hpp"

namespace bitspan::searching {

Certificate Searcher::certificate_for(const SearchPoint& p) {
  enter("certificate");
  evaluate({p});
  evaluate(reductions_of(p));
  if (plan_.pairs && at(p).holds) {
    std::vector<SearchPoint> points;
    for (const PairedStep& pair : pairs_of(p)) points.push_back(pair.point);
    evaluate(points);
  }
  return certificate_of(p);
}

Certificate Searcher::certificate_of(const SearchPoint& p) const {
  Certificate c;
  c.point_holds = known(p) && at(p).holds;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (is_category(axes_[i])) continue;  // it has no order, and no step down
    Reduction r;
    r.axis = i;
    r.key = axis_title(axes_[i]);
    r.from_value = value_text(axes_[i], p[i]);
    r.point = p;
    if (p[i] == 0) {
      r.outcome = ReductionOutcome::at_smallest;
      r.text = "at its smallest";
      c.reductions.push_back(std::move(r));
      continue;
    }
    r.point = moved(p, i, -1);
    r.to_value = value_text(axes_[i], r.point[i]);
    judge_reduction(p, r);
    if (r.outcome == ReductionOutcome::not_evaluated) {
      c.missing.push_back(fmt::format("{} from {} to {} was not evaluated", r.key, r.from_value, r.to_value));
    }
    c.reductions.push_back(std::move(r));
  }
  if (!plan_.pairs || !c.point_holds) return c;
  for (PairedStep& pair : pairs_of(p)) {
    judge_pair(p, pair);
    c.pairs.push_back(std::move(pair));
  }
  return c;
}

std::vector<PairedStep> Searcher::pairs_of(const SearchPoint& p) const {
  std::vector<std::pair<double, PairedStep>> found;
  const double cost = at(p).cost;
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < p.size(); ++j) {
      if (i == j || p[i] == top_[i] || p[j] < 2) continue;
      PairedStep pair;
      pair.up = i;
      pair.down = j;
      pair.point = moved(moved(p, i, 1), j, -2);
      // Without cost_of any pair may be cheaper, until it is evaluated.
      double expected = -infinity;
      if (known(pair.point) && !at(pair.point).refused) {
        expected = at(pair.point).cost;
      } else if (cost_of_) {
        expected = cost_of_(settings_of(axes_, pair.point));
      }
      if (expected < cost) found.emplace_back(expected, std::move(pair));
    }
  }
  if (cost_of_) std::ranges::stable_sort(found, {}, &std::pair<double, PairedStep>::first);
  std::vector<PairedStep> pairs;
  for (auto& [expected, pair] : found) pairs.push_back(std::move(pair));
  return pairs;
}

void Searcher::judge_pair(const SearchPoint& p, PairedStep& pair) const {
  const Axis &up = axes_[pair.up], &down = axes_[pair.down];
  pair.key = fmt::format("{} up, {} down", axis_title(up), axis_title(down));
  const auto values_at = [&](const SearchPoint& q) {
    return fmt::format("{}, {}", value_text(up, q[pair.up]), value_text(down, q[pair.down]));
  };
  pair.from_values = values_at(p);
  pair.to_values = values_at(pair.point);
  if (!known(pair.point)) {
    pair.text = "not evaluated";
    return;
  }
  const Judged& j = at(pair.point);
  pair.outcome = j.holds ? ReductionOutcome::passes : ReductionOutcome::fails;
  pair.text = j.holds ? fmt::format("holds; {} is {} against {}", plan_.cost, j.cost, at(p).cost) : j.failure;
}

void Searcher::judge_reduction(const SearchPoint& p, Reduction& r) const {
  if (!known(r.point)) {
    r.text = "not evaluated";
    return;
  }
  const Judged& j = at(r.point);
  if (!j.holds) {
    r.outcome = ReductionOutcome::fails;
    r.text = j.failure;
  } else if (j.cost <= at(p).cost && j.tie > at(p).tie) {
    r.outcome = ReductionOutcome::costs_more;
    r.text = fmt::format("holds, but {} rises from {} to {}", plan_.tie, at(p).tie, j.tie);
  } else if (j.cost <= at(p).cost) {
    r.outcome = ReductionOutcome::passes;
    r.text = fmt::format("holds; {} is {} against {}", plan_.cost, j.cost, at(p).cost);
  } else {
    r.outcome = ReductionOutcome::costs_more;
    r.text = fmt::format("holds, but {} rises from {} to {}", plan_.cost, at(p).cost, j.cost);
  }
}

}  // namespace bitspan::searching
