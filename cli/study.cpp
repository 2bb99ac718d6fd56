// SPDX-License-Identifier: Apache-2.0
// bitspan study: many points of a configuration, their errors and costs, in a database.
#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/model_options.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/study_results.hpp"
#include "config/modes.hpp"
#include "config/store.hpp"
#include "io/atomic_file.hpp"
#include "io/json_depth.hpp"
#include "report/table.hpp"
#include "scene/bez.hpp"
#include "scene/camera_views.hpp"
#include "scene/tri_stream.hpp"
#include "study/area_estimate.hpp"
#include "study/keys.hpp"
#include "study/merge.hpp"
#include "study/metrics.hpp"
#include "study/point.hpp"
#include "study/recommend.hpp"
#include "study/sweep.hpp"

namespace bitspan {
namespace {

struct StudyArguments {
  std::vector<std::string> inputs;  // the study; scenes of --point
  std::string db, csv, scenes_csv, report, against, point, replay, size, shard;
  int threads = 0;
  std::optional<std::size_t> points;
  bool allow_empty = false;
};

constexpr std::size_t table_rows = 40;

using Table = std::vector<std::vector<std::string>>;

std::string number_text(double value) { return std::isnan(value) ? "-" : fmt::format("{:.6g}", value); }

// Returns the value of a metric, an estimate with its ±.
std::string value_text(const std::string& metric, double value, const Metrics& metrics) {
  const auto error = metrics.find(plus_minus_of(metric));
  return error == metrics.end() ? number_text(value) : estimate_text(value, error->second);
}

// Whether a size may be asked for. Streams and the extreme scenes have their own.
bool takes_size(const std::string& name) {
  return !is_stream(name) && name != "extreme" && !name.starts_with("extreme/");
}

// Loads the scenes. Without names they are the embedded set. is_lit: their shadows are biased for the codes
// of that configuration; else they are the same with all.
std::vector<Scene> scenes_of(std::vector<std::string> names, int width, int height, bool allow_empty,
                             const Config& config, bool is_lit = false) {
  if (names.empty()) names = {"demo", "extreme"};
  std::vector<Scene> out;
  for (const std::string& name : names) {
    const auto [named, flags] = split_flags(name);
    SceneOptions options = seen_with(config, parse_scene_flags(flags));
    if (options.size.empty() && takes_size(split_view(named).scene)) {
      options.size = fmt::format("{}x{}", width, height);
    }
    // Each point would have passes of its own.
    options.config.reset();
    if (!is_lit) {
      options.depth_bits = SceneOptions{}.depth_bits;
      options.depth_code = SceneOptions{}.depth_code;
    }
    options.allow_empty = options.allow_empty || allow_empty;
    for (LoadedScene& loaded : load_scenes(named, options)) {
      refuse_without_faces(loaded, options);
      if (!flags.empty()) loaded.scene.name = name;
      out.push_back(std::move(loaded.scene));
    }
  }
  return out;
}

// The scene of a study again, as another configuration compares its shadows.
Scene loaded_again(const Scene& scene, const Config& config) {
  std::vector<Scene> out = scenes_of({scene.name}, scene.width, scene.height, true, config, true);
  if (out.size() != 1) throw InputError(fmt::format("{}: is {} scenes", scene.name, out.size()));
  return std::move(out[0]);
}

// The curves of a scene of patches that is drawn whole: so the scene's hash is theirs, too.
std::optional<CurveSet> curves_again(const Scene& scene) {
  const auto [named, flags] = split_flags(scene.name);
  if (!named.ends_with(".bez")) return std::nullopt;
  const SceneOptions options = parse_scene_flags(flags);
  if (!options.no_cull) return std::nullopt;
  return curves_of(read_bez(named), options.patch_depth.value_or(patch_k_default));
}

// The scenes of a study, lit as all of its points ask for. Throws InputError where a scene is not the same
// for all: a mesh is lit by the unit of the configuration, or by the front end where there is none.
std::vector<Scene> scenes_of(const StudyPlan& plan, const std::vector<std::string>& names, bool allow_empty) {
  const std::vector<Config> asked = lightings_of(plan);
  std::vector<Scene> out = scenes_of(names, plan.width, plan.height, allow_empty, asked[0]);
  for (std::size_t i = 1; i < asked.size(); ++i) {
    const std::vector<Scene> other = scenes_of(names, plan.width, plan.height, allow_empty, asked[i]);
    for (std::size_t s = 0; s < out.size(); ++s) {
      if (scene_hash(out[s]) == scene_hash(other[s])) continue;
      throw InputError(
          fmt::format("{}: {}: the points do not light it alike, and all measure one scene; expected "
                      "light.at none at all points or at no point, one light.source, or --unlit behind the "
                      "scene",
                      plan.name, out[s].name));
    }
  }
  return out;
}

Measure make_meter(std::vector<Scene> scenes) {
  return
      [meter = std::make_shared<PointMeter>(std::move(scenes), half_of_memory(), loaded_again, curves_again)](
          const Config& config) { return meter->measure(config); };
}

// Reads "I/N", the I-th of N parts, counted from 1.
Shard shard_of(const std::string& text) {
  constexpr std::size_t most = 100'000;
  Shard out;
  if (text.empty()) return out;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, out.index);
  const bool slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = slash ? std::from_chars(index.ptr + 1, end, out.count) : index;
  if (!slash || count.ec != std::errc() || count.ptr != end || out.index < 1 || out.index > out.count ||
      out.count > most) {
    throw InputError(fmt::format("--shard: \"{}\"; expected I/N, the I-th of N parts, such as 1/4", text));
  }
  --out.index;
  return out;
}

// Returns the path of the database: beside the output, or here. Shards that share a folder have one each.
std::string database_of(const StudyArguments& o, const StudyPlan& plan, const Shard& shard) {
  if (!o.db.empty()) return o.db;
  const std::string part = shard.whole() ? "" : fmt::format(".{}-of-{}", shard.index + 1, shard.count);
  return (std::filesystem::path(o.csv).parent_path() / (plan.name + part + ".db")).string();
}

std::string replay_command(const std::string& db) {
  return fmt::format("bitspan study --db {} --replay", shell_word(db));
}

// Returns the metrics that a printed table shows.
std::vector<std::string> shown_metrics(const StudyPlan& plan) {
  std::vector<std::string> out = plan.metrics;
  for (const Constraint& c : plan.constraints) {
    if (std::ranges::find(out, c.metric) == out.end()) out.push_back(c.metric);
  }
  if (find_metric(plan.cost) == nullptr) out.push_back(plan.cost);  // an expression
  if (out.empty()) {
    out = {"span.u.p999", "span.v.p999", "picture.wrong_order_rate", "picture.psnr_db", "cost.register_bits"};
  }
  return out;
}

// A table shows so many linked keys side by side. Of more it shows one that tells all values apart, or those
// that change.
constexpr std::size_t shown_keys = 4;

// Returns the axis with the keys that a table shows.
Axis shown_axis(const Axis& axis) {
  if (!axis.name.empty() || axis.keys.size() <= shown_keys) return axis;
  Axis telling, changing;
  for (std::size_t k = 0; k < axis.keys.size(); ++k) {
    std::set<KeyValue> values;
    for (const auto& row : axis.values) values.insert(row[k]);
    if (values.size() > 1) changing.keys.push_back(axis.keys[k]);
    if (values.size() == axis.values.size() && telling.keys.empty()) telling.keys = {axis.keys[k]};
  }
  return telling.keys.empty() ? changing : telling;
}

// Returns the head of the axis's column: its name, or the keys without the part that the first one has in
// common with them.
std::string axis_head(const Axis& axis) {
  if (!axis.name.empty()) return axis.name;
  const Axis shown = shown_axis(axis);
  std::string out = shown.keys[0];
  for (std::size_t k = 1; k < shown.keys.size(); ++k) {
    out += ", " + shown.keys[k].substr(shown.keys[k].rfind('.') + 1);
  }
  if (shown.keys.size() == axis.keys.size()) return out;
  return fmt::format("{} +{}", out, axis.keys.size() - shown.keys.size());
}

std::string points_text(const StudyPlan& plan, Store& store) {
  const auto metrics = shown_metrics(plan);
  Table rows{{"i"}};
  for (const Axis& axis : plan.axes) rows[0].push_back(axis_head(axis));
  std::ranges::copy(metrics, std::back_inserter(rows[0]));
  rows[0].emplace_back("holds");
  std::size_t count = 0;
  for (const Row& row : store.rows("SELECT i, holds, hash, status, settings FROM study_points JOIN points "
                                   "USING (hash) WHERE study = ? ORDER BY i",
                                   {plan.name})) {
    if (++count > table_rows) continue;
    std::vector<std::string> line{fmt::format("{}", integer_of(row[0]))};
    const auto settings = parse_settings(text_of(row[4]));
    for (const Axis& axis : plan.axes) line.push_back(axis_text(shown_axis(axis), settings));
    const Metrics measured = store.metrics(text_of(row[2])).all;
    for (const std::string& metric : metrics) {
      const auto found = measured.find(metric);
      line.push_back(found == measured.end() ? "-" : value_text(metric, found->second, measured));
    }
    line.emplace_back(text_of(row[3]) != "ok" ? "refused" : integer_of(row[1]) != 0 ? "yes" : "no");
    rows.push_back(std::move(line));
  }
  std::string out = text_table(rows);
  if (count > table_rows) out += fmt::format("... and {} more: --csv FILE has all\n", count - table_rows);
  return out;
}

void export_csv(const StudyArguments& o, const StudyPlan& plan, Store& store) {
  const auto to = [&](const std::string& path, auto write_to) {
    if (path.empty()) return;
    AtomicFile file(path);
    write_to(plan, store, replay_command(store.path()), [&](std::string_view text) { file.write(text); });
    file.commit();
  };
  to(o.csv, write_csv);
  to(o.scenes_csv, write_scenes_csv);
}

// Prints the command that goes on with a study where this one ended; returns the exit code.
int cut_short(const StudyArguments& o, const std::string& so_far, const Store& store,
              const Interrupt& interrupt) {
  fmt::print("{}{}; go on with: bitspan study {} --db {}{}{}{}{}{}\n",
             interrupt.exit_code() != 0 ? "stopped" : "not finished", so_far, shell_word(o.inputs[0]),
             shell_word(store.path()), o.shard.empty() ? "" : " --shard " + o.shard,
             o.csv.empty() ? "" : " --csv " + shell_word(o.csv),
             o.scenes_csv.empty() ? "" : " --csv-scenes " + shell_word(o.scenes_csv),
             o.report.empty() ? "" : " --report " + shell_word(o.report),
             o.against.empty() ? "" : " --against " + shell_word(o.against));
  return interrupt.exit_code();
}

// Does what comes after the points of a study, unless something stopped it. Returns 0, or 1 where no point
// holds or something that is recommended does not.
int end_study(const StudyArguments& o, const StudyPlan& plan, const std::vector<Scene>& scenes, Store& store,
              const Interrupt& interrupt, bool any_holds) {
  const auto load = [&](const std::string& name) { return scenes_of(plan, {name}, o.allow_empty); };
  const bool held =
      interrupt.exit_code() == 0 &&
      examine_recommendations(plan, scenes, load, loaded_again, curves_again, store, interrupt.token());
  if (interrupt.exit_code() != 0) return cut_short(o, "", store, interrupt);
  if (!o.report.empty()) write_study_report(store.path(), plan.name, o.report, o.against);
  return any_holds && held ? exit_held : exit_difference;
}

int run_and_tell_search(const StudyArguments& o, const StudyPlan& plan, PointRunner& runner, Store& store,
                        const RunOptions& options, const std::vector<Scene>& scenes,
                        const Interrupt& interrupt) {
  for (const std::string& keys : idle_axes(plan, scenes)) {
    fmt::print("{} does not move {}\n", keys, plan.search->cost);
  }
  std::fflush(stdout);  // before the search, which takes its time
  SearchResult result;
  {
    Progress progress(plan.name);
    result = run_search(plan, runner, store, options, [&](const SearchProgress& p) {
      progress.update(p.evaluations, static_cast<std::size_t>(plan.search->evaluations));
    });
  }
  export_csv(o, plan, store);
  fmt::print("{}", search_text(plan, result));
  std::fflush(stdout);  // before the synthesis
  fmt::print("{}", measure_text(plan, result, runner, store, interrupt.token()));
  return end_study(o, plan, scenes, store, interrupt, result.found);
}

int sweep(const StudyArguments& o, const StudyPlan& plan, PointRunner& runner, Store& store,
          RunOptions options, const std::vector<Scene>& scenes, const Interrupt& interrupt) {
  const auto start = std::chrono::steady_clock::now();
  SweepResult result;
  {
    Progress progress(plan.name);
    options.progress = [&](std::size_t done, std::size_t total) { progress.update(done, total); };
    result = run_sweep(plan, runner, store, options);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  export_csv(o, plan, store);
  if (interrupt.exit_code() == 0) fmt::print("{}\n", points_text(plan, store));
  fmt::print("{}: {} points: {} of them known, {} refused, {} hold{}; {} measured in {:.1f} s\n", plan.name,
             result.points, result.known, result.refused, result.holding,
             plan.constraints.empty() ? " (there is no constraint)" : "", result.measured, seconds);
  fmt::print("one point again: {} HASH\n", replay_command(store.path()));
  if (!result.finished()) {
    const std::string so_far = fmt::format(": {} of {} points are in {}", result.points - result.missing,
                                           result.points, store.path());
    return cut_short(o, so_far, store, interrupt);
  }
  if (!options.shard.whole()) {
    fmt::print("shard {} is finished; with all others: bitspan study merge --db {} {}\n", o.shard,
               shell_word(plan.name + ".db"), shell_word(store.path()));
    return exit_held;
  }
  return end_study(o, plan, scenes, store, interrupt, result.holding != 0);
}

int run_study(const StudyArguments& o) {
  const Interrupt interrupt;
  if (o.inputs.size() != 1)
    throw InputError("study: one STUDY.toml; scenes on the command line go with --point");
  const Shard shard = shard_of(o.shard);
  const StudyPlan plan = load_study(o.inputs[0], find_config);
  if (!o.shard.empty() && (plan.search || !o.report.empty())) {
    throw InputError(fmt::format(
        "--shard: {}; expected {}",
        plan.search ? "a search goes from point to point and has no parts" : "a report is of all parts",
        plan.search ? "several programs on one --db" : "--report after bitspan study merge"));
  }
  check_writable(o.csv);
  check_writable(o.scenes_csv);
  if (!o.report.empty()) make_writable_folder(o.report);
  const std::vector<Scene> scenes = scenes_of(plan, plan.scenes, o.allow_empty);
  check_report(plan, scenes);
  Store store(database_of(o, plan, shard), BITSPAN_VERSION);
  PointRunner runner(plan.base, scenes, make_meter, store, BITSPAN_VERSION, asked_of(plan));
  RunOptions options;
  options.threads = o.threads;
  options.shard = shard;
  options.stop = interrupt.token();
  if (o.points) options.limit = *o.points;
  return plan.search ? run_and_tell_search(o, plan, runner, store, options, scenes, interrupt)
                     : sweep(o, plan, runner, store, options, scenes, interrupt);
}

std::string result_text(const PointResult& result) {
  Table fields{{"stage", "quantity", "unit"}};
  for (const StatisticColumn& c : statistic_columns()) fields[0].push_back(c.label);
  for (const FieldError& f : result.fields) {
    fields.push_back({f.stage, f.quantity, f.unit});
    for (const StatisticColumn& c : statistic_columns()) {
      fields.back().push_back(
          number_text(result.metrics.at(fmt::format("{}.{}.{}", f.stage, f.quantity, c.ending))));
    }
  }
  Table registers{
      {"register", "word", "int", "minimum", "maximum", "used int", "head-room", "wraps", "saturations"}};
  for (const RegisterUse& r : result.registers) {
    registers.push_back({r.name, fmt::format("{}", r.format.word), fmt::format("{}", r.format.integer),
                         number_text(r.min), number_text(r.max), fmt::format("{}", r.used_bits),
                         fmt::format("{}", r.headroom), fmt::format("{}", r.wraps),
                         fmt::format("{}", r.saturations)});
  }
  Table metrics{{"metric", "value", "unit"}};
  for (const auto& [name, value] : result.metrics) {
    const Metric* const metric = find_metric(name);
    if (metric == nullptr || !metric->field.empty() || metric->role == MetricRole::detail) continue;
    if (is_plus_minus(name)) continue;  // stands beside its value
    metrics.push_back({name, value_text(name, value, result.metrics), metric->unit});
  }
  return text_table(fields) + "\n" + text_table(registers) + "\n" + text_table(metrics);
}

int measure_point(const StudyArguments& o) {
  const Config config = find_config(o.point);
  const Size size = picture_size(o.size);
  const std::vector<Scene> scenes = scenes_of(o.inputs, size.width, size.height, o.allow_empty, config);
  const auto start = std::chrono::steady_clock::now();
  const PointResult result = make_meter(scenes)(config);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}\n{} ({}) on {} scenes: {:.2f} s\n", result_text(result), config.name, config_hash(config),
             scenes.size(), seconds);
  if (!o.db.empty()) {
    Store store(o.db, BITSPAN_VERSION);
    const std::string hash = point_hash(config, scenes, BITSPAN_VERSION);
    store.put_point(
        {hash, config_hash(config), to_toml(config), scenes_json(scenes, std::nullopt), true, "", seconds},
        &result);
    fmt::print("again: {} {}\n", replay_command(o.db), hash);
  }
  return exit_held;
}

