// SPDX-License-Identifier: Apache-2.0
#include "study/measured_cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/known_area.hpp"

namespace bitspan {
namespace {

constexpr std::size_t always_measured = 3;
constexpr double no_cost = std::numeric_limits<double>::quiet_NaN();

void add_targets(const std::string& expression, std::set<AreaTarget>& out) {
  const Expression of(expression);
  for (const std::string& metric : of.metrics()) {
    if (const auto target = target_of("estimate", metric)) out.insert(*target);
  }
}

// Returns what the estimates in the cost and in the constraints are of.
std::set<AreaTarget> estimated_targets(const StudyPlan& plan) {
  std::set<AreaTarget> out;
  add_targets(plan.search->cost, out);
  for (const Constraint& c : plan.constraints) add_targets(c.metric, out);
  return out;
}

// Returns the first constraint on estimates that does not hold with the counts in place of them; empty: all
// do.
std::string broken(const StudyPlan& plan, const Metrics& metrics) {
  for (const Constraint& c : plan.constraints) {
    std::set<AreaTarget> targets;
    add_targets(c.metric, targets);
    if (targets.empty()) continue;
    const auto value = Expression(c.metric).value(metrics);
    if (value && !c.holds(*value))
      return fmt::format("{} is {:.6g} by its counts; {}", c.metric, *value, limits_text(c));
  }
  return {};
}

// Puts what was counted in place of the estimates.
void replace_estimates(AreaTarget target, const AreaCounts& counts, Metrics& metrics) {
  const std::string prefix = metric_prefix("estimate", target);
  metrics[prefix + "luts"] = static_cast<double>(counts.luts);
  metrics[prefix + "ffs"] = static_cast<double>(counts.ffs);
  metrics[prefix + "multipliers"] = static_cast<double>(counts.multipliers);
}

// Returns the steps that hold, in the order in which they are worth a synthesis.
std::vector<SearchStep> candidates(const SearchResult& result) {
  std::vector<SearchStep> out;
  std::ranges::copy_if(result.steps, std::back_inserter(out),
                       [](const SearchStep& step) { return step.holds && std::isfinite(step.cost); });
  std::ranges::stable_sort(
      out, {}, [&](const SearchStep& step) { return std::pair(step.point != result.point, step.cost); });
  return out;
}

void write_costs(const StudyPlan& plan, const MeasuredCosts& costs, Store& store) {
  store.transaction([&] {
    store.run("DELETE FROM measured_costs WHERE study = ?", {plan.name});
    std::int64_t i = 0;
    for (const MeasuredCost& c : costs.points) {
      store.run("INSERT INTO measured_costs VALUES(?, ?, ?, ?, ?, ?, ?)",
                {plan.name, i++, c.hash, c.estimated, c.error,
                 std::isnan(c.measured) ? Cell() : Cell(c.measured), c.message});
    }
  });
}

}  // namespace

double cost_error(Expression& cost, const Metrics& metrics) {
  const auto value = cost.value(metrics);
  if (!value) return 0;
  double squares = 0;
  for (const std::string& metric : cost.metrics()) {
    const auto error = metrics.find(plus_minus_of(metric));
    if (error == metrics.end()) continue;
    Metrics larger = metrics;
    larger[metric] += error->second;
    const double change = cost.value(larger).value_or(*value) - *value;
    squares += change * change;
  }
  return std::isfinite(squares) ? std::sqrt(squares) : 0;
}

std::string cost_text(double cost, double error) {
  return error > 0 ? estimate_text(cost, error) : fmt::format("{:.6g}", cost);
}

bool ends_with_synthesis(const StudyPlan& plan) {
  if (!plan.search || !plan.area || plan.search->measure == 0) return false;
  const std::set<AreaTarget> estimated = estimated_targets(plan);
  return !estimated.empty() && std::ranges::all_of(estimated, [&](AreaTarget target) {
    return std::ranges::find(plan.area->families, target.family) != plan.area->families.end();
  });
}

MeasuredCosts measure_best(const StudyPlan& plan, const SearchResult& result, PointRunner& runner,
                           Store& store, const std::function<void(const std::string&)>& told,
                           const std::stop_token& stop) {
  MeasuredCosts out;
  if (!result.found || !ends_with_synthesis(plan)) return out;
  const auto limit = static_cast<std::size_t>(plan.search->measure);
  Expression cost(plan.search->cost);
  const std::set<AreaTarget> estimated = estimated_targets(plan);
  std::set<std::vector<std::string>> netlists;
  bool stopped = false;
  for (const SearchStep& step : candidates(result)) {
    if (netlists.size() >= always_measured && step.cost > result.cost + result.cost_error) break;
    const Point point = runner.prepare(settings_of(plan.axes, step.point));
    std::vector<std::string> keys;
    for (const AreaTarget target : estimated) keys.push_back(area_key(*point.config, target.part));
    if (!netlists.insert(std::move(keys)).second) continue;
    stopped = stopped || stop.stop_requested();
    if (stopped || netlists.size() > limit) {
      if (step.cost <= result.cost + result.cost_error) ++out.left_out;
      continue;
    }
    told(fmt::format("synthesising point {} of at most {}", netlists.size(), limit));
    Metrics metrics = store.metrics(point.hash).all;
    MeasuredCost measured{step.point, point.hash, step.cost, cost_error(cost, metrics), no_cost, ""};
    try {
      for (const AreaTarget target : estimated) {
        const AreaResult area = known_area(*point.config, target, false, store, stop);
        if (area.status == AreaStatus::failed) measured.message = area.message;
        replace_estimates(target, area.counts, metrics);
      }
    } catch (const AreaCancelled&) {
      stopped = true;
      ++out.left_out;
      continue;
    }
    if (measured.message.empty()) measured.message = broken(plan, metrics);
    if (measured.message.empty()) measured.measured = cost.value(metrics).value_or(measured.measured);
    out.points.push_back(std::move(measured));
  }
  std::ranges::stable_sort(out.points, {}, [](const MeasuredCost& c) {
    return std::isnan(c.measured) ? std::numeric_limits<double>::infinity() : c.measured;
  });
  write_costs(plan, out, store);
  return out;
}

}  // namespace bitspan
