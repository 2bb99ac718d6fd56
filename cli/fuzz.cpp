// SPDX-License-Identifier: Apache-2.0
// bitspan fuzz: random streams through random configurations, failures shrunk. bitspan replay: one of them
// again.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/cycles.hpp"
#include "cli/failing_case.hpp"
#include "cli/model_options.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "cli/verdict.hpp"
#include "config/rtl_timing.hpp"
#include "config/store.hpp"
#include "engine/range.hpp"
#include "engine/registry.hpp"
#include "golden/precision.hpp"
#include "io/atomic_file.hpp"
#include "io/data_folder.hpp"
#include "report/fuzz_cases.hpp"
#include "report/replay.hpp"
#include "tb/programs.hpp"

namespace bitspan {
namespace {

struct FuzzArguments {
  FuzzPlan plan;
  std::uint64_t first = 0;
  std::optional<std::uint64_t> count, pixels;
  std::string engines = "golden,model,systemc,rtl";
  bool engines_named = false;        // by the user: all of them take part in every case
  std::vector<std::string> configs;  // empty: random ones
  std::string out = ".";
  bool keep_going = false;
  ModelFlags model;
};

bool is_design(const std::string& engine) { return bool{find_engine(engine).design}; }

std::string reproduce(const FuzzArguments& o, std::uint64_t index) {
  std::string out = fmt::format("{}bitspan fuzz --seed {} --first {} --count 1 --streams-per-config {}{}",
                                command_environment(), o.plan.seed, index, o.plan.streams_per_config,
                                o.engines_named ? " --engines " + o.engines : "");
  for (const std::string& config : o.configs) {
    out += " --config " + shell_word(config);
  }
  return out + flags_text(o.model);
}

struct Totals {
  std::uint64_t cases = 0, refused = 0, empty = 0, configs = 0, with_designs = 0, failures = 0;
  std::uint64_t fragments = 0, values = 0, non_trivial = 0;  // compared
  std::uint64_t rtl_fragments = 0, cycles_compared = 0, chain_clocks_compared = 0;
  std::set<std::string> compared;  // engines, in values that are not trivial
};

std::string replay_path(const FuzzArguments& o, std::uint64_t index) {
  return fmt::format("{}/fuzz-{}-{}.replay.json", o.out, o.plan.seed, index);
}

class Fuzzer {
 public:
  explicit Fuzzer(const FuzzArguments& o)
      : o_(o),
        names_(engines_to_compare(o.model, o.engines, "fuzz", "fuzz")),
        engine_options_(engine_options(o.model, 1)) {
    if (o.plan.streams_per_config == 0) {
      throw InputError("--streams-per-config: expected 1 or more");
    }
    if (o.count == 0U) throw InputError("--count: expected 1 or more");
    if (o.pixels == 0U) throw InputError("--pixels: expected 1 or more");
    for (const std::string& name : o.configs) fixed_.push_back(find_config(name));
    // A design for one configuration is compared in that one.
    for (const std::string& engine : names_) {
      if (fixed_.empty() && find_engine(engine).only != nullptr) fixed_.push_back(*find_engine(engine).only);
    }
    for (const Config& config : fixed_) {
      for (const std::string& engine : names_) {
        if (o.engines_named && !engine_runs(engine, config)) {
          throw InputError(fmt::format("--engines: {}, which --config {} has not",
                                       engine_needs(engine, config), config.name));
        }
      }
    }
    const bool has_design = std::ranges::any_of(names_, is_design);
    // With --config, or where the user names them, the designs take part in each configuration.
    const bool in_all = o.engines_named || !fixed_.empty();
    o_.plan.designs = !has_design ? FuzzDesigns::none : in_all ? FuzzDesigns::all : FuzzDesigns::some;
    make_writable_folder(o.out);
    check_writable(replay_path(o, o.first));  // before the work, so that no failure is lost
    for (const ShippedConfig& shipped : config_texts()) {
      bases_.push_back(find_config(std::string(shipped.name)));
    }
  }

