// SPDX-License-Identifier: Apache-2.0
#include "study/recommend.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "config/rtl_timing.hpp"
#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/bounds/bounds.hpp"
#include "study/budget.hpp"
#include "study/check_point.hpp"
#include "study/cost.hpp"
#include "study/expression.hpp"
#include "study/known_area.hpp"
#include "study/measured_cost.hpp"
#include "study/metrics.hpp"
#include "study/pictures.hpp"

namespace bitspan {
namespace {

constexpr std::string_view area_prefix = "area.";
constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

std::string area_text(const AreaResult& a) {
  std::vector<std::string> parts;
  if (a.counts != AreaCounts{}) {
    parts.push_back(fmt::format("{} LUTs, {} flip-flops, {} multipliers, {} memory bits", a.counts.luts,
                                a.counts.ffs, a.counts.multipliers, a.counts.memory_bits));
  }
  if (!std::isnan(a.fmax_mhz)) parts.push_back(fmt::format("{:.1f} MHz", a.fmax_mhz));
  if (!a.message.empty()) {
    parts.push_back(
        fmt::format("{}: {}", a.status == AreaStatus::failed ? "failed" : "does not fit", a.message));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

bool is_area(std::string_view metric) { return metric.starts_with(area_prefix); }

bool needs_area(const Constraint& c) { return std::ranges::any_of(Expression(c.metric).metrics(), is_area); }

// Returns the constraints that need no synthesis.
std::vector<Constraint> without_areas(const std::vector<Constraint>& constraints) {
  std::vector<Constraint> out;
  std::ranges::remove_copy_if(constraints, std::back_inserter(out), needs_area);
  return out;
}

// Returns what the metrics are of, and whether the clock rate is among those of each.
std::map<AreaTarget, bool> targets_of(std::span<const std::string> area_metrics) {
  std::map<AreaTarget, bool> out;
  for (const std::string& metric : area_metrics) {
    if (const auto target = target_of("area", metric)) {
      bool& placed = out[*target];
      placed = placed || metric == metric_prefix("area", *target) + "fmax_mhz";
    }
  }
  return out;
}

// Adds an area's metrics. They stay as they are where it failed, and where the part is not in RTL.
void add_area(AreaTarget target, bool place, const Config& config, Store& store, const std::stop_token& stop,
              Metrics& metrics) {
  if (target.part != AreaPart::spans && !has_part(config, target.part)) return;
  const AreaResult a = known_area(config, target, place, store, stop);
  if (a.status == AreaStatus::failed) return;
  const std::string prefix = metric_prefix("area", target);
  metrics[prefix + "luts"] = static_cast<double>(a.counts.luts);
  metrics[prefix + "ffs"] = static_cast<double>(a.counts.ffs);
  metrics[prefix + "multipliers"] = static_cast<double>(a.counts.multipliers);
  metrics[prefix + "memory_bits"] = static_cast<double>(a.counts.memory_bits);
  if (target.part == AreaPart::spans) metrics[prefix + "fmax_mhz"] = a.fmax_mhz;
}

// Returns the metrics that come from the configuration alone.
Metrics unmeasured(const Config& config) {
  Metrics metrics;
  add_costs(config, metrics);
  add_timing(config, metrics);
  add_estimates(config, metrics);
  return metrics;
}

// Returns how the search's cost comes from a configuration alone; none where it has to be measured.
CostOf known_cost(const SearchPlan& plan, PointRunner& runner) {
  const auto is_known = [](const std::string& metric) {
    constexpr auto prefixes = std::to_array<std::string_view>({"cost.", "estimate.", "timing."});
    return std::ranges::any_of(prefixes, [&](auto prefix) { return metric.starts_with(prefix); });
  };
  const auto cost = std::make_shared<Expression>(plan.cost);
  if (!std::ranges::all_of(cost->metrics(), is_known)) return {};
  return [cost, &runner](const std::vector<KeySetting>& settings) {
    const Point point = runner.prepare(settings);
    return cost->value(point.config ? unmeasured(*point.config) : Metrics{}).value_or(no_value);
  };
}

// `hashes` has the hashes of the points evaluated, by the text of their settings.
void write_certificate(const StudyPlan& plan, const Certificate& certificate, const std::string& combination,
                       const std::map<std::string, std::string>& hashes, Store& store) {
  const auto write = [&](const std::string& key, const std::string& from, const std::string& to,
                         const SearchPoint& point, ReductionOutcome outcome, const std::string& text) {
    const std::string settings = settings_json(settings_of(plan.axes, point));
    const auto hash = hashes.find(settings);
    store.run("INSERT INTO certificate VALUES(?, ?, ?, ?, ?, ?, ?, ?)",
              {plan.name, key, from, to, hash == hashes.end() ? "" : hash->second,
               fmt::format("{}: {}", to_string(outcome), text), settings, combination});
  };
  for (const Reduction& r : certificate.reductions) {
    write(r.key, r.from_value, r.to_value, r.point, r.outcome, r.text);
  }
  for (const PairedStep& p : certificate.pairs) {
    write(p.key, p.from_values, p.to_values, p.point, p.outcome, p.text);
  }
}

void write_search(const StudyPlan& plan, const SearchResult& result, const std::string& base_hash,
                  const std::map<std::string, std::string>& hashes, Store& store) {
  store.transaction([&] {
    put_study(plan, base_hash, store);
    for (const char* table :
         {"study_points", "search_steps", "certificate", "combinations", "measured_costs"}) {
      store.run(fmt::format("DELETE FROM {} WHERE study = ?", table), {plan.name});
    }
    std::int64_t i = 0;
    for (const SearchStep& step : result.steps) {
      const std::string settings = settings_json(settings_of(plan.axes, step.point));
      const std::string& hash = hashes.at(settings);
      const std::int64_t holds = step.holds ? 1 : 0;
      store.run("INSERT INTO study_points VALUES(?, ?, ?, ?, ?)", {plan.name, i, hash, settings, holds});
      store.run("INSERT INTO search_steps VALUES(?, ?, ?, ?, ?, ?)",
                {plan.name, i++, hash, step.cost, holds, std::int64_t{step.best ? 1 : 0}});
    }
    if (result.combinations.empty()) write_certificate(plan, result.certificate, "", hashes, store);
    i = 0;
    for (const Combination& c : result.combinations) {
      const std::string hash = c.found ? hashes.at(settings_json(settings_of(plan.axes, c.point))) : "";
      store.run("INSERT INTO combinations VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)",
                {plan.name, i++, c.text, hash, c.found ? Cell(c.cost) : Cell(),
                 static_cast<std::int64_t>(c.evaluations), std::string(to_string(c.stopped_by)),
                 std::int64_t{c.certificate.minimal() ? 1 : 0}, c.failing});
      write_certificate(plan, c.certificate, c.text, hashes, store);
    }
  });
}

void write_budget(const std::string& hash, const Budget& budget, Store& store) {
  store.transaction([&] {
    store.run("DELETE FROM budget WHERE hash = ?", {hash});
    for (const BudgetRow& row : budget.rows) {
      for (const std::string& metric : budget.metrics) {
        store.run("INSERT INTO budget VALUES(?, ?, ?, ?, ?, ?)",
                  {hash, row.quantisation.name, metric, budget.base.at(metric), row.without.at(metric),
                   row.alone.at(metric)});
      }
    }
  });
}

void write_causes(const std::string& hash, const Budget& budget, Store& store) {
  store.transaction([&] {
    store.run("DELETE FROM causes WHERE hash = ?", {hash});
    for (const DominantMap& map : budget.maps) {
      std::int64_t i = 0;
      for (const CauseColor& c : cause_legend(budget, map)) {
        store.run(
            "INSERT INTO causes VALUES(?, ?, ?, ?, ?, ?)",
            {hash, map.scene, i++, c.name, fmt::format("#{:02x}{:02x}{:02x}", c.rgb[0], c.rgb[1], c.rgb[2]),
             static_cast<std::int64_t>(c.pixels)});
      }
    }
  });
}

// Returns the metrics of the budget: those of the plan whose squares add, and the usual ones that the point
// has.
std::vector<std::string> budget_metrics(const StudyPlan& plan, const Metrics& has) {
  std::vector<std::string> out;
  for (const std::string& name : plan.metrics) {
    const Metric* const metric = find_metric(name);
    if (metric != nullptr && metric->squares_add && metric->role == MetricRole::result) out.push_back(name);
  }
  for (const char* metric : {"span.h.rms", "span.u.rms", "span.v.rms", "picture.colour.rms"}) {
    if (has.contains(metric) && std::find(out.begin(), out.end(), metric) == out.end()) out.push_back(metric);
  }
  return out;
}

std::vector<FieldError> fields_of_point(const std::string& hash, Store& store) {
  std::vector<FieldError> out;
  for (const Row& r : store.rows("SELECT stage, quantity, unit, ulp, count, value FROM fields JOIN metrics "
                                 "USING (hash) WHERE hash = ? "
                                 "AND name = stage || '.' || quantity || '.max' ORDER BY fields.rowid",
                                 {hash})) {
    FieldError f;
    f.stage = text_of(r[0]);
    f.quantity = text_of(r[1]);
    f.unit = text_of(r[2]);
    f.ulp = number_of(r[3]);
    f.count = static_cast<std::uint64_t>(integer_of(r[4]));
    f.max = number_of(r[5]);
    out.push_back(std::move(f));
  }
  return out;
}

// Compares, for each place, the largest bound of all scenes with what was observed on all of them.
void examine_bounds(const Config& config, const std::string& hash, const std::vector<Scene>& scenes,
                    Store& store, Examination& out) {
  if (!has_bounds(config)) {
    out.lines.emplace_back("bounds: this mode has none");
    return;
  }
  std::vector<Bound> all;
  for (const Scene& scene : scenes) {
    const std::vector<Bound> of = error_bounds(config, scene);
    if (all.empty()) {
      all = of;
      continue;
    }
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (of[i].bound > all[i].bound) all[i] = of[i];
    }
  }
  if (const std::string why = unbounded_light(config); !why.empty()) out.lines.push_back("bounds: " + why);
  const auto checks = check_bounds(all, fields_of_point(hash, store));
  store.transaction([&] {
    store.run("DELETE FROM bounds WHERE hash = ?", {hash});
    for (const BoundCheck& c : checks) {
      store.run("INSERT INTO bounds VALUES(?, ?, ?, ?, ?)",
                {hash, fmt::format("{} ({})", c.place, c.quantity), c.unit, c.bound, c.observed});
    }
  });
  for (const BoundCheck& c : checks) {
    out.lines.push_back(fmt::format("bound {} ({}): {:.4g} {}, observed {:.4g}, {:.1f} %{}", c.place,
                                    c.quantity, c.bound, c.unit, c.observed, 100 * c.ratio,
                                    c.holds ? "" : "  ABOVE ITS BOUND"));
    out.held = out.held && c.holds;
  }
}

void write_pictures(const std::string& hash, const std::vector<PointPicture>& pictures, Store& store) {
  store.transaction([&] {
    for (const PointPicture& p : pictures) {
      store.run("INSERT OR REPLACE INTO pictures VALUES(?, ?, ?, ?)", {hash, p.scene, p.name, p.png});
    }
  });
}

// Measures a point again, of which only some metrics were kept.
void keep_whole(const PointRow& row, const Asked& before, const Config& config, const PointMeter& meter,
                Store& store) {
  const PointResult result = meter.measure(config);
  PointRow whole = row;
  whole.base_hash.clear();  // so that the configuration is kept as it stands
  store.put_point(whole, &result, both(before, {}));
}

}  // namespace

std::vector<std::string> idle_axes(const StudyPlan& plan, const std::vector<Scene>& scenes) {
  std::vector<std::string> out;
  Expression cost(plan.search->cost);
  // Returns none where the settings are illegal, and where the cost is known only after a measurement.
  const auto cost_of = [&](const std::vector<KeySetting>& settings) -> std::optional<double> {
    try {
      const Config config = with_keys(plan.base, settings);
      Metrics metrics = unmeasured(config);
      add_memory(config, scenes, metrics);
      return cost.value(metrics);
    } catch (const InputError&) {
      return std::nullopt;
    }
  };
  SearchPoint top;
  for (const Axis& axis : plan.axes) top.push_back(axis.values.size() - 1);
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    bool known = false, moves = false;
    const auto compare = [&](const std::vector<KeySetting>& narrow, const std::vector<KeySetting>& wide) {
      const auto least = cost_of(narrow), most = cost_of(wide);
      if (!least || !most) return;
      known = true;
      moves = moves || *least != *most;
    };
    SearchPoint narrow = top;
    narrow[a] = 0;
    compare(settings_of(plan.axes, narrow), settings_of(plan.axes, top));
    const std::vector<Axis> alone{plan.axes[a]};
    compare(settings_of(alone, {0}), settings_of(alone, {top[a]}));
    if (known && !moves) out.push_back(comma_list(plan.axes[a].keys));
  }
  return out;
}

SearchResult run_search(const StudyPlan& plan, PointRunner& runner, Store& store, const RunOptions& options,
                        const std::function<void(const SearchProgress&)>& progress) {
  std::vector<std::string> area_metrics = judged_metrics(plan);
  std::erase_if(area_metrics, [](const std::string& metric) { return !is_area(metric); });
  const std::map<AreaTarget, bool> areas = targets_of(area_metrics);
  std::vector<Expression> expressions = expressions_of(plan);
  // Those that need no synthesis, which is only worth its time where they hold.
  const std::vector<Constraint> quick = without_areas(plan.constraints);
  bool checked = false;
  RunOptions batch = options;
  batch.progress = {};
  std::map<std::string, std::string> hashes;
  const Evaluate evaluate = [&](const std::vector<std::vector<KeySetting>>& settings) {
    std::vector<Point> points;
    points.reserve(settings.size());
    for (const auto& s : settings) {
      points.push_back(runner.prepare(s));
      hashes[settings_json(s)] = points.back().hash;
    }
    const std::vector<Evaluated> states = runner.run(points, batch);
    std::vector<Evaluation> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i].missing = states[i].state == PointState::missing;
      out[i].refused = states[i].state == PointState::refused;
      out[i].reason = states[i].message;
      if (states[i].state != PointState::ok) continue;
      PointMetrics measured = store.metrics(points[i].hash);
      Metrics& metrics = measured.all;
      // An area that is not measured here has no value, and still is a metric.
      for (const std::string& metric : area_metrics) metrics[metric] = no_value;
      if (!checked) check_metrics(plan, metrics);
      checked = true;
      add_expressions(expressions, measured);
      if (all_hold(quick, measured)) {
        try {
          for (const auto& [target, place] : areas) {
            add_area(target, place, *points[i].config, store, options.stop, metrics);
          }
        } catch (const AreaCancelled&) {
          out[i].missing = true;
          continue;
        }
      }
      keep_expressions(points[i].hash, expressions, measured, store);
      out[i].metrics = std::move(measured.all);
      out[i].scenes = std::move(measured.scenes);
    }
    return out;
  };
  Point base = runner.prepare({});
  base.whole = true;
  // The report compares with the base.
  if (runner.run({base}, batch)[0].state == PointState::ok) {
    PointMetrics measured = store.metrics(base.hash);
    keep_expressions(base.hash, expressions, measured, store);
  }
  SearchResult result = search(*plan.search, plan.axes, plan.constraints, evaluate, options.stop, progress,
                               known_cost(*plan.search, runner));
  if (result.refused && !result.combinations.empty()) {
    throw InputError(
        fmt::format("{}: not one of {} combinations of categories can be measured; the first: {}", plan.name,
                    result.combinations.size(), result.failing.front()));
  }
  Expression cost(plan.search->cost);
  const auto error_at = [&](const SearchPoint& point) {
    const std::string& hash = hashes.at(settings_json(settings_of(plan.axes, point)));
    return cost_error(cost, store.metrics(hash).all);
  };
  if (result.found) result.cost_error = error_at(result.point);
  for (Combination& c : result.combinations) {
    if (c.found) c.cost_error = error_at(c.point);
  }
  write_search(plan, result, base.hash, hashes, store);
  return result;
}

