// SPDX-License-Identifier: Apache-2.0
#include "study/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <set>
#include <span>
#include <system_error>
#include <utility>

#include "config/modes.hpp"
#include "config/toml_section.hpp"
#include "scene/camera_views.hpp"
#include "scene/picture_size.hpp"
#include "study/area.hpp"
#include "study/expression.hpp"
#include "study/keys.hpp"
#include "study/metrics.hpp"
#include "study/points_file.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

constexpr int views_limit = 10'000;          // of each scene
constexpr std::size_t axis_limit = 100'000;  // values of one axis
// A value is tried in at most so many points, and is then taken for legal.
constexpr std::size_t tries_limit = 5000;

constexpr auto arrangements = std::to_array<std::string_view>({"grid", "one_at_a_time", "list"});
constexpr auto overs = std::to_array<std::string_view>({"worst", "pooled"});

// Returns the text of a metric or an expression.
std::string read_expression(const Section& s, std::string_view key, const std::string& legal) {
  std::string text = s.text(key, legal);
  try {
    static_cast<void>(Expression(text));
  } catch (const InputError& error) {
    s.fail(key, error.what());
  }
  return text;
}

std::string read_cost(const Section& s) {
  return read_expression(s, "cost", "a metric or an expression that is to be low");
}

KeyValue key_value(const Section& s, const toml::node& node, const std::string& legal) {
  if (node.is_boolean()) return node.as_boolean()->get();
  if (node.is_integer()) return node.as_integer()->get();
  if (node.is_floating_point()) return node.as_floating_point()->get();
  if (node.is_string()) return node.as_string()->get();
  s.fail(line_of(node.source()), s.path_of("values"),
         "has " + std::string(type_name(node)) + "; legal: " + legal);
}

std::vector<std::vector<KeyValue>> listed_values(const Section& s, std::size_t keys,
                                                 Arrangement arrangement) {
  const std::string legal = keys == 1 ? "an array of values"
                                      : "an array of values, which all " + std::to_string(keys) +
                                            " keys take; or of arrays with " + std::to_string(keys) +
                                            " values each";
  std::vector<std::vector<KeyValue>> out;
  std::set<std::vector<KeyValue>> seen;
  const toml::array& array = s.array("values", legal);
  const bool linked = keys > 1 && array.front().is_array();
  for (const toml::node& node : array) {
    std::vector<KeyValue> values;
    if (linked) {
      if (!node.is_array() || node.as_array()->size() != keys) {
        s.fail(line_of(node.source()), s.path_of("values"),
               "item " + std::to_string(out.size() + 1) + " is " +
                   (node.is_array() ? "an array of " + std::to_string(node.as_array()->size())
                                    : std::string(type_name(node))) +
                   "; legal: " + legal);
      }
      for (const toml::node& inner : *node.as_array()) values.push_back(key_value(s, inner, legal));
    } else {
      values.assign(keys, key_value(s, node, legal));
    }
    // Where each point takes the i-th value of every axis, equal values make different points.
    if (arrangement != Arrangement::list && !seen.insert(values).second) {
      s.fail(line_of(node.source()), s.path_of("values"),
             "item " + std::to_string(out.size() + 1) +
                 " is there twice; legal: once, or arrangement = \"list\"");
    }
    out.push_back(std::move(values));
  }
  return out;
}

constexpr std::int64_t counted_limit = 1'000'000'000;  // of from, to and what offsets are added to

std::vector<std::vector<KeyValue>> counted_values(const Section& s, std::size_t keys) {
  const std::int64_t from = s.integer("from", -counted_limit, counted_limit);
  const std::int64_t to = s.integer("to", -counted_limit, counted_limit);
  const std::int64_t step = s.has("step") ? s.integer("step", 1, counted_limit) : 1;
  if (from > to) {
    s.fail("to", "is " + std::to_string(to) + ", and from is " + std::to_string(from) +
                     ": no value at all; legal: to >= from");
  }
  if (static_cast<std::size_t>((to - from) / step) >= axis_limit) {
    s.fail("to", "makes more than " + std::to_string(axis_limit) + " values; legal: fewer");
  }
  std::vector<std::vector<KeyValue>> out;
  for (std::int64_t v = from; v <= to; v += step) out.emplace_back(keys, KeyValue(v));
  return out;
}

