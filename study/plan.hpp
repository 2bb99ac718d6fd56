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
#include "study/axis.hpp"
#include "study/constraint.hpp"
#include "study/family.hpp"
#include "study/search/search.hpp"

namespace bitspan {

enum class Arrangement { grid, one_at_a_time, list };

struct AreaPlan {
  std::vector<Family> families;
  std::vector<AreaPart> parts = {AreaPart::spans};  // those that a configuration has in RTL
  bool place = false;                               // place and route the spans for Fmax
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

// The columns of the CSV file that are neither keys nor metrics (write_csv).
inline constexpr auto csv_columns = std::to_array<std::string_view>(
    {"i", "status", "holds", "seconds", "config_hash", "hash", "message", "replay"});
// And of the one with a line per scene (write_scenes_csv).
inline constexpr std::string_view scene_column = "scene";
bool is_csv_column(std::string_view name);

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

// Returns a configuration for each way in which the points light meshes: the base with the values that some
// of them have of light.at and light.source.
std::vector<Config> lightings_of(const StudyPlan& plan);

// Throws InputError, which names the nearest metrics that exist, where a metric of the plan is not there.
void check_metrics(const StudyPlan& plan, const Metrics& metrics);

}  // namespace bitspan