std::string error_metric(const StudyPlan& plan) {
  return plan.metrics.empty() ? "span.u.p999" : plan.metrics.front();
}
std::string cost_metric(const StudyPlan& plan) { return plan.search ? plan.search->cost : plan.cost; }

std::optional<std::size_t> knee(const std::vector<std::pair<double, double>>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = points[i];
    if (x > 0 && y > 0 && std::isfinite(x) && std::isfinite(y)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a] < points[b]; });
  std::vector<std::size_t> front;
  double lowest = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (points[i].second < lowest) {
      lowest = points[i].second;
      front.push_back(i);
    }
  }
  if (front.size() < 3) return std::nullopt;
  const auto place = [&](std::size_t i) {
    return std::pair(std::log(points[i].first), std::log(points[i].second));
  };
  const auto [x0, y0] = place(front.front());
  const auto [x1, y1] = place(front.back());
  std::optional<std::size_t> best;
  double farthest = 0;
  for (const std::size_t i : front) {
    const auto [x, y] = place(i);
    const double below = (y0 - y) / (y0 - y1) - (x - x0) / (x1 - x0);
    if (below > farthest) {
      farthest = below;
      best = i;
    }
  }
  return best;
}

std::vector<Recommendation> recommendations(const StudyPlan& plan, Store& store) {
  std::vector<Recommendation> out;
  const std::string cost = cost_metric(plan);
  Expression cost_expression(cost);
  const auto cost_at = [&](const std::string& hash, double value) {
    return cost_text(value, cost_error(cost_expression, store.metrics(hash).all));
  };
  if (plan.search) {
    const auto measured = store.rows(
        "SELECT hash, estimated, error, measured FROM measured_costs WHERE study = ? AND measured IS NOT "
        "NULL "
        "ORDER BY i",
        {plan.name});
    if (!measured.empty()) {
      const Row& best = measured[0];
      out.push_back(
          {text_of(best[0]),
           fmt::format("the least of {} synthesised: {} = {:.6g} measured, {} estimated", measured.size(),
                       cost, number_of(best[3]), cost_text(number_of(best[1]), number_of(best[2])))});
      return out;
    }
    const auto best =
        store.rows("SELECT hash, cost FROM search_steps WHERE study = ? AND best = 1 ORDER BY i DESC LIMIT 1",
                   {plan.name});
    if (best.empty()) return out;
    const std::string hash = text_of(best[0][0]);
    std::string reason =
        fmt::format("found by the search: {} = {}", cost, cost_at(hash, number_of(best[0][1])));
    // Why no synthesised point is in its place.
    for (const Row& row :
         store.rows("SELECT message FROM measured_costs WHERE study = ? AND hash = ?", {plan.name, hash})) {
      reason += fmt::format("; {}", text_of(row[0]));
    }
    out.push_back({hash, std::move(reason)});
    return out;
  }
  const std::string error = error_metric(plan);
  // A configuration on scenes of several depth ranges holds where it holds on all. Its error is the worst of
  // them.
  const bool ranges = std::ranges::any_of(plan.axes, varies_scenes);
  struct Group {
    std::string hash;
    double cost = 0, error = 0;
    bool holds = true;
  };
  std::vector<Group> groups;
  std::map<std::string, std::size_t> group_of;
  for (const Row& row : store.rows(
           "SELECT s.hash, p.config_hash, s.holds, (SELECT value FROM point_values WHERE hash = s.hash AND "
           "name = ?), (SELECT value FROM metrics WHERE hash = s.hash AND name = ?) FROM study_points s JOIN "
           "point_rows p ON p.hash = s.hash WHERE s.study = ? ORDER BY s.i",
           {cost, error, plan.name})) {
    const auto [at, fresh] = group_of.try_emplace(text_of(row[1]), groups.size());
    if (fresh) groups.push_back({text_of(row[0]), number_of(row[3]), number_of(row[4]), true});
    Group& group = groups[at->second];
    group.holds = group.holds && row[2] == Cell(std::int64_t{1});
    if (number_of(row[4]) > group.error) {
      group.error = number_of(row[4]);
      group.hash = text_of(row[0]);
    }
  }
  std::vector<std::string> hashes;
  std::vector<std::pair<double, double>> places;
  for (const Group& group : groups) {
    if (!group.holds || std::isnan(group.cost)) continue;
    hashes.push_back(group.hash);
    places.emplace_back(group.cost, group.error);
  }
  if (hashes.empty()) return out;
  if (!plan.constraints.empty()) {
    const auto cheapest = std::min_element(places.begin(), places.end());
    const std::string& hash = hashes[static_cast<std::size_t>(cheapest - places.begin())];
    out.push_back({hash, fmt::format("the cheapest that holds all constraints{}: {} = {}",
                                     ranges ? fmt::format(" at every {}", s_ratio_key) : "", cost,
                                     cost_at(hash, cheapest->first))});
  }
  if (const auto at = knee(places); at && (out.empty() || hashes[*at] != out[0].hash)) {
    out.push_back({hashes[*at], fmt::format("knee of {} against {}: {:.4g} at {}", error, cost,
                                            places[*at].second, cost_at(hashes[*at], places[*at].first))});
  }
  return out;
}