// Reads a name of at most 100 letters, digits and `marks`.
std::string read_name(const Section& s, std::string_view marks, const std::string& legal) {
  std::string name = s.text("name", legal);
  if (name.size() > 100 || !std::ranges::all_of(name, [&](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || marks.find(c) != std::string_view::npos;
      })) {
    s.fail("name", "is \"" + name + "\"; legal: " + legal);
  }
  return name;
}

std::string read_axis_name(const Section& s) {
  std::string name = read_name(s, "-_.", "a word of letters, digits, -, _ and .");
  const std::vector<std::string> known = all_keys();
  const char* taken = name == s_ratio_key || std::ranges::binary_search(known, name) ? "a key"
                      : find_metric(name) != nullptr                                 ? "a metric"
                      : is_csv_column(name) ? "a column of the CSV file"
                                            : nullptr;
  if (taken != nullptr) s.fail("name", "is \"" + name + "\", which is " + taken + "; legal: another word");
  return name;
}

// Adds what each key is above the value of its axis.
void read_offsets(const Section& s, Axis& axis) {
  const std::string legal = "an array of " + std::to_string(axis.keys.size()) + " integers, one per key";
  const toml::array& array = s.array("offsets", legal);
  for (const toml::node& node : array) {
    const auto* offset = node.as_integer();
    if (offset == nullptr) {
      s.fail(line_of(node.source()), s.path_of("offsets"),
             "has " + std::string(type_name(node)) + "; legal: " + legal);
    }
    if (offset->get() < -counted_limit || offset->get() > counted_limit) {
      s.fail(line_of(node.source()), s.path_of("offsets"),
             "has " + std::to_string(offset->get()) + "; legal: up to " + std::to_string(counted_limit));
    }
    axis.offsets.push_back(offset->get());
  }
  if (axis.offsets.size() != axis.keys.size()) {
    s.fail("offsets", "is an array of " + std::to_string(axis.offsets.size()) + "; legal: " + legal);
  }
  const bool linked = s.has("values") && s.array("values", "").front().is_array();
  for (auto& values : axis.values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto* value = std::get_if<std::int64_t>(&values[k]);
      if (linked || value == nullptr || *value < -counted_limit || *value > counted_limit) {
        s.fail("values",
               "are not all integers, and offsets are added to them; legal with offsets: an array of "
               "integers, or from and to");
      }
      values[k] = *value + axis.offsets[k];
    }
  }
}

Axis read_axis(const Section& s, const Config& base, Arrangement arrangement) {
  Axis axis;
  axis.keys =
      s.texts("keys", "an array of keys of the configuration, or [\"" + std::string(s_ratio_key) + "\"]");
  for (const std::string& key : axis.keys) {
    if (key == s_ratio_key) continue;
    try {
      static_cast<void>(value_of_key(base, key));
    } catch (const InputError& error) {
      s.fail("keys", error.what());
    }
  }
  const bool counted = s.has("from") || s.has("to") || s.has("step");
  if (s.has("values") == counted) {
    s.fail(s.line(), s.path_of("values"),
           std::string(counted ? "is given together with from, to, step" : "missing") +
               "; legal: values = [...], or from and to, and step");
  }
  axis.values =
      counted ? counted_values(s, axis.keys.size()) : listed_values(s, axis.keys.size(), arrangement);
  if (s.has("offsets")) read_offsets(s, axis);
  if (s.has("name")) axis.name = read_axis_name(s);
  return axis;
}

