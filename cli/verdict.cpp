// SPDX-License-Identifier: Apache-2.0
#include "cli/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "cli/bands.hpp"
#include "cli/cycles.hpp"
#include "cli/failing_case.hpp"
#include "cli/progress.hpp"
#include "config/modes.hpp"
#include "engine/stages.hpp"
#include "report/edges.hpp"
#include "report/layers.hpp"
#include "report/metrics.hpp"
#include "report/quadrics.hpp"
#include "report/table.hpp"
#include "study/oracles.hpp"

namespace bitspan {

bool coverage_is_exact(const Config& config) {
  return !has_x_step(config) || has_plane_rows(config.perspective);
}

namespace {

std::string number(std::uint64_t n) { return fmt::format("{}", n); }

// Whether a pair's records hold values that could have differed.
bool is_trivial(const Comparison& pair) { return pair.total().non_trivial == 0; }

void judge_differences(SceneVerdict& v) {
  for (const Comparison& pair : v.run.pairs) {
    if (pair.first) {
      v.failures.push_back(
          fmt::format("{} against {}: {}", pair.reference, pair.other, summary(*pair.first, v.config)));
    }
    if (!pair.fault.empty()) {
      v.failures.push_back(fmt::format("{} broke off: {}", pair.other, pair.fault));
    }
  }
  for (std::size_t p = 0; p < v.resolved.size(); ++p) {
    if (v.resolved[p].count.differences == 0) continue;
    v.failures.push_back(fmt::format("{} against {}: {}", v.run.pairs[p].reference, v.run.pairs[p].other,
                                     v.resolved[p].first));
  }
  // A run that stopped early has not drawn all that the exact test covers.
  if (v.has_errors && coverage_is_exact(v.config) && v.errors.coverage_differences() > 0) {
    v.failures.push_back(
        fmt::format("coverage differs from the exact test: {} missed, {} surplus, {} drawn twice",
                    v.errors.missed, v.errors.surplus, v.errors.doubled));
  }
  for (const VisibilityReport& oracle : v.oracles) {
    if (oracle.held()) continue;
    v.failures.push_back(fmt::format("oracle {} against {}: {} {} are unexplained; the first: {}",
                                     oracle.oracle, oracle.engine, oracle.unexplained, oracle.unit,
                                     oracle.first));
  }
  for (const BandReport& report : v.bands) {
    v.failures.insert(v.failures.end(), report.failures.begin(), report.failures.end());
  }
  if (v.cycles && v.cycles->differences > 0) {
    v.failures.push_back(
        fmt::format("cycles of the span interpolator, systemc against rtl: {}", v.cycles->first));
  }
  for (const ChainVerdict& chain : v.chain) {
    if (chain.differences == 0) continue;
    v.failures.push_back(
        fmt::format("cycles of the chain, systemc against rtl, {}: {}", chain.memory, chain.first));
  }
}

// What the scene does not draw, in one line; empty where it covers a pixel.
std::string emptiness(const SceneVerdict& v) {
  if (v.counters.covered != 0) return "";
  if (v.faces && v.faces->drawn == 0) return "no face of the mesh is drawn";
  return "the scene covers no pixel centre: nothing is drawn";
}

// The last stages of the pipeline, as far as no engine delivered a record of them. A stage before one with
// records has none where the configuration does without it.
std::vector<std::string> stages_not_reached(const LockStepResult& run) {
  std::vector<std::string> out;  // since the last stage with records
  for (const StageRow& row : stage_table) {
    const auto reached = [&row](const Comparison& pair) {
      const StageCount& count = pair.stages[static_cast<std::size_t>(row.type)];
      return count.records + count.unmatched != 0;
    };
    if (std::ranges::any_of(run.pairs, reached)) {
      out.clear();
    } else if (!is_switched(row.type)) {
      out.emplace_back(row.name);
    }
  }
  return out;
}

// "texture, fog and merge compared nothing: ...", with the reason where the counters tell it.
std::string not_reached_text(const SceneVerdict& v) {
  const Counters& c = v.counters;
  std::string out = v.not_reached.front();
  for (std::size_t i = 1; i < v.not_reached.size(); ++i) {
    out += (i + 1 == v.not_reached.size() ? " and " : ", ") + v.not_reached[i];
  }
  out += " compared nothing: ";
  if (c.depth_passed == 0) {
    return out +
           fmt::format("no pixel passes the depth test (depth.func = {})", to_string(v.config.depth_func));
  }
  if (c.killed == c.depth_passed) return out + "the texture kills every pixel that passes the depth test";
  return out + "no pixel comes so far";
}

void judge_emptiness(SceneVerdict& v, const VerifyOptions& options) {
  const auto fail_unless = [&](bool allowed, std::string_view flag, const std::string& text) {
    if (allowed) {
      v.notes.push_back(text);
    } else {
      v.failures.push_back(fmt::format("{} ({} accepts this)", text, flag));
    }
  };
  if (v.faces && v.faces->drawn == 0 && !options.allow_empty) {
    fail_unless(false, "--allow-empty", emptiness(v));
    return;
  }
  for (const std::string& text : v.left_out) {
    fail_unless(options.allow_missing || !options.engines_named, "--allow-missing", text);
  }
  for (const std::string& text : v.oracles_left_out) {
    // Of all oracles those that fit the scene are asked for, which is one at least.
    fail_unless(options.allow_missing || (!options.oracles_named && v.has_true_oracle()), "--allow-missing",
                text);
  }
  if (v.run.pairs.empty() && !v.has_true_oracle()) {
    fail_unless(options.allow_missing, "--allow-missing", "nothing was compared");
  }
  if (const std::string text = emptiness(v); !text.empty()) {
    if (v.has_errors && v.truth_draws) {
      v.failures.emplace_back("nothing was drawn, though pixels are covered by the exact test");
    } else {
      fail_unless(options.allow_empty, "--allow-empty", text);
    }
    return;
  }
  if (!v.not_reached.empty()) fail_unless(options.allow_empty, "--allow-empty", not_reached_text(v));
  for (const Comparison& pair : v.run.pairs) {
    if (is_trivial(pair)) {
      v.failures.push_back(
          fmt::format("{} against {}: nothing non-trivial was compared", pair.reference, pair.other));
    }
  }
  if (v.cycles && v.cycles->pixels == 0) {
    v.failures.emplace_back("cycles of the span interpolator: no pixel was compared");
  }
}

void compare_oracles(const VerifyOptions& options, const Scene& scene, const Engine& engine,
                     SceneVerdict& v) {
  if (options.oracles.empty()) return;
  const std::optional<ShadowPlan> plan = shadow_plan_of(v.config, scene);
  const Scene& shown = plan ? plan->picture : scene;
  std::optional<Frame> of_picture;
  if (plan) of_picture = frame_of_picture(*plan, engine.frame());
  const Frame& frame = of_picture ? *of_picture : engine.frame();
  std::string refusal;
  const std::optional<Visibility> visibility = visibility_of(v.config, shown, refusal);
  const std::optional<Scene> own = by_distance(v.config, shown);
  const std::optional<Scene> layered = layered_picture_of(scene);
  for (const Oracle* oracle : options.oracles) {
    const auto leave_out = [&](const std::string& why) {
      v.oracles_left_out.push_back(fmt::format("oracle {} left out: {}", oracle->name, why));
    };
    if (layered && oracle->has_layers) {
      if (const std::string why = layer_refusal(v.config, *layered); !why.empty()) {
        leave_out(why);
      } else {
        golden::ABuffer lists = golden::make_abuffer(v.config, *layered);
        v.oracles.push_back(layer_report(*oracle, frame, engine.name(),
                                         layer_findings(v.config, *layered, lists, frame, engine.name())));
      }
      continue;
    }
    if (oracle->edges != nullptr) {
      // It needs no bounds of depth.
      std::string why = visibility ? "" : visibility_refusal(v.config, shown);
      if (why.empty()) {
        const Scene& taken = own ? *own : shown;
        VisibilityReport report = edge_report(*oracle, taken, seen_edges(*oracle, v.config, taken));
        if (report.compared() != 0) {
          v.oracles.push_back(std::move(report));
          continue;
        }
        why = "there is no edge of a triangle whose fragments cannot be killed";
      }
      leave_out(why);
      continue;
    }
    if (const std::string why = visibility ? own_refusal(*oracle, v.config, shown) : refusal; !why.empty()) {
      leave_out(why);
      continue;
    }
    std::vector<OracleCount> counts;
    const std::vector<Visible> picture = visibility->picture(*oracle, &counts);
    VisibilityReport report = visibility->compare(*oracle, picture, frame, engine.name());
    report.counts = std::move(counts);
    if (report.compared() == 0 && v.counters.covered != 0) {
      leave_out("at each pixel a triangle may be seen whose fragments may be killed");
      continue;
    }
    const std::size_t seen = v.oracles.size();
    v.oracles.push_back(std::move(report));
    if (judges_quadrics(*oracle, *visibility)) {
      v.oracles.push_back(quadric_report(*visibility, *oracle, picture, frame, engine.name()));
    }
    if (plan && oracle->has_shadows) {
      const VisibilityReport& by_eye = v.oracles[seen];
      VisibilityReport by_light =
          shadow_report(by_eye, shadows_of(v.config, *plan, picture, by_eye, options.engine));
      v.oracles.push_back(std::move(by_light));
    }
  }
}

// Of the engines of a verdict that have bands; digest: of the first engine's records.
void compare_in_bands(const VerifyOptions& options, const Scene& scene, const Engine& first,
                      const RecordDigest& digest, SceneVerdict& v) {
  std::vector<std::string> names;
  for (const std::string& name : options.engines) {
    const EngineEntry& entry = find_engine(name);
    if (!entry.compared || !entry.runs(v.config)) continue;
    if (entry.has_bands) {
      names.push_back(name);
    } else {
      v.left_out.push_back(fmt::format("{} left out of the bands: it draws whole pictures", name));
    }
  }
  Progress progress(scene.name + " in bands");
  for (const int rows : options.bands) {
    const int bands = number_of_bands(banded_plan(scene).height, rows);
    std::vector<std::unique_ptr<Engine>> engines;
    for (const std::string& name : names) engines.push_back(make_engine(name, v.config, options.engine));
    v.bands.push_back(compare_bands(
        std::move(engines), v.config, scene, rows, {first.frame(), first.counters(), digest},
        [&](int b) { progress.update(static_cast<std::size_t>(b) + 1, static_cast<std::size_t>(bands)); }));
  }
}

std::string error_number(double x) { return fmt::format("{:.4g}", x); }

// A design whose assertions fail at reset is a failed check and no internal error: null then, and the failure
// is told.
std::unique_ptr<Engine> make_guarded(const std::string& name, const Config& config,
                                     const VerifyOptions& options, SceneVerdict& v) {
  try {
    return make_engine(name, config, options.engine);
  } catch (const std::logic_error& error) {
    if (!find_engine(name).design) throw;
    v.failures.push_back(fmt::format("{} broke off: {}", name, error.what()));
    return nullptr;
  }
}

struct Total {
  StageCount count;
  std::uint64_t own = 0;  // of its values: by arithmetic of the other engine's own
};
// Adds up the stages, pictures and counters of pair p.
Total total_of(const SceneVerdict& v, std::size_t p) {
  const Comparison& pair = v.run.pairs[p];
  Total out{pair.total(), v.own[p].total()};
  out.count += pair.frame;
  out.count += pair.counters;
  if (v.resolved.empty()) return out;
  out.count += v.resolved[p].count;
  out.own += v.resolved[p].own;
  return out;
}

}  // namespace

bool SceneVerdict::compared() const {
  return (!run.pairs.empty() || has_true_oracle()) && counters.covered != 0 &&
         std::ranges::none_of(run.pairs, is_trivial);
}

bool SceneVerdict::has_true_oracle() const {
  return std::ranges::any_of(oracles, [](const VisibilityReport& r) { return r.is_truth && r.is_of_engine; });
}

std::string_view SceneVerdict::outcome() const {
  if (!held()) return "FAILED";
  if (!compared()) return "nothing was compared, as allowed";
  return not_reached.empty() ? "all held" : "all held but what no pixel reaches, as allowed";
}

bool needs_whole_scene(const VerifyOptions& options) {
  return !options.oracles.empty() || !options.bands.empty() ||
         std::ranges::any_of(options.engines, [](const std::string& name) {
           return name == "rtl" || !find_engine(name).compared;
         });
}

SceneRun verify_scene(const Config& config, SceneSource& source, const VerifyOptions& options,
                      const RunLabel& label) {
  const LoadedScene& loaded = source.loaded();
  const Scene& scene = loaded.scene;
  SceneRun out;
  SceneVerdict& v = out.verdict;
  v.scene = scene.name;
  v.config = config;
  v.label = label;
  v.faces = loaded.faces;
  if (loaded.draws_no_face() && !options.allow_empty) {
    // Whether the configuration takes such a scene is not the question.
    judge_emptiness(v, options);
    return out;
  }
  for (const int rows : options.bands) check_bands(rows, scene);
  // The first piece's range is looked at before an engine is built.
  const auto in_range = pieces_in_range(source, config);
  const Scene* first = in_range();
  const auto next = [&] { return first != nullptr ? std::exchange(first, nullptr) : in_range(); };
  bool systemc = false;
  bool rtl = false;
  for (const std::string& name : options.engines) {
    if (!engine_runs(name, config)) {
      v.left_out.push_back(fmt::format("{} left out: {}", name, engine_needs(name, config)));
      continue;
    }
    auto engine = make_guarded(name, config, options, v);
    if (engine == nullptr) continue;
    systemc = systemc || name == "systemc";
    rtl = rtl || name == "rtl";
    if (options.cycles && find_engine(name).users_design) {
      v.notes.push_back(
          fmt::format("clocks of {} are not compared: the timed model's are those of rtl", name));
    }
    if (!find_engine(name).compared) {
      out.ideal = std::move(engine);
    } else {
      out.engines.push_back(std::move(engine));
    }
  }
  if (out.engines.empty()) {
    throw InputError(
        "--engines: no engine left to compare; name at least one of golden, model, systemc, rtl");
  }
  ErrorMeter meter(config, scene);
  Progress progress(scene.name);
  LockStepOptions steps;
  steps.progress = [&](std::size_t done) { progress.update(done, scene.triangles.size()); };
  // The closed form of errors knows one view.
  const bool has_errors = out.ideal != nullptr && !changes_scene(scene.commands);
  RecordDigest digest;
  if (out.ideal) out.ideal->begin(scene);
  if (out.ideal || !options.bands.empty()) {
    steps.observe = [&](const Batch& batch, const Trace& trace) {
      if (!options.bands.empty()) digest.add(trace);
      if (!out.ideal) return;
      if (has_errors) meter.add(batch.triangles(), batch.first_index, trace);
      draw_batch(*out.ideal, batch, nullptr);
    };
  }
  v.run = run_lock_step(out.engines, scene, next, steps);
  if (std::ranges::any_of(v.run.pairs, [](const Comparison& pair) { return pair.first.has_value(); })) {
    const std::optional<Scene> whole = source.read_again();
    add_reads(v.run, config, whole ? *whole : scene);
  }
  for (const Comparison& pair : v.run.pairs) v.own.push_back(own_values(pair, config, scene));
  v.counters = out.engines[0]->counters();
  if (!v.run.pairs.empty() && !v.run.stopped && v.counters.covered != 0) {
    v.not_reached = stages_not_reached(v.run);
  }
  if (options.supersample > 1 && !v.run.stopped) {
    for (std::size_t e = 1; e < out.engines.size(); ++e) {
      v.resolved.push_back(compare_resolved(*out.engines[0], *out.engines[e], config, options.supersample));
    }
  }
  if (has_errors) {
    meter.add_pictures(out.engines[0]->frame(), out.ideal->frame());
    v.errors = meter.report();
    v.has_errors = true;
    if (options.supersample > 1 && !v.run.stopped) {
      v.resolved_psnr_db = resolved_psnr_db(*out.engines[0], *out.ideal, config, options.supersample);
    }
    v.truth_draws = v.errors.covered > 0;
  }
  if (options.cycles && systemc && rtl && !v.run.stopped) {
    v.cycles = compare_cycles(config, scene);
    v.chain = compare_chain(config, scene, options.engine.stall_seed);
  }
  if (!v.run.stopped) compare_oracles(options, scene, *out.engines[0], v);
  if (!options.bands.empty() && !v.run.stopped) {
    compare_in_bands(options, scene, *out.engines[0], digest, v);
  }
  judge_differences(v);
  judge_emptiness(v, options);
  return out;
}

std::vector<std::vector<std::string>> comparison_table(const SceneVerdict& verdict) {
  std::vector<std::vector<std::string>> rows{
      {"stage", "pair", "records", "values", "own", "non-trivial", "differences"}};
  const auto add = [&](std::string_view stage, const Comparison& pair, const StageCount& count,
                       std::uint64_t own) {
    rows.push_back({std::string(stage), fmt::format("{} = {}", pair.reference, pair.other),
                    number(count.records), number(count.values), number(own), number(count.non_trivial),
                    number(count.differences + count.unmatched)});
  };
  const std::vector<Comparison>& pairs = verdict.run.pairs;
  for (std::size_t t = 0; t < static_cast<std::size_t>(record_types); ++t) {
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const StageCount& count = pairs[p].stages[t];
      if (count.records != 0 || count.unmatched != 0) {
        add(stage_of(static_cast<RecordType>(t)), pairs[p], count, verdict.own[p].stages[t]);
      }
    }
  }
  for (std::size_t p = 0; p < pairs.size(); ++p)
    add("picture", pairs[p], pairs[p].frame, verdict.own[p].frame);
  for (std::size_t p = 0; p < verdict.resolved.size(); ++p) {
    const ResolvedComparison& resolved = verdict.resolved[p];
    add("resolve_samples", pairs[p], resolved.count, resolved.own);
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    add("counters", pairs[p], pairs[p].counters, verdict.own[p].counters);
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Total all = total_of(verdict, p);
    add("all", pairs[p], all.count, all.own);
  }
  return rows;
}

