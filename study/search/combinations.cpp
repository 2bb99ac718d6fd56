// SPDX-License-Identifier: Apache-2.0
#include "study/search/combinations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include "study/search/judgement.hpp"
#include "study/search/texts.hpp"

namespace bitspan::searching {
namespace {

// Returns one point per combination. Its widths are 0.
std::vector<SearchPoint> combinations_of(const std::vector<Axis>& axes) {
  std::vector<SearchPoint> out{{}};
  for (const Axis& axis : axes) {
    std::vector<SearchPoint> longer;
    for (const SearchPoint& p : out) {
      for (std::size_t i = 0; i < (is_category(axis) ? axis.values.size() : 1); ++i) {
        longer.push_back(p);
        longer.back().push_back(i);
      }
    }
    out = std::move(longer);
  }
  return out;
}

std::string text_of(const std::vector<Axis>& axes, const SearchPoint& point) {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (is_category(axes[a])) parts.push_back(axis_title(axes[a]) + " = " + value_text(axes[a], point[a]));
  }
  return joined(parts, ", ");
}

// Returns the one of lowest tie among those that cost at most so much, the cheapest and earliest of equals.
const Combination& best_of(const std::vector<Combination>& all, double most) {
  const Combination* best = nullptr;
  for (const Combination& c : all) {
    if (!c.found || c.cost > most) continue;
    if (best == nullptr || std::pair(c.tie, c.cost) < std::pair(best->tie, best->cost)) best = &c;
  }
  return *best;
}

// Makes a combination's point the answer, and the last of the steps that were the best so far.
void answer(const Combination& best, SearchResult& all) {
  all.point = best.point;
  all.cost = best.cost;
  all.tie = best.tie;
  all.certificate = best.certificate;
  all.failing.clear();
  const auto step = std::ranges::find(all.steps, best.point, &SearchStep::point);
  step->best = true;
  for (auto later = step + 1; later != all.steps.end(); ++later) later->best = false;
}

}  // namespace

std::vector<Axis> narrowed(std::vector<Axis> axes, const SearchPoint& point) {
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (is_category(axes[a])) axes[a].values = {std::vector<KeyValue>(axes[a].values[point[a]])};
  }
  return axes;
}

SearchPoint widened(const std::vector<Axis>& axes, SearchPoint inner, const SearchPoint& point) {
  for (std::size_t a = 0; a < inner.size(); ++a) {
    if (is_category(axes[a])) inner[a] = point[a];
  }
  return inner;
}

void widen(const std::vector<Axis>& axes, Certificate& certificate, const SearchPoint& point) {
  for (Reduction& r : certificate.reductions) r.point = widened(axes, std::move(r.point), point);
  for (PairedStep& pair : certificate.pairs) pair.point = widened(axes, std::move(pair.point), point);
}

SearchResult search_combinations(const SearchPlan& plan, const std::vector<Axis>& axes,
                                 const InnerSearch& inner,
                                 const std::function<void(const SearchProgress&)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  SearchResult all;
  double least = infinity;  // of the costs
  std::function<void(const SearchProgress&)> tell;
  if (progress) {
    tell = [&](SearchProgress p) {
      p.evaluations += all.evaluations;
      p.seconds = elapsed();
      p.cost = p.found ? std::min(least, p.cost) : least;
      p.found = p.found || all.found;
      progress(p);
    };
  }
  const std::vector<SearchPoint> combinations = combinations_of(axes);
  for (std::size_t c = 0; c < combinations.size(); ++c) {
    const SearchPoint& chosen = combinations[c];
    const int left = plan.evaluations - static_cast<int>(all.evaluations);
    const auto count = static_cast<int>(combinations.size() - c);
    SearchPlan share = plan;
    share.evaluations = std::max(left / count, std::min(left, 1));
    share.seconds = (plan.seconds - elapsed()) / count;
    SearchResult found;
    if (share.evaluations > 0 && share.seconds > 0) {
      found = inner(share, narrowed(axes, chosen), tell);
    } else {
      found.stopped_by = share.evaluations > 0 ? StoppedBy::seconds : StoppedBy::evaluations;
      found.failing.emplace_back("stopped before the widest point was evaluated");
    }
    widen(axes, found.certificate, chosen);
    Combination combination{text_of(axes, chosen),
                            found.found,
                            found.refused,
                            found.point,
                            found.cost,
                            found.tie,
                            found.evaluations,
                            found.certificate,
                            found.stopped_by,
                            joined(found.failing, "; ")};
    combination.point = widened(axes, std::move(combination.point), chosen);
    for (SearchStep& step : found.steps) {
      step.point = widened(axes, std::move(step.point), chosen);
      step.best = step.best && (!all.found || step.cost < least);
    }
    std::ranges::move(found.steps, std::back_inserter(all.steps));
    all.found = all.found || found.found;
    if (found.found) least = std::min(least, found.cost);
    if (!found.found) all.failing.push_back(combination.text + ": " + combination.failing);
    all.evaluations += found.evaluations;
    all.stopped_by = std::max(all.stopped_by, found.stopped_by);
    all.combinations.push_back(std::move(combination));
  }
  all.refused = std::ranges::all_of(all.combinations, &Combination::refused);
  if (all.found) answer(best_of(all.combinations, least + plan.tie_within * std::abs(least)), all);
  return all;
}

}  // namespace bitspan::searching