// Throws where a key is in two axes, or a format's word is varied beside its fraction, or a name is given
// twice.
void check_disjoint(const std::vector<Section>& all, const std::vector<Axis>& axes) {
  std::set<std::string, std::less<>> names;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (axes[a].name.empty() || names.insert(axes[a].name).second) continue;
    all[a].fail("name", '"' + axes[a].name + "\" names another axis too; legal: one axis per name");
  }
  std::set<std::string, std::less<>> seen;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (const std::string& key : axes[a].keys) {
      if (!seen.insert(key).second) all[a].fail("keys", key + " varies in another axis too; legal: in one");
    }
  }
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (const std::string& key : axes[a].keys) {
      const auto dot = key.rfind('.');
      if (key.substr(dot + 1) != "fraction" || !seen.contains(key.substr(0, dot) + ".word")) continue;
      all[a].fail("keys", key + " varies, and so does its word; legal: one of them");
    }
  }
}

std::vector<KeySetting> settings_at(const Axis& axis, std::size_t i) {
  std::vector<KeySetting> out;
  for (std::size_t k = 0; k < axis.keys.size(); ++k) out.push_back({axis.keys[k], axis.values[i][k]});
  return out;
}

std::optional<std::string> s_ratio_violation(const KeyValue& value) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  const auto* real = std::get_if<double>(&value);
  const double ratio = integer != nullptr ? static_cast<double>(*integer) : real != nullptr ? *real : 0;
  if (ratio > 1 && ratio <= s_ratio_limit) return std::nullopt;  // false for a NaN
  return std::string(s_ratio_key) + ": is " + to_string(value) + "; legal: a number above 1, up to " +
         to_string(KeyValue(s_ratio_limit));
}

// Returns why the settings have no legal configuration, and none where they have one.
std::optional<std::string> violation(const Config& base, std::vector<KeySetting> settings) {
  for (const KeySetting& s : settings) {
    if (s.path != s_ratio_key) continue;
    if (auto wrong = s_ratio_violation(s.value)) return wrong;
  }
  std::erase_if(settings, [](const KeySetting& s) { return s.path == s_ratio_key; });
  try {
    static_cast<void>(with_keys(base, settings));
  } catch (const InputError& error) {
    return error.what();
  }
  return std::nullopt;
}

// Each value must be legal in some point. What is wrong with a value alone on the base, if anything, says
// most.
void check_values(const std::vector<Section>& all, const StudyPlan& plan) {
  struct Seen {
    bool legal = false;
    std::size_t tries = 0;
    std::optional<std::string> first;
  };
  std::vector<std::map<std::vector<KeyValue>, Seen>> seen(plan.axes.size());
  std::map<std::string, std::size_t, std::less<>> axis_of;  // by the first key of the axis
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    for (const auto& values : plan.axes[a].values) seen[a].try_emplace(values);
    axis_of[plan.axes[a].keys[0]] = a;
  }
  for (const auto& point : points_of(plan)) {
    std::vector<Seen*> open;
    for (auto at = point.begin(); at != point.end();) {
      const std::size_t a = axis_of.at(at->path);
      std::vector<KeyValue> values;
      for (std::size_t k = 0; k < plan.axes[a].keys.size(); ++k) values.push_back((at++)->value);
      Seen& one = seen[a].at(values);
      if (!one.legal) open.push_back(&one);
    }
    if (open.empty()) continue;
    const auto wrong = violation(plan.base, point);
    for (Seen* one : open) {
      one->legal = !wrong || ++one->tries == tries_limit;
      if (wrong && !one->first) one->first = wrong;
    }
  }
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    for (std::size_t i = 0; i < plan.axes[a].values.size(); ++i) {
      const Seen& one = seen[a].at(plan.axes[a].values[i]);
      if (one.legal) continue;
      const auto alone = violation(plan.base, settings_at(plan.axes[a], i));
      all[a].fail(all[a].has("values") ? "values" : "from",
                  "no point can have this: " + (alone ? *alone : *one.first));
    }
  }
}

