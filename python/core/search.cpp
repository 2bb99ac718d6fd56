// SPDX-License-Identifier: Apache-2.0
// The search of a study, over points that Python measures.
#include "study/search/search.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "python/core/core.hpp"

namespace bitspan::python {
namespace {

// Keys that are set together, and the values that they take in turn.
using GivenAxis = std::pair<std::vector<std::string>, std::vector<nb::object>>;
// Metric, at most, at least, whether all scenes are judged together.
using GivenConstraint = std::tuple<std::string, std::optional<double>, std::optional<double>, bool>;
// Why the point was refused, or the metrics over all scenes together and of each by its name.
using Found = std::tuple<std::string, Metrics, std::vector<std::pair<std::string, Metrics>>>;

KeyValue key_value(const nb::object& value) {
  if (PyBool_Check(value.ptr())) return nb::cast<bool>(value);
  if (PyLong_Check(value.ptr())) return nb::cast<std::int64_t>(value);
  return nb::cast<std::string>(value);
}

std::vector<Axis> axes_of(const std::vector<GivenAxis>& given) {
  std::vector<Axis> out;
  for (const auto& [keys, values] : given) {
    Axis axis{keys, {}};
    for (const nb::object& value : values) axis.values.emplace_back(keys.size(), key_value(value));
    out.push_back(std::move(axis));
  }
  return out;
}

std::vector<Constraint> constraints_of(const std::vector<GivenConstraint>& given) {
  std::vector<Constraint> out;
  for (const auto& [metric, at_most, at_least, pooled] : given) {
    out.push_back({metric, at_most, at_least, pooled ? Over::pooled : Over::worst});
  }
  return out;
}

nb::dict dict_of(const std::vector<KeySetting>& settings) {
  nb::dict out;
  for (const KeySetting& s : settings) out[s.path.c_str()] = nb::cast(s.value);
  return out;
}

Evaluation evaluation_of(Found&& found) {
  auto& [reason, all, scenes] = found;
  Evaluation out;
  out.refused = !reason.empty();
  out.reason = std::move(reason);
  out.metrics = std::move(all);
  for (auto& [scene, metrics] : scenes) out.scenes.push_back({scene, std::move(metrics)});
  return out;
}

nb::tuple tuple_of(const Certificate& c) {
  nb::list steps;
  for (const Reduction& r : c.reductions) {
    steps.append(nb::make_tuple(r.key, r.from_value, r.to_value, to_string(r.outcome), r.text));
  }
  nb::list pairs;
  for (const PairedStep& p : c.pairs) {
    pairs.append(nb::make_tuple(p.key, p.from_values, p.to_values, to_string(p.outcome), p.text));
  }
  return nb::make_tuple(c.point_holds, c.minimal(), nb::tuple(steps), nb::tuple(pairs), to_text(c));
}

nb::dict search_from_python(const std::vector<GivenAxis>& given_axes,
                            const std::vector<GivenConstraint>& given_constraints,
                            const std::string& algorithm, const std::string& cost, const std::string& tie,
                            double tie_within, int evaluations, double seconds, std::uint64_t seed,
                            bool pairs, const nb::callable& evaluate, const nb::object& cost_of,
                            const nb::callable& told) {
  SearchPlan plan;
  const auto named = std::ranges::find(search_algorithms, algorithm);
  if (named == search_algorithms.end()) {
    std::string legal;
    for (const std::string_view name : search_algorithms)
      legal.append(legal.empty() ? "" : ", ").append(name);
    throw InputError("search: '" + algorithm + "' is no algorithm; expected " + legal);
  }
  plan.algorithm = static_cast<SearchAlgorithm>(named - search_algorithms.begin());
  plan.cost = cost;
  plan.tie = tie;
  plan.tie_within = tie_within;
  plan.evaluations = evaluations;
  plan.seconds = seconds;
  plan.seed = seed;
  plan.pairs = pairs;
  const std::vector<Axis> axes = axes_of(given_axes);
  const Evaluate evaluated = [&](const std::vector<std::vector<KeySetting>>& points) {
    nb::list asked;
    for (const auto& point : points) asked.append(dict_of(point));
    std::vector<Evaluation> out;
    for (Found& found : nb::cast<std::vector<Found>>(evaluate(asked))) {
      out.push_back(evaluation_of(std::move(found)));
    }
    return out;
  };
  CostOf known;
  if (!cost_of.is_none()) {
    known = [&](const std::vector<KeySetting>& point) { return nb::cast<double>(cost_of(dict_of(point))); };
  }
  const SearchResult result = search(
      plan, axes, constraints_of(given_constraints), evaluated, {},
      [&](const SearchProgress& p) { told(p.phase, p.evaluations, p.found ? nb::cast(p.cost) : nb::none()); },
      known);
  nb::list combinations;
  for (const Combination& c : result.combinations) {
    combinations.append(nb::make_tuple(c.text, c.found ? dict_of(settings_of(axes, c.point)) : nb::dict(),
                                       c.cost, c.evaluations, tuple_of(c.certificate),
                                       to_string(c.stopped_by), c.failing));
  }
  nb::list steps;
  for (const SearchStep& s : result.steps) {
    steps.append(nb::make_tuple(dict_of(settings_of(axes, s.point)), s.cost, s.holds, s.best));
  }
  nb::dict out;
  out["found"] = result.found;
  out["settings"] = result.found ? dict_of(settings_of(axes, result.point)) : nb::dict();
  out["cost"] = result.cost;
  out["steps"] = steps;
  out["failing"] = result.failing;
  out["certificate"] = tuple_of(result.certificate);
  out["stopped_by"] = to_string(result.stopped_by);
  out["combinations"] = nb::tuple(combinations);
  return out;
}

}  // namespace

void bind_search(nb::module_& m) {
  nb::list names;
  for (const std::string_view name : search_algorithms) names.append(name);
  m.attr("search_algorithms") = nb::tuple(names);
  m.attr("default_cost") = default_cost;
  m.def("search", &search_from_python, nb::arg("axes"), nb::arg("constraints"), nb::arg("algorithm"),
        nb::arg("cost"), nb::arg("tie"), nb::arg("tie_within"), nb::arg("evaluations"), nb::arg("seconds"),
        nb::arg("seed"), nb::arg("pairs"), nb::arg("evaluate"), nb::arg("cost_of").none(), nb::arg("told"));
}

}  // namespace bitspan::python