// Returns the scenes of a stored point, as they were.
std::vector<Scene> stored_scenes(const PointRow& point, const Config& config, const std::string& db) {
  std::vector<Scene> out;
  try {
    check_json_depth(point.scenes);
    for (const auto& one : nlohmann::json::parse(point.scenes)) {
      const std::string name = one.at("name");
      std::vector<Scene> loaded = scenes_of({name}, one.at("width"), one.at("height"), true, config);
      if (loaded.size() != 1) throw InputError(fmt::format("{}: is {} scenes", name, loaded.size()));
      Scene scene = std::move(loaded[0]);
      if (one.contains("s_ratio")) scene = with_s_ratio(std::move(scene), one.at("s_ratio"));
      if (scene_hash(scene) != one.at("hash").get<std::string>()) {
        throw InputError(
            fmt::format("{}: the scene is not what it was when {} was measured", name, point.hash));
      }
      out.push_back(std::move(scene));
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: {}: its scenes are unreadable: {}", db, point.hash, error.what()));
  }
  return out;
}

// Returns the point of a hash. The hash may be cut short where that still names one point.
PointRow find_point(Store& store, const std::string& prefix) {
  const auto hashes = store.points_like(prefix);
  if (hashes.size() != 1) {
    throw InputError(fmt::format("--replay {}: {} of {}", prefix,
                                 hashes.empty() ? "no point" : fmt::format("begins {} points", hashes.size()),
                                 store.path()));
  }
  return *store.point(hashes[0]);
}

int replay(const StudyArguments& o) {
  if (o.db.empty()) throw InputError("--replay: of which database? give --db FILE");
  if (!o.inputs.empty())
    throw InputError("--replay: takes scenes and configuration from the database; leave them out");
  Store store(o.db, BITSPAN_VERSION, Store::Mode::existing);
  const PointRow point = find_point(store, o.replay);
  if (point.config.empty()) {
    throw InputError(
        fmt::format("{}: its settings make no legal configuration: {}", point.hash, point.message));
  }
  const Config config = parse_config(point.config, "stored");
  const std::vector<Scene> scenes = stored_scenes(point, config, o.db);
  if (point_hash(config, scenes, BITSPAN_VERSION) != point.hash) {
    fmt::print("{}: was measured by another version of bitspan\n", point.hash);
  }
  std::vector<std::string> different;
  try {
    const PointResult result = make_meter(scenes)(config);
    fmt::print("{}\n", result_text(result));
    different =
        point.ok ? differences(store.result_rows(point.hash), rows_of(result, store.known(point.hash)->asked))
                 : std::vector<std::string>{"refused when stored: " + point.message + "; measured now"};
  } catch (const InputError& error) {
    fmt::print("refused: {}\n", error.what());
    if (point.ok) different.push_back("measured when stored; refused now");
  }
  for (const std::string& line : different) fmt::print("{}\n", line);
  fmt::print("{}: {}\n", point.hash,
             different.empty() ? "the same, bit for bit" : fmt::format("{} differences", different.size()));
  return different.empty() ? exit_held : exit_difference;
}

int study(const StudyArguments& o) {
  // A point takes a hundred megabytes and gives them back. They must go back to the heap and not to the
  // system, which would clear each page anew. That would take a third of a point's time.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  if (o.threads < 0 || o.threads > threads_limit) {
    throw InputError(
        fmt::format("--threads: {}; expected 1..{}, or 0 for one on each core", o.threads, threads_limit));
  }
  if (!o.point.empty() && !o.replay.empty()) throw InputError("--point and --replay: one of them");
  if (!o.size.empty() && o.point.empty()) throw InputError("--size: goes with --point; a study has its own");
  if (!o.shard.empty() && (!o.point.empty() || !o.replay.empty())) {
    throw InputError("--shard: goes with a STUDY.toml");
  }
  if (!o.against.empty() && o.report.empty()) throw InputError("--against: goes with --report");
  // Said before the study runs, which may take hours.
  if (!o.against.empty() && !std::filesystem::is_regular_file(o.against)) {
    throw InputError(fmt::format("--against {}: no such file", o.against));
  }
  if (!o.replay.empty()) return replay(o);
  return o.point.empty() ? run_study(o) : measure_point(o);
}