std::vector<std::vector<std::string>> error_table(const ErrorReport& errors) {
  std::vector<std::vector<std::string>> rows{{"stage", "error of", "unit", "values"}};
  for (const FieldStatistic& f : field_statistics()) {
    if (f.in_verdict) rows[0].emplace_back(f.label);
  }
  for (const ErrorRow& row : errors.rows) {
    if (row.stat.count == 0) {
      continue;
    }
    rows.push_back({row.stage, row.quantity, row.unit, number(row.stat.count)});
    for (const FieldStatistic& f : field_statistics()) {
      if (f.in_verdict) rows.back().push_back(error_number(f.value(row.stat)));
    }
  }
  return rows;
}

std::vector<std::string> verdict_lines(const SceneVerdict& v) {
  std::vector<std::string> lines;
  if (v.faces) lines.push_back(faces_text(*v.faces));
  const Counters& c = v.counters;
  lines.push_back(
      fmt::format("drawn: {} of {} triangles ({} without area), {} rows, {} fragments, {} covered, {} "
                  "passed the depth test, {} killed, {} written",
                  v.run.triangles_done, c.triangles, c.degenerate, c.rows, c.fragments, c.covered,
                  c.depth_passed, c.killed, c.written));
  lines.push_back(fmt::format("divides: {} edge, {} row, {} pixel, {} saved", c.divides_edge, c.divides_row,
                              c.divides_pixel, c.divides_saved));
  if (v.has_errors) {
    const ErrorReport& e = v.errors;
    lines.push_back(
        fmt::format("coverage against the exact test of {} pixel centres: {} differences ({} missed, {} "
                    "surplus, {} drawn twice)",
                    e.covered, e.coverage_differences(), e.missed, e.surplus, e.doubled));
    lines.push_back("picture against ideal: " + picture_words(e));
    if (v.resolved_psnr_db)
      lines.push_back("averaged picture against ideal: PSNR " + psnr_text(*v.resolved_psnr_db));
  }
  if (v.cycles) {
    const CycleVerdict& y = *v.cycles;
    lines.push_back(
        fmt::format("span interpolator, clock for clock: systemc {} cycles, rtl {} cycles; {} spans, {} "
                    "pixels, {} differences",
                    y.model_cycles, y.rtl_cycles, y.spans, y.pixels, y.differences));
  }
  for (const ChainVerdict& y : v.chain) {
    lines.push_back(
        fmt::format("chain from span_setup to merge, clock for clock, {}: systemc {} cycles, rtl {} cycles; "
                    "{} fragments, {} differences",
                    y.memory, y.model_cycles, y.rtl_cycles, y.fragments, y.differences));
  }
  for (const VisibilityReport& oracle : v.oracles) {
    lines.push_back("oracle " + visibility_text(oracle));
  }
  for (const BandReport& report : v.bands) {
    lines.push_back(fmt::format("{}, {}: {} records with hash {:016x}, {}", bands_name(report.rows),
                                fmt::join(report.engines, " = "), report.records, report.hash,
                                report.held() ? "all as of the whole picture" : "FAILED"));
  }
  for (const std::string& note : v.notes) {
    lines.push_back("note: " + note);
  }
  return lines;
}