std::vector<std::string> margin_lines(const StudyPlan& plan, PointMetrics measured) {
  std::vector<Expression> expressions = expressions_of(plan);
  add_expressions(expressions, measured);
  std::vector<std::string> out;
  for (const Constraint& c : without_areas(plan.constraints)) {
    const auto at = decisive(c, measured.all, measured.scenes);
    if (!at) {
      out.push_back(fmt::format("{} has no value here, {}", c.metric, limits_text(c)));
      continue;
    }
    std::string line =
        fmt::format("{} is {:.6g}{}, {}: {}", c.metric, at->value,
                    at->scene.empty() ? "" : " on " + at->scene, limits_text(c), margin_text(c, at->value));
    std::size_t have = 0;
    std::size_t held = 0;
    for (const SceneMetrics& scene : measured.scenes) {
      const auto found = scene.metrics.find(c.metric);
      if (found == scene.metrics.end()) continue;
      ++have;
      held += c.holds(found->second) ? 1 : 0;
    }
    if (have > 0)
      line += fmt::format("; {} of {} scenes hold{}", held, have,
                          c.over == Over::pooled ? " (judged over all together)" : "");
    out.push_back(std::move(line));
  }
  return out;
}

namespace {

struct MeasuredPoint {
  PointRow row;
  Config config;
  std::optional<double> s_ratio;  // by which its scenes were stretched
};
// Throws InputError where the database has no such point, or it was refused.
MeasuredPoint measured_point(const std::string& hash, Store& store) {
  auto row = store.point(hash);
  if (!row || !row->ok) throw InputError("no measured point " + hash);
  Config config = parse_config(row->config, "point " + hash);
  const auto s_ratio = s_ratio_of(row->scenes);
  return {std::move(*row), std::move(config), s_ratio};
}

// Keeps lines about a recommended point for the report.
void keep_findings(const StudyPlan& plan, const std::string& hash, const std::vector<std::string>& lines,
                   Store& store) {
  for (const std::string& line : lines) {
    store.run("INSERT INTO findings VALUES(?, ?, ?)", {plan.name, hash, line});
  }
}

}  // namespace