struct MergeArguments {
  std::string db;
  std::vector<std::string> from;
};

int merge(const MergeArguments& o) {
  // What cannot be merged leaves no new database.
  for (const std::string& from : o.from) Store(from, BITSPAN_VERSION, Store::Mode::existing);
  Store store(o.db, BITSPAN_VERSION);
  for (const std::string& from : o.from) {
    const Merged merged = merge_database(store, from, BITSPAN_VERSION);
    fmt::print("{}: {} points, {} of them new\n", from, merged.points, merged.fresh);
    std::fflush(stdout);
  }
  return exit_held;
}

void add_merge(CLI::App& study, Action& action) {
  CLI::App* sub = study.add_subcommand("merge", "bring the points of several databases into one");
  const auto o = std::make_shared<MergeArguments>();
  sub->add_option("from", o->from, "databases, which stay as they are")->required();
  sub->add_option("--db", o->db, "the database that gets their points and studies")->required();
  sub->footer("A study that is run again on the merged database measures nothing that one of them had.\n" +
              help_footer("all are merged", "",
                          "bitspan study grid.toml --shard 1/2\n"
                          "  bitspan study grid.toml --shard 2/2\n"
                          "  bitspan study merge --db grid.db grid.1-of-2.db grid.2-of-2.db\n"
                          "  bitspan study grid.toml --db grid.db --report out/grid"));
  sub->callback([o, &action] { action = [o] { return merge(*o); }; });
}

}  // namespace

