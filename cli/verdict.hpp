// SPDX-License-Identifier: Apache-2.0
// One scene through several engines: what `verify` and `demo` measure, and how it is told.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/own_values.hpp"
#include "cli/resolved.hpp"
#include "cli/scene_options.hpp"
#include "engine/registry.hpp"
#include "report/bands.hpp"
#include "report/compare.hpp"
#include "report/describe.hpp"
#include "report/error.hpp"
#include "report/junit.hpp"
#include "report/lockstep.hpp"
#include "report/visibility.hpp"
#include "scene/project.hpp"

namespace bitspan {

// The timed model's clocks of the span interpolator against the RTL's, its recorded handshake replayed.
struct CycleVerdict {
  std::uint64_t clocks = 0;  // replayed
  std::uint64_t spans = 0;   // accepted by both
  std::uint64_t pixels = 0;  // delivered by both
  std::uint64_t model_cycles = 0, rtl_cycles = 0;
  std::uint64_t differences = 0;  // clocks on which in_ready or out_valid differ, and values that differ
  std::string first;              // one line, empty without differences
};

// The timed model's clocks from span_setup to merge against the RTL's, with one memory behind the ports.
struct ChainVerdict {
  std::string memory;                              // in words
  std::uint64_t fragments = 0;                     // accepted by the pixel stages of both
  std::uint64_t model_cycles = 0, rtl_cycles = 0;  // to the last transfer on any port
  std::uint64_t differences = 0;                   // 1 where a clock differs: nothing is compared behind it
  std::string first;                               // one line, empty without differences
};

struct SceneVerdict {
  std::string scene;
  Config config;
  RunLabel label;
  LockStepResult run;
  std::vector<OwnValues> own;                // one per pair
  std::vector<ResolvedComparison> resolved;  // one per pair, where samples are averaged
  std::optional<double> resolved_psnr_db;    // of the first engine against ideal
  Counters counters;                         // of the first engine
  ErrorReport errors;
  bool has_errors = false;   // `ideal` took part
  bool truth_draws = false;  // by the exact test, some pixel is covered
  std::optional<CycleVerdict> cycles;
  std::vector<ChainVerdict> chain;            // one per memory
  std::vector<VisibilityReport> oracles;      // against the first engine; those of edges against rays
  std::vector<BandReport> bands;              // one per height
  std::optional<ProjectReport> faces;         // of a mesh
  std::vector<std::string> left_out;          // one line per engine that was asked for and does not run this
  std::vector<std::string> oracles_left_out;  // one line per oracle that does not draw this
  std::vector<std::string> not_reached;       // stages without a record although the scene covers pixels
  std::vector<std::string> notes;             // what was left out or empty, and is allowed to be
  std::vector<std::string> failures;          // one line each; empty: all held

  bool held() const { return failures.empty(); }
  // Whether there is a pair or an oracle of the truth that judges an engine, and every pair compared values
  // that are not trivial, of a scene that draws.
  bool compared() const;
  bool has_true_oracle() const;
  // "all held", "FAILED", or what --allow-missing or --allow-empty let pass without a comparison of all
  // stages.
  std::string_view outcome() const;
};

struct VerifyOptions {
  std::vector<std::string> engines;  // the first is the reference; `ideal` adds the error table
  bool engines_named = false;        // by the user: leaving one out is a failure
  bool allow_missing = false;        // an engine may be left out, and no pair may be left
  bool allow_empty = false;          // the scene may cover no pixel, and pixels may reach no merge
  bool cycles = true;
  std::vector<const Oracle*> oracles{};  // whose pictures the first engine's is compared with
  bool oracles_named = true;             // one by one, and not all: leaving one out is a failure
  std::vector<int> bands{};              // heights in rows, in which the scene is drawn, too
  int supersample = 1;                   // the scene has that many samples per pixel, each way
  EngineOptions engine;
};

// Errors are of pixels and the triangles behind them, clocks and oracles of all triangles at once, and bands
// are drawn one after the other.
bool needs_whole_scene(const VerifyOptions& options);

struct SceneRun {
  SceneVerdict verdict;
  std::vector<std::unique_ptr<Engine>> engines;  // those compared, their pictures still in them
  std::unique_ptr<Engine> ideal;                 // none where it took no part
};

// Whether the configuration promises the coverage of the exact test: edge_walk exact, or const_depth_rows.
bool coverage_is_exact(const Config& config);

// Runs and judges. Fails where a value differs, where the cycles do, and where coverage that is exact by
// configuration differs from the exact test. Fails where a pixel differs from an oracle's, unexplained, and
// where bands have another picture, records or counters than the whole. Fails too where the
// verdict would be empty: neither a pair of engines nor an oracle of the truth, an engine or an oracle named
// that does not run the configuration, a pair without non-trivial values, a scene that covers no pixel, a
// stage that no pixel reaches. Throws InputError for bad input.
// A source in pieces does where needs_whole_scene is false.
SceneRun verify_scene(const Config& config, SceneSource& source, const VerifyOptions& options,
                      const RunLabel& label);

// Rows for report/table: records, values, own, non-trivial, differences of each stage and pair.
std::vector<std::vector<std::string>> comparison_table(const SceneVerdict& verdict);
std::vector<std::vector<std::string>> error_table(const ErrorReport& errors);
// Lines under the tables: coverage, PSNR, order, cycles, counters, notes.
std::vector<std::string> verdict_lines(const SceneVerdict& verdict);
// All of it as text, with the first divergence of each pair in full.
std::string verdict_text(const SceneVerdict& verdict);
// One testcase per stage and pair, picture and counters included; one per engine left out, skipped; and one
// for the verdict.
void append_junit(const SceneVerdict& verdict, std::vector<JunitCase>& cases);
std::string verdict_json(std::span<const SceneVerdict> verdicts, const std::string& version);

}  // namespace bitspan
