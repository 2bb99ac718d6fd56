// SPDX-License-Identifier: Apache-2.0
// bitspan verify: engines over scenes, every record.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/bands.hpp"
#include "cli/commands.hpp"
#include "cli/model_options.hpp"
#include "cli/scene_options.hpp"
#include "cli/suites.hpp"
#include "cli/verdict.hpp"
#include "config/store.hpp"
#include "engine/registry.hpp"
#include "golden/oracle.hpp"
#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

struct VerifyArguments {
  std::vector<std::string> scenes;
  std::string config{default_config};
  std::string engines = "golden,model,systemc,rtl,ideal";
  std::string junit, json;
  std::string suite, out = ".";
  std::string oracles, oracle_maps;
  std::string bands;
  bool list = false;
  std::uint64_t seed = 1;
  bool engines_named = false;  // by the user
  bool allow_missing = false;
  bool no_cycles = false;
  ModelFlags model;
  SceneOptions view;
};

void write_maps(const std::string& folder, const SceneVerdict& verdict) {
  if (folder.empty()) return;
  std::string name = std::filesystem::path(verdict.scene).generic_string();
  std::ranges::replace(name, '/', '-');
  for (const VisibilityReport& oracle : verdict.oracles) {
    const std::string path =
        (std::filesystem::path(folder) / fmt::format("{}-{}.png", name, oracle.oracle)).string();
    write_visibility_map(path, oracle);
    fmt::print("map: {}\n", path);
  }
}

int verify(const VerifyArguments& o) {
  const Config config = with_lines(find_config(o.config), o.view);
  VerifyOptions options;
  options.engines = parse_engines(o.engines);
  options.cycles = !o.no_cycles;
  options.engines_named = o.engines_named;
  options.allow_missing = o.allow_missing;
  options.allow_empty = o.view.allow_empty;
  options.supersample = o.view.supersample;
  refuse_without_model(o.model, std::ranges::count(options.engines, "model") != 0);
  if (!o.oracles.empty()) options.oracles = parse_oracles(o.oracles);
  options.oracles_named = o.oracles != "all";
  if (!o.bands.empty()) {
    options.bands = parse_bands(o.bands);
    const bool any = std::ranges::any_of(options.engines,
                                         [](const std::string& name) { return find_engine(name).has_bands; });
    if (!any) throw InputError("--bands: no engine of --engines draws bands; expected golden or model");
  }
  if (!o.oracle_maps.empty()) {
    if (options.oracles.empty()) throw InputError("--oracle-maps: goes with --oracles");
    make_writable_folder(o.oracle_maps);
  }
  check_writable(o.junit);
  check_writable(o.json);
  options.engine = engine_options(o.model, 1);
  options.engine.stall_seed = o.seed;
  std::vector<SceneVerdict> verdicts;
  bool held = true;
  for (const std::string& name : o.scenes) {
    for (SceneSource& source : open_scenes(name, seen_with(config, o.view), needs_whole_scene(options))) {
      const std::string& scene = source.scene().name;
      const RunLabel label{
          scene, fmt::format("{}bitspan verify {} --config {}{}{} --seed {}{}{}{}{}", command_environment(),
                             shell_word(scene), shell_word(o.config),
                             o.engines_named ? " --engines " + o.engines : "",
                             (o.oracles.empty() ? "" : " --oracles " + o.oracles) +
                                 (o.bands.empty() ? "" : " --bands " + o.bands),
                             o.seed, o.allow_missing ? " --allow-missing" : "",
                             o.no_cycles ? " --no-cycles" : "", flags_text(o.model), flags_text(o.view))};
      SceneRun run = verify_scene(config, source, options, label);
      fmt::print("{}{}", verdicts.empty() ? "" : "\n", verdict_text(run.verdict));
      std::fflush(stdout);
      held = held && run.verdict.held();
      write_maps(o.oracle_maps, run.verdict);
      verdicts.push_back(std::move(run.verdict));
    }
  }
  if (!o.junit.empty()) {
    std::vector<JunitCase> cases;
    for (const SceneVerdict& verdict : verdicts) {
      append_junit(verdict, cases);
    }
    write_file(o.junit, junit_xml("bitspan verify", cases));
  }
  if (!o.json.empty()) {
    write_file(o.json, verdict_json(verdicts, BITSPAN_VERSION));
  }
  return held ? exit_held : exit_difference;
}

