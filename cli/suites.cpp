// SPDX-License-Identifier: Apache-2.0
#include "cli/suites.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "cli/commands.hpp"
#include "cli/failing_case.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "io/atomic_file.hpp"
#include "report/junit.hpp"
#include "report/suites.hpp"

namespace bitspan {
namespace {

struct Outcome {
  SuiteRun run;
  std::string failure;  // one line, empty where the suite held
  std::string details;
  double seconds = 0;
};

std::string command_of(const SuiteFlags& o, const std::string& pattern) {
  return fmt::format("{}bitspan verify --suite '{}'{}{}{}", command_environment(), pattern,
                     o.seed != 1 ? fmt::format(" --seed {}", o.seed) : "",
                     o.engines_named ? " --engines " + o.engines : "", flags_text(o.model));
}

std::string replay_path(const SuiteFlags& o, std::string name) {
  std::ranges::replace(name, '/', '-');
  return fmt::format("{}/suite-{}.replay.json", o.out, name);
}

class Suites {
 public:
  explicit Suites(const SuiteFlags& o)
      : o_(o), names_(engines_to_compare(o.model, o.engines, "suites", "a suite")) {
    options_ = engine_options(o.model, 1);
    options_.stall_seed = o.seed;
    engines_.all = [this](const Config& config) { return make_engines(names_, config, o_.seed, options_); };
    engines_.reference = [this](const Config& config) { return make_engine(names_[0], config, options_); };
  }

  Outcome run(const std::string& name) {
    const auto start = std::chrono::steady_clock::now();
    Outcome out;
    if (const Config config = make_suite(name, o_.seed, 0).config; !engine_runs(names_[0], config)) {
      out.run.suite.name = name;
      out.failure = engine_needs(names_[0], config);
      return out;
    }
    out.run = run_named_suite(name, o_.seed, engines_);
    const SuiteResult& result = out.run.result;
    const Config& config = out.run.suite.config;
    add_reads(out.run.result.run, config, out.run.suite.scene);
    for (const Comparison& pair : result.run.pairs) {
      took_part_.insert(pair.other);
      if (pair.held() || !out.failure.empty()) continue;
      const RunLabel label{name, command_of(o_, name)};
      const PairFailure failure = failure_of(pair, config, label);
      out.failure = failure.line;
      out.details = failure.details + keep(out.run.suite, label, failure.line);
    }
    if (out.failure.empty() && !result.trivial.empty()) out.failure = "it shows nothing: " + result.trivial;
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return out;
  }

  // The engines that no suite was compared with.
  std::vector<std::string> missing() const {
    std::vector<std::string> out;
    for (std::size_t i = 1; i < names_.size(); ++i) {
      if (!took_part_.contains(names_[i])) out.push_back(names_[i]);
    }
    return out;
  }

 private:
  // Writes the replay file; returns the line that tells of it.
  std::string keep(const SuiteCase& suite, const RunLabel& label, const std::string& failure) {
    const Engines engines = engines_.all(suite.config);
    const Scene shown = shrink(engines, suite.config, suite.scene, label);
    const std::string path = replay_path(o_, suite.name);
    write_replay(path, engines, suite.config, shown, o_.seed, fmt::format("{}; {}", label.command, failure));
    return fmt::format("shrunk from {} to {} triangles; again: {}bitspan replay {}\n",
                       suite.scene.triangles.size(), shown.triangles.size(), command_environment(),
                       shell_word(path));
  }