// Returns what the points of a grid of these axes set.
std::vector<std::vector<KeySetting>> grid_of(const std::vector<Axis>& axes) {
  StudyPlan grid;
  grid.axes = axes;
  return points_of(grid);
}

// A search finds out where its widths end, but each needs one that is legal on the base, with categories of
// the study or without. So does each axis of categories, where the widths may also be the widest.
void check_search_values(const std::vector<Section>& all, const StudyPlan& plan) {
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    std::vector<Axis> categories, widest;
    for (std::size_t b = 0; b < plan.axes.size(); ++b) {
      if (b == a) continue;
      const Axis& axis = plan.axes[b];
      if (is_category(axis)) categories.push_back(axis);
      widest.push_back(axis);
      if (!is_category(axis)) widest.back().values = {axis.values.back()};
    }
    std::vector<std::vector<KeySetting>> others{{}};
    if (!categories.empty()) std::ranges::move(grid_of(categories), std::back_inserter(others));
    if (is_category(plan.axes[a])) std::ranges::move(grid_of(widest), std::back_inserter(others));
    std::optional<std::string> first;
    bool legal = false;
    std::size_t tries = 0;
    for (std::size_t i = 0; i < plan.axes[a].values.size() && !legal; ++i) {
      for (std::size_t k = 0; k < others.size() && !legal; ++k) {
        auto settings = settings_at(plan.axes[a], i);
        std::ranges::copy(others[k], std::back_inserter(settings));
        const auto wrong = violation(plan.base, std::move(settings));
        legal = !wrong || (k > 0 && ++tries == tries_limit);
        if (wrong && !first) first = wrong;
      }
    }
    if (!legal) all[a].fail(all[a].has("values") ? "values" : "from", "no value is legal: " + *first);
  }
}

void check_points(const Section& study, const std::vector<Section>& all, const StudyPlan& plan) {
  if (plan.arrangement == Arrangement::list) {
    for (std::size_t a = 1; a < plan.axes.size(); ++a) {
      if (plan.axes[a].values.size() == plan.axes[0].values.size()) continue;
      all[a].fail(all[a].line(), all[a].path_of("values"),
                  "has " + std::to_string(plan.axes[a].values.size()) + " values, and vary[1] has " +
                      std::to_string(plan.axes[0].values.size()) +
                      "; legal with arrangement = \"list\": the same number in each");
    }
  }
  std::size_t points = 1;
  for (const Axis& axis : plan.axes) {
    points =
        plan.arrangement == Arrangement::grid ? points * axis.values.size() : points + axis.values.size();
    if (points <= points_limit) continue;
    study.fail(study.line("arrangement"), "study",
               "the axes make more than " + std::to_string(points_limit) + " points; legal: fewer");
  }
}

void read_size(const Section& study, StudyPlan& plan) {
  const std::string legal = "\"WIDTHxHEIGHT\", such as \"640x480\", 1.." +
                            std::to_string(picture_size_limit) + " each way and at most " +
                            std::to_string(picture_area_limit) + " pixels";
  const std::string text = study.text("size", legal);
  const std::optional<Size> size = parse_size(text);
  if (!size || !is_legal(*size)) study.fail("size", "is \"" + text + "\"; legal: " + legal);
  plan.width = size->width;
  plan.height = size->height;
}

// Returns the path of a file beside the study, wherever the program is started.
std::string file_beside(const std::string& path, const std::string& name) {
  std::error_code ignored;
  const fs::path file = fs::path(path).parent_path() / name;
  const fs::path whole = fs::absolute(file, ignored);
  return (ignored ? file : whole).lexically_normal().string();
}