Validation validate(const StudyPlan& plan, const Recommendation& point,
                    const std::function<std::vector<Scene>(const std::string&)>& load, Store& store,
                    const std::function<void(const std::string&)>& told, const std::stop_token& stop,
                    const LoadLit& lit, const LoadCurves& curves) {
  const MeasuredPoint of = measured_point(point.hash, store);
  const Config& config = of.config;
  struct View {
    std::string scene;
    std::optional<PointMetrics> measured;  // none: refused
    std::string refusal;
  };
  std::vector<View> views;
  const auto measure = [&](Scene scene) {
    if (of.s_ratio) scene = with_s_ratio(std::move(scene), *of.s_ratio);
    View view{scene.name, {}, {}};
    try {
      PointResult result =
          PointMeter({std::move(scene)}, half_of_memory(), lit, curves).measure(config, false);
      view.measured = {std::move(result.metrics), std::move(result.scenes)};
    } catch (const InputError& error) {
      view.refusal = error.what();
    }
    return view;
  };
  // As many at once as there are cores, because each takes a hundred megabytes.
  const auto cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  const std::size_t count = plan.validation.size();
  for (std::size_t i = 0; i < count && !stop.stop_requested(); i += cores) {
    told(fmt::format("validating on scene {} of {}", i + 1, count));
    std::vector<Scene> scenes;
    for (std::size_t k = i; k < std::min(count, i + cores); ++k) {
      std::ranges::move(load(plan.validation[k]), std::back_inserter(scenes));
    }
    const std::size_t first = views.size();
    views.resize(first + scenes.size());
    tbb::parallel_for(std::size_t{0}, scenes.size(),
                      [&](std::size_t k) { views[first + k] = measure(std::move(scenes[k])); });
  }

  std::vector<Expression> expressions = expressions_of(plan);
  for (View& view : views) {
    if (view.measured) add_expressions(expressions, *view.measured);
  }
  const std::vector<Constraint> constraints = without_areas(plan.constraints);
  Validation out;
  out.views = views.size();
  const auto holds = [&](const View& view) { return view.measured && all_hold(constraints, *view.measured); };
  out.held = static_cast<std::size_t>(std::ranges::count_if(views, holds));
  out.lines.push_back(fmt::format(
      "validated on {} views that no point was chosen by: all constraints hold on {}", out.views, out.held));
  store.transaction([&] {
    store.run("DELETE FROM validation WHERE study = ? AND hash = ?", {plan.name, point.hash});
    for (std::size_t i = 0; i < plan.constraints.size(); ++i) {
      const Constraint& c = plan.constraints[i];
      if (needs_area(c)) continue;
      std::vector<std::pair<double, const View*>> by_margin;
      for (const View& view : views) {
        const auto at = view.measured ? decisive(c, view.measured->all, view.measured->scenes) : std::nullopt;
        const double value = at ? at->value : std::numeric_limits<double>::quiet_NaN();
        store.run("INSERT INTO validation VALUES(?, ?, ?, ?, ?, ?)",
                  {plan.name, point.hash, view.scene, static_cast<std::int64_t>(i), value,
                   std::int64_t{c.holds(value) ? 1 : 0}});
        by_margin.emplace_back(value, &view);
      }
      std::ranges::stable_sort(by_margin, {}, [&](const auto& v) { return c.margin(v.first); });
      const auto held = std::ranges::count_if(by_margin, [&](const auto& v) { return c.holds(v.first); });
      std::vector<std::string> tail;
      for (std::size_t k = 0; k < std::min<std::size_t>(3, by_margin.size()); ++k) {
        tail.push_back(fmt::format("{:.4g} on {}", by_margin[k].first, by_margin[k].second->scene));
      }
      out.lines.push_back(fmt::format("{} {}: {} of {} hold; the worst: {}", c.metric, limits_text(c), held,
                                      by_margin.size(), fmt::join(tail, ", ")));
    }
  });
  for (const View& view : views) {
    if (!view.refusal.empty()) out.lines.push_back(fmt::format("{}: refused: {}", view.scene, view.refusal));
  }
  store.transaction([&] { keep_findings(plan, point.hash, out.lines, store); });
  return out;
}

