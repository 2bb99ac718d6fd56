// SPDX-License-Identifier: Apache-2.0
// Lists every metric that a study can have: those of report/metrics.hpp, and the registers', costs and clocks
// of study/metrics.cpp. Plans are checked against this list, the database carries it for the report, and
// docs/study.md shows it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "report/metrics.hpp"

namespace bitspan {

// Values by name. A metric that does not apply (no fog, no texture) is absent.
using Metrics = std::map<std::string, double, std::less<>>;

struct SceneMetrics {
  std::string scene;  // its name
  Metrics metrics;    // of this scene alone, without what the configuration gives
  bool operator==(const SceneMetrics&) const = default;
};

// What was measured at a point.
struct PointMetrics {
  Metrics all;  // over all scenes together, and what the configuration alone gives
  std::vector<SceneMetrics> scenes;
};

enum class MetricRole : std::uint8_t {
  result,  // the vertical axis of the report's plots
  cost,    // the horizontal axis
  detail,  // a number for tables alone
};
std::string_view to_string(MetricRole role);
std::string_view to_string(Better better);

struct Metric {
  std::string name;   // "span.u.p999"
  std::string field;  // "span.u" where it is a statistic of that field's error; else empty
  std::string label;  // the head of its column in a table of fields; empty: no column there
  std::string unit, meaning;
  Better better = Better::low;
  MetricRole role = MetricRole::result;
  bool squares_add = false;  // for independent causes, the squares of this metric add up
};

// The metrics are in the order in which tables show them. find_metric returns null where no metric has that
// name.
const std::vector<Metric>& known_metrics();
const Metric* find_metric(std::string_view name);
// Return the name of the metric that is the ± of an estimate, and whether a name is such a one's.
std::string plus_minus_of(std::string_view metric);
bool is_plus_minus(std::string_view metric);
// A column of a table of field errors: its label, and the end of the metric's name ("p999").
// statistic_columns returns them in their order.
struct StatisticColumn {
  std::string label, ending;
};
std::vector<StatisticColumn> statistic_columns();

// Returns the table of docs/study.md, as Markdown.
std::string metrics_markdown();

}  // namespace bitspan