// The flags of a scene, with the images that they name beside the study.
std::vector<std::string> flags_beside(const std::string& path, std::vector<std::string> flags) {
  constexpr auto of_images = std::to_array<std::string_view>({"--texture", "--texture1", "--slide"});
  const auto names_image = [&](std::string_view flag) {
    return std::ranges::find(of_images, flag) != of_images.end();
  };
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const auto equals = flags[i].find('=');
    if (equals != std::string::npos && names_image(std::string_view(flags[i]).substr(0, equals))) {
      flags[i] = flags[i].substr(0, equals + 1) + file_beside(path, flags[i].substr(equals + 1));
    } else if (i > 0 && names_image(flags[i - 1])) {
      flags[i] = file_beside(path, flags[i]);
    }
  }
  return flags;
}

std::vector<std::string> read_scenes(const Section& study, std::string_view key, const std::string& path) {
  const std::string legal =
      "an array of scenes: demo, floor, room, extreme, extreme/NAME, triangles/SIZE, streams (.tri, .trib), "
      "meshes, each with @CAMERA or without, and with flags of a scene or without";
  std::vector<std::string> out;
  for (const std::string& name : study.texts(key, legal)) {
    if (name == "-") study.fail(key, "standard input is read once, and a study goes on later; legal: files");
    const auto [named, flags] = split_flags(name);
    const std::string scene = split_view(named).scene;
    const bool embedded = scene == "demo" || scene == "floor" || scene == "room" || scene == "extreme" ||
                          scene.starts_with("extreme/") || scene.starts_with("triangles/");
    const std::string found = embedded ? named : file_beside(path, named);
    std::error_code ignored;
    if (!embedded && !fs::exists(split_view(found).scene, ignored)) {
      study.fail(key, found + ": no such file; legal: " + legal);
    }
    out.push_back(flagged_name({found, flags_beside(path, flags)}));
  }
  return out;
}

// Appends what cameras `from` to `to` - 1 see of the scenes; camera 0 is the scene's own.
void append_views(const std::vector<std::string>& scenes, int from, int to, std::vector<std::string>& out) {
  for (const std::string& scene : scenes) {
    for (int camera = from; camera < to; ++camera) {
      out.push_back(camera == 0 ? scene : view_name(scene, camera));
    }
  }
}

// The views that the points are chosen by are those of the first cameras; the next ones validate.
void read_views(const Section& study, const std::string& path, StudyPlan& plan) {
  std::vector<std::string> scenes;
  if (study.has("scenes")) scenes = read_scenes(study, "scenes", path);
  const int views = study.has("views") ? static_cast<int>(study.integer("views", 1, views_limit)) : 1;
  const int unseen =
      study.has("validate_views") ? static_cast<int>(study.integer("validate_views", 1, views_limit)) : 0;
  if ((views > 1 || unseen > 0) && scenes.empty()) scenes = {"demo", "extreme"};
  for (const std::string& scene : scenes) {
    if (views == 1 && unseen == 0) continue;
    if (split_view(scene).camera == 0 && split_flags(scene).flags.empty()) continue;
    study.fail(views > 1 ? "views" : "validate_views",
               "is given, and " + scene + " has its camera; legal: scenes without @CAMERA and flags");
  }
  append_views(scenes, 0, views, plan.scenes);
  if (study.has("validate")) plan.validation = read_scenes(study, "validate", path);
  for (const std::string& scene : plan.validation) {
    if (std::ranges::find(plan.scenes, scene) == plan.scenes.end()) continue;
    study.fail("validate", scene + " is among the scenes that points are chosen by; legal: others");
  }
  append_views(scenes, views, views + unseen, plan.validation);
}