// A suite makes its own configuration and scene, so what says others is refused.
void check_flags(const CLI::App& sub, bool suites) {
  const std::set<std::string> for_both{"help", "engines", "junit",  "json",
                                       "seed", "form",    "target", "threads"};
  const std::set<std::string> for_suites{"suite", "list", "output"};
  for (const CLI::Option* option : sub.get_options()) {
    const std::string name = option->get_single_name();
    if (option->count() == 0 || for_both.contains(name)) continue;
    if (suites && !for_suites.contains(name)) {
      throw InputError(
          fmt::format("--suite: makes its own configuration and scene; leave out {}", option->get_name()));
    }
    if (!suites && for_suites.contains(name)) {
      throw InputError(fmt::format("{}: goes with --suite", option->get_name()));
    }
  }
  if (!suites && sub.count("scene") == 0) throw InputError("scene is required, or --suite GLOB");
}

int run_suites(const VerifyArguments& o) {
  SuiteFlags flags;
  flags.pattern = o.suite;
  flags.list = o.list;
  if (o.engines_named) flags.engines = o.engines;
  flags.engines_named = o.engines_named;
  flags.seed = o.seed;
  flags.junit = o.junit;
  flags.json = o.json;
  flags.out = o.out;
  flags.model = o.model;
  return verify_suites(flags);
}

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("verify", "compare engines over scenes, every record of every stage");
  const auto o = std::make_shared<VerifyArguments>();
  sub->add_option("scene", o->scenes, "streams (.tri, .trib), meshes, demo, extreme or extreme/NAME");
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--engines", o->engines, "compared with the first; ideal adds the error table")
      ->capture_default_str();
  std::string known;
  for (const Oracle* oracle : parse_oracles("all")) {
    known += fmt::format("; {}: {}", oracle->name, oracle->meaning);
  }
  sub->add_option("--oracles", o->oracles,
                  "compare the first engine's picture with these, by the proved bounds: all that fit the "
                  "scene, or names" +
                      known);
  sub->add_option("--oracle-maps", o->oracle_maps,
                  "with --oracles: folder for a map per oracle: equal, tie, unexplained");
  sub->add_option(
         "--bands", o->bands,
         "draw the scene in bands of so many rows, too, by golden and model: N, or N,N...; each must "
         "have the records, picture and counters of the whole")
      ->type_name("ROWS");
  sub->add_option("--junit", o->junit, "write JUnit XML");
  sub->add_option("--json", o->json, "write the verdict as JSON");
  sub->add_option("--seed", o->seed, "of the random stalls of rtl, and of the streams of suites")
      ->capture_default_str();
  sub->add_option("--suite", o->suite,
                  "instead of scenes: the named suites that this pattern matches, as 'depth.*/delta_f/*'; "
                  "engines are golden,model where none is named");
  sub->add_flag("--list", o->list, "with --suite: print their names and run none");
  sub->add_option("-o,--output", o->out, "with --suite: folder for the replay files")->capture_default_str();
  sub->add_flag("--no-cycles", o->no_cycles, "leave out the cycle comparison of systemc and rtl");
  sub->add_flag("--allow-missing", o->allow_missing,
                "an engine of --engines may be left out, and no pair may be left to compare");
  add_model_options(*sub, o->model, "1");
  add_scene_options(*sub, o->view);
  add_supersample(*sub, o->view);
  sub->footer(
      help_footer("all held",
                  "a difference, a pixel unexplained, nothing compared, an engine or oracle named left out, "
                  "or nothing drawn",
                  "bitspan verify model.obj --texture skin.png --config depth20 --junit result.xml\n"
                  "  bitspan verify --suite 'depth.*/delta_f/64x48'\n"
                  "  bitspan verify --suite '*' --list\n"
                  "  bitspan verify spot.obj --oracles all --oracle-maps maps\n"
                  "  bitspan verify demo --engines golden,model --bands 480,16,1\n"
                  "  bitspan verify floor --size 64x48 --supersample 4 --engines golden,model"));
  sub->callback([o, sub, &action] {
    o->engines_named = sub->count("--engines") > 0;
    action = [o, sub] {
      const bool suites = sub->count("--suite") > 0;
      check_flags(*sub, suites);
      return suites ? run_suites(*o) : verify(*o);
    };
  });
}

}  // namespace bitspan