void check_report(const StudyPlan& plan, const std::vector<Scene>& scenes) {
  if (!plan.budget && !plan.bounds) return;
  for (const Scene& scene : scenes) {
    if (!changes_scene(scene.commands)) continue;
    throw InputError(fmt::format("{}: {} is of one view, and {} is drawn in passes; legal: false", plan.name,
                                 plan.budget ? "report.budget" : "report.bounds", scene.name));
  }
}

Examination examine(const StudyPlan& plan, const Recommendation& point, std::vector<Scene> scenes,
                    Store& store, const std::function<void(const std::string&)>& told,
                    const std::stop_token& stop, const LoadLit& lit, const LoadCurves& curves) {
  Examination out;
  const MeasuredPoint of = measured_point(point.hash, store);
  const Config& config = of.config;
  if (of.s_ratio) {
    for (Scene& scene : scenes) scene = with_s_ratio(std::move(scene), *of.s_ratio);
  }
  for (Scene& scene : scenes) scene = lit_for(std::move(scene), config, lit);

  const std::vector<std::string> margins = margin_lines(plan, store.metrics(point.hash));
  out.lines = margins;
  told("checking golden = model = RTL");
  const PointCheck check = check_point(config, scenes);
  out.held = check.held;
  out.lines.push_back(check.text);
  store.transaction([&] {
    store.run("DELETE FROM recommended WHERE study = ? AND hash = ?", {plan.name, point.hash});
    store.run("DELETE FROM findings WHERE study = ? AND hash = ?", {plan.name, point.hash});
    keep_findings(plan, point.hash, margins, store);
    store.run("INSERT INTO recommended VALUES(?, ?, ?, ?)",
              {plan.name, point.hash, point.reason, (check.held ? "equal: " : "DIFFERS: ") + check.text});
  });

  const PointMeter meter(scenes, half_of_memory(), {}, curves);
  if (const auto known = store.known(point.hash); known && !known->asked.everything) {
    told("all that the report shows");
    keep_whole(of.row, known->asked, config, meter, store);
  }
  std::optional<Budget> budget;
  if (plan.budget && !stop.stop_requested()) {
    told("error budget");
    budget = error_budget(meter, config, budget_metrics(plan, store.metrics(point.hash).all));
    write_budget(point.hash, *budget, store);
    write_causes(point.hash, *budget, store);
  }
  if (plan.bounds && !stop.stop_requested()) {
    told("bounds");
    examine_bounds(config, point.hash, scenes, store, out);
  }
  if (plan.area) {
    for (const AreaPart part : plan.area->parts) {
      if (!has_part(config, part)) continue;
      const bool place = plan.area->place && part == AreaPart::spans;
      for (const Family family : plan.area->families) {
        if (stop.stop_requested()) break;
        std::string name(to_string(family));
        if (part != AreaPart::spans) name += fmt::format(", {}", to_string(part));
        told(fmt::format("area{} in {}", place ? " and clock" : "", name));
        const AreaResult a = known_area(config, {family, part}, place, store, stop);
        out.lines.push_back(fmt::format("area {}: {}", name, area_text(a)));
      }
    }
  }
  told("pictures");
  for (std::size_t s = 0; s < scenes.size() && !stop.stop_requested(); ++s) {
    const DominantMap* dominant = budget ? &budget->maps[s] : nullptr;
    write_pictures(
        point.hash,
        pictures_of(config, scenes[s], *meter.ideal(config, s), budget ? &*budget : nullptr, dominant),
        store);
  }
  return out;
}

}  // namespace bitspan