void read_study(const Section& study, const std::string& path, const ConfigFinder& find, StudyPlan& plan) {
  plan.name = read_name(study, "-_", "a word of letters, digits, - and _");
  const std::string base =
      study.text("base", "the name of a shipped configuration, or a file beside the study");
  try {
    plan.base = base.ends_with(".toml") ? load_config(file_beside(path, base)) : find(base);
  } catch (const InputError& error) {
    study.fail("base", error.what());
  }
  read_views(study, path, plan);
  if (study.has("size")) read_size(study, plan);
  if (study.has("arrangement")) {
    plan.arrangement = static_cast<Arrangement>(study.one_of("arrangement", arrangements));
  }
  if (study.has("metrics")) {
    plan.metrics = study.texts("metrics", "an array of metrics");
    for (const std::string& metric : plan.metrics) {
      if (find_metric(metric) == nullptr) study.fail("metrics", no_metric(metric));
    }
  }
  if (study.has("cost")) plan.cost = read_cost(study);
}

Constraint read_constraint(const Section& s) {
  Constraint c;
  c.metric = read_expression(s, "metric", "a metric, such as \"span.u.p999\", or an expression");
  if (s.has("at_most")) c.at_most = s.real("at_most");
  if (s.has("at_least")) c.at_least = s.real("at_least");
  if (!c.at_most && !c.at_least) {
    s.fail(s.line(), s.path_of("at_most"), "missing; legal: at_most, at_least or both");
  }
  if (s.has("over")) c.over = static_cast<Over>(s.one_of("over", overs));
  if (c.at_most && c.at_least && *c.at_most < *c.at_least) {
    s.fail("at_most", "is below at_least: nothing holds it; legal: at_most >= at_least");
  }
  return c;
}

// Throws where the categories leave no widths to search, or make too many combinations.
void check_combinations(const Section& s, const StudyPlan& plan, const SearchPlan& search) {
  std::size_t combinations = 1;
  for (const Axis& axis : plan.axes) {
    if (is_category(axis)) combinations *= axis.values.size();
    if (combinations <= combinations_limit) continue;
    s.fail(s.line(), "vary",
           "the categories make more than " + std::to_string(combinations_limit) +
               " combinations; legal: fewer");
  }
  if (std::ranges::all_of(plan.axes, is_category)) {
    s.fail(s.line(), "vary",
           "has categories only; legal in a search: an axis of integers or more; without "
           "[search] each point is measured");
  }
  if (std::cmp_less(search.evaluations, combinations)) {
    s.fail(s.line("evaluations"), s.path_of("evaluations"),
           "is " + std::to_string(search.evaluations) + " for " + std::to_string(combinations) +
               " combinations of categories; legal: at least one each");
  }
}