std::string verdict_text(const SceneVerdict& v) {
  std::string out =
      fmt::format("scene {}, configuration {} ({})\n\n", v.scene, v.config.name, config_hash(v.config));
  if (!v.run.pairs.empty()) {
    out += text_table(comparison_table(v)) + "\n";
  }
  if (v.has_errors) {
    out += "error against ideal\n" + text_table(error_table(v.errors)) + "\n";
  }
  if (!v.bands.empty()) {
    out += fmt::format("in bands\n{}\n", bands_text(v.bands));
  }
  for (const std::string& line : verdict_lines(v)) {
    out += line + "\n";
  }
  for (const Comparison& pair : v.run.pairs) {
    if (pair.first) {
      out += "\n" + describe(*pair.first, v.config, v.label);
    }
  }
  out += "\n";
  for (const std::string& failure : v.failures) {
    out += "FAILED: " + failure + "\n";
  }
  if (v.held()) {
    out += fmt::format("{}: {}\n", v.scene, v.outcome());
  }
  return out;
}

void append_junit(const SceneVerdict& v, std::vector<JunitCase>& cases) {
  const std::string class_name = fmt::format("{}.{}", v.scene, v.config.name);
  for (const Comparison& pair : v.run.pairs) {
    const std::string details = pair.first ? describe(*pair.first, v.config, v.label) : "";
    const auto add = [&](std::string_view stage, const StageCount& count) {
      JunitCase one;
      one.class_name = class_name;
      one.name = fmt::format("{} {} = {}", stage, pair.reference, pair.other);
      if (count.differences + count.unmatched > 0) {
        const bool first_here = pair.first && pair.first->stage == stage;
        one.failure = first_here ? summary(*pair.first, v.config)
                                 : fmt::format("{} differences after the first divergence",
                                               count.differences + count.unmatched);
        one.details = details;
      }
      cases.push_back(std::move(one));
    };
    for (int t = 0; t < record_types; ++t) {
      const StageCount& count = pair.stages[static_cast<std::size_t>(t)];
      if (count.records != 0 || count.unmatched != 0) {
        add(stage_of(static_cast<RecordType>(t)), count);
      }
    }
    for (const std::string& stage : v.not_reached) {
      add(stage, {});
      cases.back().skipped = "no pixel reaches this stage";
    }
    add("frame", pair.frame);
    if (!v.resolved.empty()) {
      const ResolvedComparison& resolved = v.resolved[static_cast<std::size_t>(&pair - v.run.pairs.data())];
      add("resolve_samples", resolved.count);
      if (!resolved.first.empty()) cases.back().failure = resolved.first;
    }
    add("counters", pair.counters);
  }
  for (const std::string& text : v.left_out) {
    JunitCase one;
    one.class_name = class_name;
    one.name = text.substr(0, text.find(':'));
    one.skipped = text;
    cases.push_back(std::move(one));
  }
  for (const VisibilityReport& oracle : v.oracles) {
    JunitCase one;
    one.class_name = class_name;
    one.name = fmt::format("oracle {} = {}", oracle.oracle, oracle.engine);
    if (!oracle.held()) one.failure = fmt::format("{} {} are unexplained", oracle.unexplained, oracle.unit);
    if (!oracle.held()) one.details = visibility_text(oracle) + "\n" + oracle.first + "\n";
    cases.push_back(std::move(one));
  }
  for (const BandReport& report : v.bands) {
    JunitCase one;
    one.class_name = class_name;
    one.name = bands_name(report.rows);
    if (!report.held()) one.failure = report.failures.front();
    cases.push_back(std::move(one));
  }
  for (const std::string& text : v.oracles_left_out) {
    JunitCase one;
    one.class_name = class_name;
    one.name = text.substr(0, text.find(" left out:"));
    one.skipped = text;
    cases.push_back(std::move(one));
  }
  JunitCase verdict;
  verdict.class_name = class_name;
  verdict.name = "verdict";
  verdict.seconds = v.run.seconds;
  for (const std::string& failure : v.failures) {
    verdict.failure = verdict.failure.empty() ? failure : verdict.failure;
    verdict.details += failure + "\n";
  }
  if (v.held() && !v.compared()) verdict.skipped = v.outcome();
  cases.push_back(std::move(verdict));
}