  const SuiteFlags& o_;
  std::vector<std::string> names_;
  EngineOptions options_;
  SuiteEngines engines_;
  std::set<std::string> took_part_;
};

std::string line_of(const Outcome& outcome, std::size_t width) {
  const SuiteResult& r = outcome.run.result;
  return fmt::format("{:<{}}  {:>9}  {:>11}  {:>8}  {:>11}  {:<16}  {}\n", outcome.run.suite.name, width,
                     r.values(), r.non_trivial(), r.effect, r.differences(), r.digest,
                     outcome.failure.empty() ? "held" : "FAILED");
}

std::string json_of(const SuiteFlags& o, const std::vector<Outcome>& outcomes, bool held) {
  using Json = nlohmann::ordered_json;
  Json suites = Json::array();
  for (const Outcome& outcome : outcomes) {
    const SuiteResult& r = outcome.run.result;
    suites.push_back({{"suite", outcome.run.suite.name},
                      {"configuration", config_hash(outcome.run.suite.config)},
                      {"values", r.values()},
                      {"non_trivial", r.non_trivial()},
                      {"effect", r.effect},
                      {"differences", r.differences()},
                      {"digest", r.digest},
                      {"failure", outcome.failure},
                      {"seconds", outcome.seconds}});
  }
  return Json{{"version", BITSPAN_VERSION},
              {"seed", o.seed},
              {"engines", o.engines},
              {"held", held},
              {"suites", suites}}
             .dump(2) +
         "\n";
}

}  // namespace

int verify_suites(const SuiteFlags& o) {
  const std::vector<std::string> names = matching_suites(o.pattern);
  if (names.empty()) {
    throw InputError(fmt::format("--suite {}: matches none of {} suites, which --suite '*' --list shows",
                                 o.pattern, suite_names().size()));
  }
  if (o.list) {
    for (const std::string& name : names) fmt::print("{}\n", name);
    return exit_held;
  }
  Suites suites(o);
  check_writable(o.junit);
  check_writable(o.json);
  make_writable_folder(o.out);
  check_writable(replay_path(o, names[0]));  // before the work, so that no failure is lost
  const std::size_t width = std::ranges::max(names, {}, &std::string::size).size();
  const auto start = std::chrono::steady_clock::now();
  std::optional<Progress> progress;  // the lines are it, where they are seen
  if (::isatty(STDOUT_FILENO) == 0) progress.emplace("suites");
  std::vector<Outcome> outcomes;
  std::vector<JunitCase> cases;
  std::uint64_t values = 0, non_trivial = 0, differences = 0;
  std::size_t failed = 0;
  fmt::print("{:<{}}  {:>9}  {:>11}  {:>8}  {:>11}  {:<16}\n", "suite", width, "values", "non-trivial",
             "effect", "differences", "digest");
  for (const std::string& name : names) {
    Outcome outcome = suites.run(name);
    values += outcome.run.result.values();
    non_trivial += outcome.run.result.non_trivial();
    differences += outcome.run.result.differences();
    fmt::print("{}", line_of(outcome, width));
    if (!outcome.failure.empty()) {
      ++failed;
      fmt::print("  {}\n{}  again: {}\n", outcome.failure, outcome.details, command_of(o, name));
    }
    std::fflush(stdout);
    JunitCase one;
    one.class_name = name.substr(0, name.find('/'));
    one.name = name;
    one.seconds = outcome.seconds;
    one.failure = outcome.failure;
    one.details = outcome.details;
    cases.push_back(std::move(one));
    outcomes.push_back(std::move(outcome));
    if (progress) progress->update(outcomes.size(), names.size());
  }
  progress.reset();
  fmt::print(
      "{} of {} suites, engines {}, seed {}: {} failed; {} values compared, {} non-trivial, {} differences, "
      "{:.1f} s\n",
      names.size(), suite_names().size(), o.engines, o.seed, failed, values, non_trivial, differences,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  bool held = failed == 0;
  for (const std::string& engine : suites.missing()) {
    fmt::print("FAILED: {} took no part\n", engine);
    held = false;
  }
  if (!o.junit.empty()) write_file(o.junit, junit_xml("bitspan verify --suite", cases));
  if (!o.json.empty()) write_file(o.json, json_of(o, outcomes, held));
  return held ? exit_held : exit_difference;
}

}  // namespace bitspan