SearchPlan read_search(const Section& s, const std::vector<Section>& all, const StudyPlan& plan) {
  SearchPlan search;
  if (s.has("algorithm")) {
    search.algorithm = static_cast<SearchAlgorithm>(s.one_of("algorithm", search_algorithms));
  }
  if (s.has("cost")) search.cost = read_cost(s);
  if (s.has("tie")) search.tie = read_expression(s, "tie", "a metric or an expression that decides ties");
  if (s.has("tie_within")) {
    search.tie_within = s.real("tie_within");
    if (search.tie_within < 0) s.fail("tie_within", "is below 0; legal: a number, at least 0");
  }
  if (s.has("evaluations")) {
    search.evaluations = static_cast<int>(s.integer("evaluations", 1, 100'000'000));
  }
  if (s.has("seconds")) {
    search.seconds = s.real("seconds");
    if (search.seconds <= 0) s.fail("seconds", "is not above 0; legal: a number above 0");
  }
  if (s.has("seed")) {
    search.seed = static_cast<std::uint64_t>(s.integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
  }
  if (s.has("pairs")) search.pairs = s.boolean("pairs");
  if (s.has("measure")) search.measure = static_cast<int>(s.integer("measure", 0, 1000));
  if (plan.constraints.empty()) {
    s.fail(s.line(), "constraint",
           "missing: nothing would keep the search from cutting everything; legal: one or more");
  }
  for (std::size_t a = 0; a < plan.axes.size(); ++a) {
    const Axis& axis = plan.axes[a];
    if (varies_scenes(axis)) {
      all[a].fail("keys",
                  std::string(s_ratio_key) + " is no width; legal in a search: keys of the configuration");
    }
    const auto kind_of = [&axis](const KeyValue& v) {
      return is_category(axis) ? std::holds_alternative<std::string>(v) || std::holds_alternative<bool>(v)
                               : std::holds_alternative<std::int64_t>(v);
    };
    for (const auto& values : axis.values) {
      if (std::ranges::all_of(values, kind_of)) continue;
      all[a].fail("values",
                  "are neither all integers nor all strings and booleans; legal in a search: integers, or "
                  "strings and booleans as categories");
    }
  }
  check_combinations(s, plan, search);
  return search;
}

// The points come from a file in place of axes.
void read_listed_points(const Section& root, const Section& study, const std::string& path, StudyPlan& plan) {
  const std::string file = study.text("points", "a CSV file beside the study");
  for (const char* other : {"vary", "search"}) {
    if (root.has(other)) {
      study.fail("points", fmt::format("is given beside [{}]; legal: one of them", other));
    }
  }
  if (study.has("arrangement")) {
    study.fail("arrangement", "is given, and study.points lists each point; legal: leave it out");
  }
  plan.arrangement = Arrangement::list;
  plan.axes = read_points(file_beside(path, file), plan.base);
}

// Reads an array of names, and returns what each names.
template <class Names, class Named>
auto read_named(const Section& s, const char* key, const Names& names, std::string_view what,
                const Named& named) {
  std::vector<decltype(named(std::string_view()))> out;
  for (const std::string& name : s.texts(key, "an array of " + join(names))) {
    if (std::ranges::find(names, name) == names.end())
      s.fail(key, fmt::format("\"{}\" is no {}; legal: {}", name, what, join(names)));
    out.push_back(named(name));
  }
  return out;
}

AreaPlan read_area(const Section& s) {
  AreaPlan area;
  area.families = read_named(s, "families", family_names, "family", family_named);
  if (s.has("parts"))
    area.parts = read_named(s, "parts", area_part_names, "part of the RTL", area_part_named);
  if (s.has("place")) area.place = s.boolean("place");
  return area;
}

// The values that the points have of a key: those of its axis, and the base's where they keep it.
std::vector<KeyValue> values_of(const StudyPlan& plan, const std::string& key) {
  std::vector<KeyValue> out;
  for (const Axis& axis : plan.axes) {
    const auto at = std::ranges::find(axis.keys, key) - axis.keys.begin();
    if (at == std::ssize(axis.keys)) continue;
    for (const auto& values : axis.values) out.push_back(values[static_cast<std::size_t>(at)]);
  }
  if (out.empty() || plan.arrangement == Arrangement::one_at_a_time) {
    out.push_back(value_of_key(plan.base, key));
  }
  return out;
}

}  // namespace

StudyPlan parse_study(std::string_view text, const std::string& path, const ConfigFinder& find) {
  const toml::table table =
      parse_toml(text, path, "the study is empty; legal: a TOML file with a table [study]");
  const Section root(table, "", 1, path, {"study", "vary", "constraint", "search", "area", "report"});
  StudyPlan plan;
  plan.text = text;
  if (!root.has("study")) root.fail(1, "study", "missing; legal: a table with name and base");
  const Section study =
      root.section("study", {"name", "base", "scenes", "views", "validate", "validate_views", "size",
                             "arrangement", "points", "metrics", "cost"});
  read_study(study, path, find, plan);

  if (study.has("points")) read_listed_points(root, study, path, plan);
  const auto vary = root.sections("vary", {"name", "keys", "values", "from", "to", "step", "offsets"});
  if (vary.empty() && plan.axes.empty()) {
    root.fail(1, "vary", "missing: nothing varies; legal: one [[vary]] or more, or study.points");
  }
  for (const Section& s : vary) plan.axes.push_back(read_axis(s, plan.base, plan.arrangement));
  check_disjoint(vary, plan.axes);
  for (const Section& s : root.sections("constraint", {"metric", "at_most", "at_least", "over"})) {
    plan.constraints.push_back(read_constraint(s));
  }
  if (root.has("search")) {
    plan.search = read_search(root.section("search", {"algorithm", "cost", "tie", "tie_within", "evaluations",
                                                      "seconds", "seed", "pairs", "measure"}),
                              vary, plan);
    if (study.has("arrangement")) {
      study.fail("arrangement", "is given, and a search goes its own way; legal: leave it out");
    }
    if (study.has("cost")) study.fail("cost", "is given beside a search; legal: search.cost");
    check_search_values(vary, plan);
  } else if (!vary.empty()) {
    check_points(study, vary, plan);
    check_values(vary, plan);
  }
  if (root.has("area")) plan.area = read_area(root.section("area", {"families", "parts", "place"}));
  if (root.has("report")) {
    const Section report = root.section("report", {"budget", "bounds"});
    plan.budget = report.has("budget") && report.boolean("budget");
    plan.bounds = report.has("bounds") && report.boolean("bounds");
  }
  return plan;
}