namespace {

nlohmann::ordered_json bands_json(const BandReport& report) {
  return {{"rows", report.rows},
          {"bands", report.bands},
          {"held", report.held()},
          {"engines", report.engines},
          {"records", report.records},
          {"hash", fmt::format("{:016x}", report.hash)},
          {"bits_per_pixel",
           {{"depth", report.bits.depth},
            {"color", report.bits.color},
            {"stencil", report.bits.stencil},
            {"candidate", report.bits.candidate}}},
          {"bytes", report.bytes},
          {"set_up", report.work.set_up},
          {"set_up_again", report.work.set_up_again},
          {"set_up_unsorted", report.work.unsorted},
          {"rows_above", report.work.rows_above},
          {"fragments_again", report.work.fragments_again}};
}

}  // namespace

std::string verdict_json(std::span<const SceneVerdict> verdicts, const std::string& version) {
  using Json = nlohmann::ordered_json;
  const auto count_json = [](const StageCount& c, std::uint64_t own) {
    return Json{{"records", c.records},         {"values", c.values},           {"own", own},
                {"non_trivial", c.non_trivial}, {"differences", c.differences}, {"unmatched", c.unmatched}};
  };
  Json scenes = Json::array();
  bool held = true;
  for (const SceneVerdict& v : verdicts) {
    held = held && v.held();
    Json scene;
    scene["scene"] = v.scene;
    scene["configuration"] = {{"name", v.config.name}, {"hash", config_hash(v.config)}};
    scene["held"] = v.held();
    scene["compared"] = v.compared();
    scene["failures"] = v.failures;
    scene["notes"] = v.notes;
    scene["left_out"] = v.left_out;
    scene["not_reached"] = v.not_reached;
    scene["seconds"] = v.run.seconds;
    if (v.faces) {
      scene["faces"] = {{"read", v.faces->faces},
                        {"culled", v.faces->culled},
                        {"outside", v.faces->outside},
                        {"drawn", v.faces->drawn}};
    }
    for_each_counter([&](const CounterInfo& info, auto member) {
      if (info.compared) scene["counters"][std::string(info.name)] = v.counters.*member;
    });
    Json pairs = Json::array();
    for (std::size_t p = 0; p < v.run.pairs.size(); ++p) {
      const Comparison& pair = v.run.pairs[p];
      const OwnValues& own = v.own[p];
      Json one{{"reference", pair.reference}, {"other", pair.other}};
      for (int t = 0; t < record_types; ++t) {
        const StageCount& count = pair.stages[static_cast<std::size_t>(t)];
        if (count.records != 0 || count.unmatched != 0) {
          one["stages"][std::string(stage_of(static_cast<RecordType>(t)))] =
              count_json(count, own.stages[static_cast<std::size_t>(t)]);
        }
      }
      one["picture"] = count_json(pair.frame, own.frame);
      one["counters"] = count_json(pair.counters, own.counters);
      if (!v.resolved.empty()) {
        const ResolvedComparison& resolved = v.resolved[p];
        one["resolve_samples"] = count_json(resolved.count, resolved.own);
      }
      const Total all = total_of(v, p);
      one["all"] = count_json(all.count, all.own);
      if (!pair.fault.empty()) {
        one["fault"] = pair.fault;
      }
      if (pair.first) {
        one["first_divergence"] = {{"summary", summary(*pair.first, v.config)},
                                   {"text", describe(*pair.first, v.config, v.label)}};
      }
      pairs.push_back(std::move(one));
    }
    scene["pairs"] = std::move(pairs);
    if (v.has_errors) {
      Json rows = Json::array();
      for (const ErrorRow& row : v.errors.rows) {
        if (row.stat.count > 0) {
          Json one{{"stage", row.stage},
                   {"quantity", row.quantity},
                   {"unit", row.unit},
                   {"values", row.stat.count}};
          for (const FieldStatistic& f : field_statistics()) {
            if (f.in_verdict) one[std::string(f.name)] = f.value(row.stat);
          }
          rows.push_back(std::move(one));
        }
      }
      scene["errors"] = std::move(rows);
      scene["coverage"] = {{"covered", v.errors.covered},
                           {"missed", v.errors.missed},
                           {"surplus", v.errors.surplus},
                           {"doubled", v.errors.doubled}};
      // JSON has no infinity: equal pictures have a null here.
      for (const PictureMetric& metric : picture_metrics()) {
        if (const auto value = value_of(metric, v.errors)) {
          scene["picture"][std::string(metric.name.substr(metric.name.find('.') + 1))] = *value;
        }
      }
    }
    // As above: null where the pictures are equal.
    if (v.resolved_psnr_db) scene["resolve_samples"]["psnr_db"] = *v.resolved_psnr_db;
    if (v.cycles) {
      scene["cycles"] = {{"systemc", v.cycles->model_cycles},
                         {"rtl", v.cycles->rtl_cycles},
                         {"spans", v.cycles->spans},
                         {"pixels", v.cycles->pixels},
                         {"differences", v.cycles->differences}};
    }
    for (const ChainVerdict& y : v.chain) {
      scene["chain"].push_back({{"memory", y.memory},
                                {"systemc", y.model_cycles},
                                {"rtl", y.rtl_cycles},
                                {"fragments", y.fragments},
                                {"differences", y.differences}});
    }
    for (const VisibilityReport& oracle : v.oracles) {
      Json counts = Json::object();
      for (const OracleCount& count : oracle.counts) counts[std::string(count.name)] = count.value;
      scene["oracles"].push_back({{"oracle", oracle.oracle},
                                  {"engine", oracle.engine},
                                  {"unit", oracle.unit},
                                  {"truth", oracle.is_truth},
                                  {"equal", oracle.equal},
                                  {"ties", oracle.ties},
                                  {"edges", oracle.edges},
                                  {"unexplained", oracle.unexplained},
                                  {"left_out", oracle.left_out},
                                  {"background", oracle.background},
                                  {"first", oracle.first},
                                  {"counts", std::move(counts)}});
    }
    for (const BandReport& report : v.bands) {
      scene["bands"].push_back(bands_json(report));
    }
    if (!v.oracles_left_out.empty()) scene["oracles_left_out"] = v.oracles_left_out;
    scenes.push_back(std::move(scene));
  }
  Json json;
  json["bitspan"] = version;
  json["held"] = held;
  json["scenes"] = std::move(scenes);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace bitspan
