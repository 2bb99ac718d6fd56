// SPDX-License-Identifier: Apache-2.0
// Reads STUDY.toml strictly: what is varied, on which scenes, by which metrics and constraints. docs/study.md
// has one row per key.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "study/keys.hpp"
#include "study/metrics.hpp"

namespace bitspan {

// Keys that are set together, and the sets of values that they take in turn.
struct Axis {
  std::vector<std::string> keys;
  std::vector<std::vector<KeyValue>> values;  // values[i][k]: of keys[k]
  std::string name = {};                      // shown in place of the keys; may be empty
  // Each key's value is the axis's own value plus the key's offset. Empty where values are given per key.
  std::vector<std::int64_t> offsets = {};
};

// Whether the axis has strings and booleans, which a search does not order.
bool is_category(const Axis& axis);
// Returns what an axis is called: its name, or its keys, joined by ", ".
std::string axis_title(const Axis& axis);
// Returns the values that an axis gives to its keys as text: per key, joined by ", ". A named axis whose keys
// follow from one value shows that value.
std::string axis_text(const Axis& axis, const std::vector<KeyValue>& values);
// Returns that text for the settings of a point, and "" where they do not set all keys of the axis.
std::string axis_text(const Axis& axis, const std::vector<KeySetting>& point);

// What of several scenes a constraint judges.
enum class Over : std::uint8_t {
  worst,   // the scene that is nearest to the limit, or farthest beyond it
  pooled,  // all scenes together
};

struct Constraint {
  std::string metric;  // or an expression (study/expression.hpp)
  std::optional<double> at_most, at_least;
  Over over = Over::worst;
  bool holds(double value) const {  // false for a NaN
    return (!at_most || value <= *at_most) && (!at_least || value >= *at_least);
  }
  // Returns how far the value is from the nearer limit, below 0 beyond it. A NaN is infinitely far beyond.
  double margin(double value) const;
};

// The value that a constraint judges at a point.
struct Decisive {
  double value = 0;
  std::string scene;  // that has the value; empty: all together, or the configuration alone gives it
};
// There is none where no scene gives the metric.
std::optional<Decisive> decisive(const Constraint& constraint, const Metrics& all,
                                 std::span<const SceneMetrics> scenes);

enum class Arrangement { grid, one_at_a_time, list };
enum class SearchAlgorithm { min_plus_1, max_minus_1, greedy, annealing };

inline constexpr const char* default_cost = "cost.register_bits";

struct SearchPlan {
  SearchAlgorithm algorithm = SearchAlgorithm::greedy;
  std::string cost = default_cost;  // a metric or an expression, to be as low as possible
  std::string tie = default_cost;   // the same, of points of equal cost
  double tie_within = 0;            // the share of the least cost by which costs may differ and be a tie
  int evaluations = 1000;           // at most
  double seconds = 600;             // at most
  std::uint64_t seed = 1;
  bool pairs = true;  // whether the certificate tries paired steps
  int measure = 10;   // points synthesised at the end, at most, where the cost is estimated
};

struct AreaPlan {
  std::vector<std::string> families;  // "ice40", "ecp5"
  bool place = false;                 // place and route for Fmax
};

struct StudyPlan {
  std::string name;
  std::string text;  // the file
  Config base;
  std::vector<std::string> scenes;  // as the command line names them, files by their whole path; empty: the
                                    // embedded set
  std::vector<std::string> validation;  // scenes, in the same form, that no point is chosen by
  int width = 640, height = 480;        // of the scenes that have no size of their own
  Arrangement arrangement = Arrangement::grid;
  std::vector<Axis> axes;            // of a search: the widths that may change, and categories
  std::vector<std::string> metrics;  // of tables and plots; empty: all
  std::string cost =
      default_cost;  // of a sweep: what is recommended has little of this, a metric or an expression
  std::vector<Constraint> constraints;
  std::optional<SearchPlan> search;
  std::optional<AreaPlan> area;
  bool budget = false;  // the error budget of the base and of what is recommended
  bool bounds = false;  // proved bounds beside what was observed
};

// This key alone belongs to the scenes and not to the configuration. Its value is the s_max / s_min to which
// every scene is stretched (with_s_ratio), a real number above 1.
inline constexpr std::string_view s_ratio_key = "scene.s_ratio";
inline constexpr double s_ratio_limit = 1e6;
bool varies_scenes(const Axis& axis);  // whether the axis sets that key

// The columns of the CSV file that are neither keys nor metrics (write_csv).
inline constexpr auto csv_columns = std::to_array<std::string_view>(
    {"i", "status", "holds", "seconds", "config_hash", "hash", "message", "replay"});

inline constexpr std::size_t points_limit = 1'000'000;    // of a plan
inline constexpr std::size_t combinations_limit = 1'000;  // of categories in a search

// Returns a shipped configuration by its name. Throws InputError where there is none.
using ConfigFinder = std::function<Config(const std::string&)>;

// Throws InputError with file, line, key and what is legal. Unknown keys of the configuration, empty lists
// and values that no point can have are found here. `find` serves a base that is no .toml file. Files are
// taken from the folder of the study.
StudyPlan load_study(const std::string& path, const ConfigFinder& find);
StudyPlan parse_study(std::string_view text, const std::string& path, const ConfigFinder& find);
// Returns what each point sets on the base, in the order of the points. In a grid the last axis changes
// fastest. A list takes the i-th value of every axis. one_at_a_time starts with the base itself. A search has
// no such points.
std::vector<std::vector<KeySetting>> points_of(const StudyPlan& plan);

// Throws InputError, which names the nearest metrics that exist, where a metric of the plan is not there.
void check_metrics(const StudyPlan& plan, const Metrics& metrics);
// Whether all constraints hold. The constraint of a metric that is not there does not.
bool all_hold(const std::vector<Constraint>& constraints, const PointMetrics& metrics);

// Returns what a constraint asks for ("at most 0.25"), and by how much a value is within or beyond it, as a
// share of the limit where that is not 0: "margin 6.2 %", "0.0625 beyond".
std::string limits_text(const Constraint& constraint);
std::string margin_text(const Constraint& constraint, double value);

}  // namespace bitspan