bool is_csv_column(std::string_view name) {
  return name == scene_column || std::ranges::find(csv_columns, name) != csv_columns.end();
}

StudyPlan load_study(const std::string& path, const ConfigFinder& find) {
  return parse_study(read_toml_file(path, "study"), path, find);
}

std::vector<std::vector<KeySetting>> points_of(const StudyPlan& plan) {
  std::vector<std::vector<KeySetting>> out;
  const auto& axes = plan.axes;
  switch (plan.arrangement) {
    case Arrangement::grid: {
      out.emplace_back();
      for (const Axis& axis : axes) {
        std::vector<std::vector<KeySetting>> wider;
        wider.reserve(out.size() * axis.values.size());
        for (const auto& point : out) {
          for (std::size_t i = 0; i < axis.values.size(); ++i) {
            wider.push_back(point);
            std::ranges::copy(settings_at(axis, i), std::back_inserter(wider.back()));
          }
        }
        out = std::move(wider);
      }
      break;
    }
    case Arrangement::one_at_a_time:
      out.emplace_back();
      for (const Axis& axis : axes) {
        for (std::size_t i = 0; i < axis.values.size(); ++i) out.push_back(settings_at(axis, i));
      }
      break;
    case Arrangement::list:
      for (std::size_t i = 0; !axes.empty() && i < axes.front().values.size(); ++i) {
        out.emplace_back();
        for (const Axis& axis : axes) std::ranges::copy(settings_at(axis, i), std::back_inserter(out.back()));
      }
      break;
  }
  return out;
}

std::vector<Config> lightings_of(const StudyPlan& plan) {
  std::vector<Config> out;
  for (const KeyValue& at : values_of(plan, "light.at")) {
    for (const KeyValue& source : values_of(plan, "light.source")) {
      const Config config = with_keys(plan.base, {{"light.at", at}, {"light.source", source}});
      const auto same = [&](const Config& c) {
        return has_light(c.light) == has_light(config.light) &&
               has_light_points(c) == has_light_points(config);
      };
      if (std::ranges::none_of(out, same)) out.push_back(config);
    }
  }
  return out;
}

void check_metrics(const StudyPlan& plan, const Metrics& metrics) {
  std::vector<std::string> named = judged_metrics(plan);
  // The tables of a search may show areas, which no measurement of a point has.
  if (!plan.search) named.insert(named.begin(), plan.metrics.begin(), plan.metrics.end());
  for (const std::string& name : named) {
    if (metrics.contains(name)) continue;
    std::vector<std::string> known;
    for (const auto& [metric, value] : metrics) known.push_back(metric);
    throw InputError(plan.name + ": " + name +
                     ": the scenes give no such metric; nearest: " + comma_list(nearest_names(name, known)));
  }
}

}  // namespace bitspan
