// SPDX-License-Identifier: Apache-2.0
#include "study/search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "study/search/check.hpp"
#include "study/search/combinations.hpp"
#include "study/search/searcher.hpp"
#include "study/search/texts.hpp"

namespace bitspan {

std::vector<KeySetting> settings_of(const std::vector<Axis>& axes, const SearchPoint& point) {
  std::vector<KeySetting> settings;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t k = 0; k < axes[i].keys.size(); ++k) {
      settings.push_back({axes[i].keys[k], axes[i].values[point[i]][k]});
    }
  }
  return settings;
}

std::size_t Certificate::pairs_missing() const {
  return static_cast<std::size_t>(
      std::ranges::count(pairs, ReductionOutcome::not_evaluated, &PairedStep::outcome));
}

bool Certificate::minimal() const {
  return point_holds && complete() &&
         std::ranges::none_of(reductions,
                              [](const Reduction& r) {
                                return r.outcome == ReductionOutcome::passes ||
                                       r.outcome == ReductionOutcome::not_evaluated;
                              }) &&
         std::ranges::find(pairs, ReductionOutcome::passes, &PairedStep::outcome) == pairs.end();
}

std::string_view to_string(StoppedBy reason) {
  switch (reason) {
    case StoppedBy::done:
      return "done";
    case StoppedBy::evaluations:
      return "evaluations";
    case StoppedBy::seconds:
      return "seconds";
    case StoppedBy::interrupt:
      return "interrupt";
  }
  return "?";
}

std::string_view to_string(ReductionOutcome outcome) {
  switch (outcome) {
    case ReductionOutcome::fails:
      return "fails";
    case ReductionOutcome::at_smallest:
      return "at its smallest";
    case ReductionOutcome::costs_more:
      return "costs more";
    case ReductionOutcome::passes:
      return "passes";
    case ReductionOutcome::not_evaluated:
      return "not evaluated";
  }
  return "?";
}

SearchResult search(const SearchPlan& plan, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const Evaluate& evaluate,
                    std::stop_token stop, const std::function<void(const SearchProgress&)>& progress,
                    const CostOf& cost_of) {
  searching::check_plan(plan);
  searching::check_axes(axes);
  searching::check_constraints(constraints);
  if (std::ranges::none_of(axes, is_category)) {
    return searching::Searcher(plan, axes, constraints, evaluate, cost_of, std::move(stop), progress).run();
  }
  const searching::InnerSearch inner = [&](const SearchPlan& share, const std::vector<Axis>& widths,
                                           const std::function<void(const SearchProgress&)>& tell) {
    return searching::Searcher(share, widths, constraints, evaluate, cost_of, stop, tell).run();
  };
  return searching::search_combinations(plan, axes, inner, progress);
}

Certificate certify(const std::string& cost_metric, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const SearchPoint& point,
                    const Evaluate& evaluate, const CostOf& cost_of) {
  searching::check_axes(axes);
  searching::check_constraints(constraints);
  if (point.size() != axes.size()) {
    throw InputError(fmt::format("certificate: a point of {} values for {} axes", point.size(), axes.size()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (point[i] < axes[i].values.size()) continue;
    throw InputError(fmt::format("certificate: {}: value {} of {}", axis_title(axes[i]), point[i] + 1,
                                 axes[i].values.size()));
  }
  SearchPlan plan;
  plan.cost = cost_metric;
  plan.evaluations = std::numeric_limits<int>::max();
  plan.seconds = searching::infinity;
  const std::function<void(const SearchProgress&)> silent;
  const std::vector<Axis> widths = searching::narrowed(axes, point);
  SearchPoint inner = point;
  for (std::size_t a = 0; a < axes.size(); ++a) inner[a] = is_category(axes[a]) ? 0 : point[a];
  Certificate c =
      searching::Searcher(plan, widths, constraints, evaluate, cost_of, {}, silent).certificate_for(inner);
  searching::widen(axes, c, point);
  return c;
}

std::string to_text(const Certificate& certificate) {
  std::string text;
  const std::size_t pairs_missing = certificate.pairs_missing(),
                    paired = certificate.pairs.size() - pairs_missing;
  if (certificate.minimal()) {
    text = paired == 0 ? "the point holds, and none of its single steps down does\n"
                       : fmt::format(
                             "the point holds, and none of its single steps down does, and none of {} "
                             "paired steps\n",
                             paired);
  } else if (!certificate.point_holds) {
    text = "the point does not hold\n";
  } else if (!certificate.complete()) {
    text = fmt::format("incomplete: {} of {} single steps down were not evaluated\n",
                       certificate.missing.size(), certificate.reductions.size());
  } else if (std::ranges::find(certificate.reductions, ReductionOutcome::passes, &Reduction::outcome) !=
             certificate.reductions.end()) {
    text = "not minimal: a single step down holds\n";
  } else {
    text = "not minimal: a paired step holds\n";
  }
  if (pairs_missing > 0) {
    text +=
        fmt::format("{} of {} paired steps were not evaluated\n", pairs_missing, certificate.pairs.size());
  }
  for (const Reduction& r : certificate.reductions) {
    const std::string from_to = r.to_value.empty() ? r.from_value : r.from_value + " -> " + r.to_value;
    text += fmt::format("  {} {}: {}\n", r.key, from_to, r.text);
  }
  for (const PairedStep& pair : certificate.pairs) {
    if (pair.outcome != ReductionOutcome::passes) continue;
    text += fmt::format("  {} {} -> {}: {}\n", pair.key, pair.from_values, pair.to_values, pair.text);
  }
  return text;
}

}  // namespace bitspan
