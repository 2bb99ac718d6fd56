// One scene through several engines: what `verify` and `demo` measure, and how it is told.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/registry.hpp"
#include "report/compare.hpp"
#include "report/error.hpp"
#include "report/junit.hpp"
#include "report/lockstep.hpp"

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

struct SceneVerdict {
  std::string scene;
  Config config;
  RunLabel label;
  LockStepResult run;
  Counters counters;  // of the first engine
  ErrorReport errors;
  bool has_errors = false;   // `ideal` took part
  bool truth_draws = false;  // by the exact test, some pixel is covered
  std::optional<CycleVerdict> cycles;
  std::vector<std::string> notes;     // what was left out and why
  std::vector<std::string> failures;  // one line each; empty: all held

  bool held() const { return failures.empty(); }
};

struct VerifyOptions {
  std::vector<std::string> engines;  // the first is the reference; `ideal` adds the error table
  bool cycles = true;
  EngineOptions engine;
};

struct SceneRun {
  SceneVerdict verdict;
  std::vector<std::unique_ptr<Engine>> engines;  // those compared, their pictures still in them
  std::unique_ptr<Engine> ideal;                 // none where it took no part
};

// Whether the configuration promises the coverage of the exact test: edge_walk exact, or const_depth_rows.
bool coverage_is_exact(const Config& config);

// Runs and judges. Fails where a value differs, where the cycles do, where nothing non-trivial was compared
// though the scene draws, and where coverage that is exact by configuration differs from the exact test.
// Engines that do not run the configuration are left out with a note. Throws InputError for bad input.
SceneRun verify_scene(const Config& config, const Scene& scene, const VerifyOptions& options,
                      const RunLabel& label);

// Rows for report/table: records, values, non-trivial, differences of each stage and pair.
std::vector<std::vector<std::string>> comparison_table(const SceneVerdict& verdict);
std::vector<std::vector<std::string>> error_table(const ErrorReport& errors);
// Lines under the tables: coverage, PSNR, order, cycles, counters, notes.
std::vector<std::string> verdict_lines(const SceneVerdict& verdict);
// All of it as text, with the first divergence of each pair in full.
std::string verdict_text(const SceneVerdict& verdict);
// A testcase each stage and pair, and one each for the picture, the counters, the cycles and the bounds.
void append_junit(const SceneVerdict& verdict, std::vector<JunitCase>& cases);
std::string verdict_json(std::span<const SceneVerdict> verdicts, const std::string& version);

}  // namespace bitspan
