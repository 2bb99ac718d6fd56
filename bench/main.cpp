// SPDX-License-Identifier: Apache-2.0
// bitspan_bench measures everything as ratios against something run in turn with it; docs/benchmarks.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <system_error>

#include "bench/mesa_process.hpp"
#include "bench/report.hpp"
#include "bench/scenes.hpp"
#include "config/config.hpp"
#include "io/atomic_file.hpp"
#include "io/leftovers.hpp"
#include "io/message.hpp"

namespace bitspan::bench {
namespace {

constexpr int exit_sound = 0, exit_wrong_picture = 1, exit_input = 2;

struct Arguments {
  Options options;
  bool quick = false, growth = false, long_growth = false, markdown = false;
  int rounds = 0;
  std::string json;
};

int run_growth(const Arguments& a) {
  const Growth growth = bench_growth(a.long_growth ? 1e9 : 1e8, a.long_growth ? 1e7 : 1e6);
  fmt::print("{}\n\n{}", machine(), growth.text);
  if (!a.json.empty()) {
    write_file(a.json, growth.json);
  }
  return exit_sound;
}

int run_all(const Arguments& a, const std::vector<std::string>& sections) {
  Report report;
  fmt::print("{}\n", machine());
  for (const std::string& section : sections) {
    if (!a.options.wants(section)) {
      continue;
    }
    const std::size_t from = report.series.size();
    const std::size_t first_note = report.notes.size();
    if (section == "kernels") {
      bench_kernels(a.options, report);
    } else if (section == "engines") {
      bench_engines(a.options, report);
    } else if (section == "interface") {
      bench_interface(a.options, report);
    } else if (section == "state") {
      bench_state(a.options, report);
    } else {
      bench_frames(section == "mesh" ? a.options.mesh : section, a.options, report);
    }
    fmt::print("\n{}", series_table(report.since(from)));
    for (std::size_t i = first_note; i < report.notes.size(); ++i) {
      fmt::print("{}\n", report.notes[i]);
    }
    std::fflush(stdout);
  }
  for (const bool asked : {true, false}) {
    if (const std::string table = goal_table(report.goals, asked, a.markdown); !table.empty()) {
      fmt::print("\n{}\n{}{}", asked ? "What it must reach:" : "Beside it:", a.markdown ? "\n" : "", table);
    }
  }
  if (!a.json.empty()) {
    write_file(a.json, to_json(report.since(0), report.goals, report.notes));
  }
  if (!report.sound) {
    bitspan::say("bitspan_bench: pictures or records that must agree do not; the ratios mean nothing\n");
    return exit_wrong_picture;
  }
  return exit_sound;
}

int run(int argc, char** argv) {
  Arguments a;
  CLI::App app("Benchmarks, as ratios against something run in turn with it");
  app.add_flag("--quick", a.quick, "few rounds: minutes become seconds, and spreads wide");
  app.add_option("--rounds", a.rounds, "samples of each (default 11, quick 3)")->check(CLI::Range(1, 1000));
  app.add_option("--only", a.options.only,
                 "sections: kernels, big, medium, small, big-back, medium-back, small-back, big-mip, "
                 "big-blend, big-shadow, big-phong, state, "
                 "demo or mesh, engines, interface")
      ->delimiter(',');
  app.add_option("--mesh", a.options.mesh, "draw this mesh in place of the embedded demo");
  app.add_option("--texture", a.options.texture, "mesh: a PNG for every face");
  app.add_option("--json", a.json, "write everything measured");
  app.add_flag("--markdown", a.markdown, "the tables of ratios as Markdown");
  app.add_flag("--growth", a.growth, "time and memory against pixels (to 10^8) and triangles (to 10^6)");
  app.add_flag("--long", a.long_growth, "with --growth: to 10^9 pixels and 10^7 triangles");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? exit_sound : exit_input;
  }
  a.options.rounds = a.rounds > 0 ? a.rounds : a.quick ? 3 : 11;
  a.options.kernel_time = a.quick ? 0.02 : 0.1;
  std::vector<std::string> sections{"kernels",   "big",         "medium",     "small",
                                    "big-back",  "medium-back", "small-back", "big-mip",
                                    "big-blend", "big-shadow",  "big-phong",  "state"};
  sections.push_back(a.options.mesh.empty() ? "demo" : "mesh");
  sections.insert(sections.end(), {"engines", "interface"});
  for (const std::string& name : a.options.only) {
    if (std::ranges::find(sections, name) == sections.end()) {
      throw InputError(fmt::format("--only: '{}' is none of {}", name, fmt::join(sections, ", ")));
    }
  }
  return a.growth ? run_growth(a) : run_all(a, sections);
}

}  // namespace
}  // namespace bitspan::bench

int main(int argc, char** argv) {
  using namespace bitspan::bench;
  bitspan::open_standard_streams();
  bitspan::remove_leftovers_on_signals();
  if (argc > 1 && std::strcmp(argv[1], mesa_child_flag) == 0) {
    return mesa_child(argc, argv);
  }
  try {
    return run(argc, argv);
  } catch (const bitspan::InputError& e) {
    bitspan::say(fmt::format("bitspan_bench: {}\n", e.what()));
    return exit_input;
  } catch (const std::system_error& e) {
    bitspan::say(fmt::format("bitspan_bench: {}\n", e.what()));  // a full or closed standard output
    return exit_input;
  } catch (const std::exception& e) {
    bitspan::say(fmt::format("bitspan_bench: {}\n", e.what()));
    return exit_wrong_picture;
  }
}