  int run() {
    const std::uint64_t count = o_.count.value_or(o_.pixels ? ~std::uint64_t{0} : o_.plan.cases);
    const auto start = std::chrono::steady_clock::now();
    Progress progress("fuzz");
    for (std::uint64_t n = 0; n < count; ++n) {
      if (o_.pixels && totals_.fragments >= *o_.pixels) {
        break;
      }
      one_case(o_.first + n);
      if (totals_.failures > 0 && !o_.keep_going) {
        break;
      }
      if (o_.pixels && !o_.count) {
        progress.update(totals_.fragments, *o_.pixels);
      } else {
        progress.update(n + 1, count);
      }
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Totals& t = totals_;
    fmt::print(
        "fuzz: seed {}, cases {}..{}, {} configurations{}, engines {}\n", o_.plan.seed, o_.first,
        o_.first + t.cases - 1, t.configs,
        t.with_designs > 0 && t.with_designs < t.configs ? fmt::format(" ({} with rtl)", t.with_designs) : "",
        o_.engines);
    fmt::print(
        "{} span pixels ({} through rtl), {} values compared, {} non-trivial, {} streams refused, {} empty, "
        "{:.1f} s\n",
        t.fragments, t.rtl_fragments, t.values, t.non_trivial, t.refused, t.empty, seconds);
    if (t.cycles_compared > 0) {
      fmt::print("{} clocks of the span interpolator equal in systemc and rtl\n", t.cycles_compared);
    }
    if (t.chain_clocks_compared > 0) {
      fmt::print("{} clocks of the chain from span_setup to merge equal in systemc and rtl\n",
                 t.chain_clocks_compared);
    }
    if (t.failures > 0) {
      fmt::print("{} failures\n", t.failures);
      return exit_difference;
    }
    bool missing = t.compared.empty();
    if (missing) fmt::print("FAILED: nothing non-trivial was compared\n");
    for (std::size_t i = 1; i < names_.size() && !t.compared.empty(); ++i) {
      if (t.compared.contains(names_[i])) continue;
      fmt::print("{}: {} took no part\n", o_.engines_named ? "FAILED" : "note", names_[i]);
      missing = missing || o_.engines_named;
    }
    if (missing) return exit_difference;
    fmt::print("0 differences\n");
    return exit_held;
  }

 private:
  void take_config(std::uint64_t group) {
    if (group_ == group) {
      return;
    }
    group_ = group;
    ++totals_.configs;
    const bool designs = fuzz_takes_designs(o_.plan, group);
    totals_.with_designs += designs ? 1 : 0;
    if (!fixed_.empty()) {
      config_ = fixed_[group % fixed_.size()];
    } else {
      config_ = fuzz_config(o_.plan, group, bases_, [this](const Config& config) {
        static_cast<void>(golden::choose_precision(config));
        // A form that the user names does not have every mode.
        if (!engine_options_.form.empty()) static_cast<void>(make_engine("model", config, engine_options_));
      });
    }
    std::vector<std::string> names = names_;
    if (!designs) std::erase_if(names, is_design);
    engines_.clear();
    try {
      engines_ =
          make_engines(names, config_, stall_seed(group * o_.plan.streams_per_config), engine_options_);
    } catch (const ToolError& error) {
      if (o_.engines_named) throw;
      throw ToolError(fmt::format("{}; --engines golden,model,systemc compares without RTL", error.what()));
    }
  }

  bool takes_part(std::string_view name) const {
    return std::ranges::any_of(engines_, [&](const auto& engine) { return engine->name() == name; });
  }

  void one_case(std::uint64_t index) {
    ++totals_.cases;
    take_config(index / o_.plan.streams_per_config);
    bool taken = false;
    for (int draw = 0; draw < fuzz_draws; ++draw) {
      const Scene scene = fuzz_scene(o_.plan, index, draw, config_);
      if (!refusal(engines_, config_, scene).empty()) continue;
      taken = true;
      const RunLabel label{scene.name, reproduce(o_, index)};
      const CaseResult result = check_case(engines_, config_, scene, label);
      if (result.failure.empty() && result.covered == 0) continue;
      count_case(index, scene, result, label);
      return;
    }
    ++(taken ? totals_.empty : totals_.refused);
  }

  std::uint64_t stall_seed(std::uint64_t index) const {
    return fuzz_seed(o_.plan.seed, index / o_.plan.streams_per_config, 0);
  }

  void count_case(std::uint64_t index, const Scene& scene, CaseResult result, const RunLabel& label) {
    totals_.compared.insert(result.compared.begin(), result.compared.end());
    totals_.fragments += result.fragments;
    totals_.values += result.values;
    totals_.non_trivial += result.non_trivial;
    if (takes_part("rtl")) {
      totals_.rtl_fragments += result.fragments;
    }
    bool in_cycles = false;
    if (result.failure.empty() && takes_part("rtl") && takes_part("systemc") &&
        index % o_.plan.streams_per_config == 0) {
      const ClockCheck clocks = check_clocks(config_, scene, stall_seed(index));
      totals_.cycles_compared += clocks.interpolator_clocks;
      totals_.chain_clocks_compared += clocks.chain_clocks;
      if (!clocks.failure.empty()) {
        result.failure = clocks.failure;
        result.details = result.failure + "\n";
        in_cycles = true;
      }
    }
    if (!result.failure.empty()) {
      fail(index, scene, result, label, in_cycles);
    }
  }

  void fail(std::uint64_t index, const Scene& scene, const CaseResult& result, const RunLabel& label,
            bool in_cycles) {
    ++totals_.failures;
    fmt::print("case {} (configuration {}, {}): {}\n{}", index, config_.name, config_hash(config_),
               result.failure, result.details);
    const Scene shown = in_cycles ? scene : shrink(engines_, config_, scene, label);
    const std::string path = replay_path(o_, index);
    write_replay(path, engines_, config_, shown, stall_seed(index),
                 fmt::format("{}; {}", label.command, result.failure));
    fmt::print("shrunk from {} to {} triangles; again: {}bitspan replay {}\n", scene.triangles.size(),
               shown.triangles.size(), command_environment(), shell_word(path));
    std::fflush(stdout);
  }

  FuzzArguments o_;
  std::vector<std::string> names_;
  EngineOptions engine_options_;
  std::vector<Config> fixed_, bases_;
  Totals totals_;
  std::uint64_t group_ = ~std::uint64_t{0};
  Config config_;
  Engines engines_;
};

struct ReplayOptions {
  std::string file;
  std::string engines;
  bool changed_rtl = false;
  ModelFlags model;
};

// What is under test must be what failed, unless the user wants to know whether a change mended it. Returns
// ", RTL HASH" for the designs that take part.
std::string check_designs(const ReplayOptions& o, const Replay& r, const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) {
    const EngineEntry& entry = find_engine(name);
    if (!entry.design) continue;
    const std::string hash = entry.design(r.config);
    const std::string what = entry.users_design ? name : "RTL";
    const auto recorded = r.designs.find(name);
    const bool found_with = std::ranges::count(r.engines, name) != 0;
    if (recorded == r.designs.end() && found_with && entry.users_design) {
      throw InputError(fmt::format("{}: no hash of {}, with which it was found; expected one in \"designs\"",
                                   o.file, name));
    }
    if (!o.changed_rtl && recorded != r.designs.end() && recorded->second != hash) {
      throw InputError(fmt::format(
          "{}: found with {} {}, but {} {}; {}--changed-rtl runs it anyway", o.file, what, recorded->second,
          entry.users_design ? "its sources have" : (data_folder() / "rtl").string() + " has RTL", hash,
          entry.users_design ? "" : "BITSPAN_ROOT names another folder, "));
    }
    out += fmt::format(", {} {}", what, hash);
  }
  return out;
}

int replay(const ReplayOptions& o) {
  const Replay r = read_replay(o.file);
  std::string list = o.engines;
  if (list.empty()) {
    for (const std::string& name : r.engines) {
      list += (list.empty() ? "" : ",") + name;
    }
  }
  const std::vector<std::string> names = parse_engines(list);
  refuse_without_model(o.model, std::ranges::count(names, "model") != 0);
  for (const std::string& name : names) {
    if (!engine_runs(name, r.config)) {
      throw InputError(fmt::format("{}: {}", o.file, engine_needs(name, r.config)));
    }
  }
  if (names.size() < 2) throw InputError(fmt::format("{}: fewer than two engines to compare", o.file));
  const bool with_rtl = std::ranges::count(names, "rtl") != 0;
  const std::string designs = check_designs(o, r, names);
  const Engines engines = make_engines(names, r.config, r.stall_seed, engine_options(o.model, 1));
  check_scene_range(r.config, r.scene);
  const RunLabel label{o.file,
                       fmt::format("{}bitspan replay {}{}{}", command_environment(), shell_word(o.file),
                                   o.changed_rtl ? " --changed-rtl" : "", flags_text(o.model))};
  CaseResult result = check_case(engines, r.config, r.scene, label);
  if (result.failure.empty() && with_rtl && std::ranges::count(names, "systemc") != 0) {
    result.failure = check_clocks(r.config, r.scene, r.stall_seed).failure;
    if (!result.failure.empty()) result.details = result.failure + "\n";
  }
  fmt::print("{}: {} triangles, configuration {} ({}), engines {}{}\n", o.file, r.scene.triangles.size(),
             r.config.name, config_hash(r.config), list, designs);
  if (!result.failure.empty()) {
    fmt::print("{}still fails\n", result.details);
    return exit_difference;
  }
  fmt::print("{} span pixels, {} values compared, {} non-trivial: ", result.fragments, result.values,
             result.non_trivial);
  if (result.covered == 0 || result.compared.size() + 1 < engines.size()) {
    fmt::print("FAILED, this says nothing: {}\n", result.covered == 0
                                                      ? "the scene covers no pixel centre"
                                                      : "a pair compared nothing non-trivial");
    return exit_difference;
  }
  for (const auto& [name, hash] : r.designs) {
    if (std::ranges::count(names, name) != 0) continue;
    fmt::print("FAILED, this says nothing: {}, with which it was found, did not run\n", name);
    return exit_difference;
  }
  fmt::print("no longer fails\n");
  return exit_held;
}

}  // namespace

void add_fuzz(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("fuzz", "random streams through random configurations, failures shrunk");
  const auto o = std::make_shared<FuzzArguments>();
  sub->add_option("--seed", o->plan.seed, "every case is made from (seed, index) alone")
      ->capture_default_str();
  sub->add_option("--first", o->first, "index of the first case")->capture_default_str();
  sub->add_option("--count", o->count, fmt::format("cases (default {}, or until --pixels)", o->plan.cases));
  sub->add_option("--pixels", o->pixels, "stop when so many span pixels were compared");
  sub->add_option("--streams-per-config", o->plan.streams_per_config, "cases that share a configuration")
      ->capture_default_str();
  sub->add_option("--engines", o->engines,
                  "compared with the first; where named, all of them take part in each configuration, else "
                  "rtl in one of 4, "
                  "16 of which share a build")
      ->capture_default_str();
  sub->add_option("--config", o->configs, "these configurations in turn, instead of random ones");
  sub->add_option("-o,--output", o->out, "folder for the replay files")->capture_default_str();
  sub->add_flag("--keep-going", o->keep_going, "do not stop at the first failure");
  add_model_options(*sub, o->model, "1");
  sub->footer(help_footer("0 differences", "a difference, or nothing compared",
                          "bitspan fuzz --seed 7 --pixels 1000000 --engines golden,model"));
  sub->callback([o, sub, &action] {
    o->engines_named = sub->count("--engines") > 0;
    action = [o] { return Fuzzer(*o).run(); };
  });
}

void add_replay(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("replay", "run a failure of fuzz again: exit 1 while it fails");
  const auto o = std::make_shared<ReplayOptions>();
  sub->add_option("file", o->file, "a .replay.json file")->required();
  sub->add_option("--engines", o->engines, "instead of the file's");
  add_model_options(*sub, o->model, "1");
  sub->add_flag("--changed-rtl", o->changed_rtl,
                "run it though the RTL, or the design of dut:NAME, is not the one that failed");
  sub->footer(help_footer("it no longer fails", "it fails, or nothing was compared",
                          "bitspan replay fuzz-7-12.replay.json"));
  sub->callback([o, &action] { action = [o] { return replay(*o); }; });
}

}  // namespace bitspan