void add_study(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("study", "which widths may be cut, and what each bit buys");
  const auto o = std::make_shared<StudyArguments>();
  sub->add_option("study", o->inputs, "STUDY.toml; with --point: scenes (default: demo and extreme)");
  sub->add_option("--db", o->db, "the database (default: NAME.db beside the CSV file, or in this folder)");
  sub->add_option("--csv", o->csv, "write all points as CSV");
  sub->add_option("--csv-scenes", o->scenes_csv, "write all points as CSV, a line per scene");
  sub->add_option("--report", o->report, "write an HTML report and its plots into this folder");
  sub->add_option(
      "--against", o->against,
      "with --report: compare with the study of the same name, or the only one, of this database");
  sub->add_option("--threads", o->threads, "points measured at once (0: one per core)")
      ->capture_default_str();
  sub->add_option("--points", o->points,
                  "measure at most this many points anew; the same command goes on later");
  sub->add_option("--shard", o->shard,
                  "I/N: the I-th of N equal parts of the points, into a database of its own");
  sub->add_option("--point", o->point, "measure one configuration, given by a shipped name or a TOML file");
  sub->add_option("--size", o->size, "with --point: WxH of demo and meshes (default 640x480)");
  sub->add_option("--replay", o->replay, "measure a point of the database again and compare bit for bit");
  sub->add_flag("--allow-empty", o->allow_empty, "accept a mesh of which no face is drawn");
  sub->footer(
      "Ctrl-C stops after the points that are being measured, and the program exits with 130.\n"
      "The same command goes on from there.\n" +
      help_footer("a point holds all constraints",
                  "no point does, a recommended point fails, or --replay differs",
                  "bitspan study config/studies/dividers.toml --csv dividers.csv\n"
                  "  bitspan study config/studies/uv_bits.toml --report out/uv_bits\n"
                  "  bitspan study config/studies/depth.toml --shard 1/4\n"
                  "  bitspan study --point depth16 demo\n"
                  "  bitspan study --db dividers.db --replay 1f0c"));
  sub->callback([o, &action, sub] {
    if (sub->get_subcommands().empty()) action = [o] { return study(*o); };
  });
  add_merge(*sub, action);
}

}  // namespace bitspan
