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

// Returns the families whose estimates the cost has.
std::set<Family> estimated_families(const Expression& cost) {
  std::set<Family> out;
  for (const Family family : families) {
    const std::string prefix = estimate_prefix(family);
    if (std::ranges::any_of(cost.metrics(), [&](const auto& metric) { return metric.starts_with(prefix); }))
      out.insert(family);
  }
  return out;
}

// Puts what was counted in place of the estimates.
void replace_estimates(Family family, const AreaCounts& counts, Metrics& metrics) {
  const std::string prefix = estimate_prefix(family);
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
  const std::set<Family> estimated = estimated_families(Expression(plan.search->cost));
  return !estimated.empty() && std::ranges::all_of(estimated, [&](Family family) {
    return std::ranges::find(plan.area->families, to_string(family)) != plan.area->families.end();
  });
}

MeasuredCosts measure_best(const StudyPlan& plan, const SearchResult& result, PointRunner& runner,
                           Store& store, const std::function<void(const std::string&)>& told,
                           const std::stop_token& stop) {
  MeasuredCosts out;
  if (!result.found || !ends_with_synthesis(plan)) return out;
  const auto limit = static_cast<std::size_t>(plan.search->measure);
  Expression cost(plan.search->cost);
  const std::set<Family> estimated = estimated_families(cost);
  std::set<std::string> netlists;
  bool stopped = false;
  for (const SearchStep& step : candidates(result)) {
    if (netlists.size() >= always_measured && step.cost > result.cost + result.cost_error) break;
    const Point point = runner.prepare(settings_of(plan.axes, step.point));
    if (!netlists.insert(area_key(*point.config)).second) continue;
    stopped = stopped || stop.stop_requested();
    if (stopped || netlists.size() > limit) {
      if (step.cost <= result.cost + result.cost_error) ++out.left_out;
      continue;
    }
    told(fmt::format("synthesising point {} of at most {}", netlists.size(), limit));
    Metrics metrics = store.metrics(point.hash).all;
    MeasuredCost measured{step.point, point.hash, step.cost, cost_error(cost, metrics), no_cost, ""};
    try {
      for (const Family family : estimated) {
        const AreaResult area = known_area(*point.config, family, false, store, stop);
        if (area.status == AreaStatus::failed) measured.message = area.message;
        replace_estimates(family, area.counts, metrics);
      }
    } catch (const AreaCancelled&) {
      stopped = true;
      ++out.left_out;
      continue;
    }
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
