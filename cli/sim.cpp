// SPDX-License-Identifier: Apache-2.0
// bitspan sim: the timed model's run in numbers.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.hpp"
#include "cli/config_store.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "engine/range.hpp"
#include "io/atomic_file.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/table.hpp"

namespace bitspan {
namespace {

struct Options {
  std::string scene;
  std::string config{default_config};
  std::string mode;  // empty: whichever suits
  std::string vcd, json;
  SceneOptions view;
};

// Both modes have the same numbers, so the faster one is taken where nothing needs the other.
TimedMode chosen_mode(const Options& o) {
  if (o.mode.empty()) return o.vcd.empty() ? TimedMode::span : TimedMode::cycle;
  return o.mode == "cycle" ? TimedMode::cycle : TimedMode::span;
}

std::string_view to_string(TimedMode mode) { return mode == TimedMode::cycle ? "cycle" : "span"; }

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{:.1f}", 100 * share(part, whole));
}

std::string sim_text(const Scene& scene, const Config& config, TimedMode mode, const TimedReport& r,
                     const Counters& c) {
  std::string out = fmt::format("scene {}, configuration {} ({}), mode {}\n\n", scene.name, config.name,
                                config_hash(config), to_string(mode));
  std::vector<std::vector<std::string>> rows{
      {"stage", "in", "out", "busy %", "starved %", "blocked %", "memory %", "FIFO", "high water"}};
  for (const StageReport& s : r.stages) {
    const bool fifo = s.fifo_capacity > 0;
    rows.push_back({s.name, fmt::format("{}", s.records_in), fmt::format("{}", s.records_out),
                    percent(s.busy, r.cycles), percent(s.starved, r.cycles), percent(s.blocked, r.cycles),
                    percent(s.memory, r.cycles), fifo ? fmt::format("{}", s.fifo_capacity) : "-",
                    fifo ? fmt::format("{}", s.fifo_high_water) : "-"});
  }
  out += text_table(rows) + "\n";
  out += fmt::format("cycles: {}\n", r.cycles);
  out += fmt::format("pixels per clock: {:.4f} fragments, {:.4f} written\n", share(c.fragments, r.cycles),
                     share(c.written, r.cycles));
  const std::uint64_t texels = r.cache_hits + r.cache_misses;
  out += fmt::format("texture cache: {} accesses, {} misses ({} %)\n", texels, r.cache_misses,
                     percent(r.cache_misses, texels));
  out += fmt::format("memory: {} reads, {} writes, data bus taken {} clocks ({} %)\n", r.memory.reads,
                     r.memory.writes, r.memory.beats, percent(r.memory.beats, r.cycles));
  out += fmt::format("span interpolator: span_setup {} clocks, span {} clocks; {}\n", r.span_setup_latency,
                     r.span_latency,
                     r.interpolator_exact ? "equal to the RTL clock for clock, stalls included"
                                          : "an estimate: this mode has no RTL");
  out += "the other stages: latencies and intervals as configured, not those of any RTL\n";
  return out;
}

std::string sim_json(const Scene& scene, const Config& config, TimedMode mode, const TimedReport& r,
                     const Counters& c) {
  using Json = nlohmann::ordered_json;
  Json stages = Json::array();
  for (const StageReport& s : r.stages) {
    stages.push_back({{"stage", s.name},
                      {"records_in", s.records_in},
                      {"records_out", s.records_out},
                      {"busy", s.busy},
                      {"starved", s.starved},
                      {"blocked", s.blocked},
                      {"memory", s.memory},
                      {"fifo_capacity", s.fifo_capacity},
                      {"fifo_high_water", s.fifo_high_water}});
  }
  Json json;
  json["bitspan"] = BITSPAN_VERSION;
  json["scene"] = scene.name;
  json["configuration"] = {{"name", config.name}, {"hash", config_hash(config)}};
  json["mode"] = to_string(mode);
  json["cycles"] = r.cycles;
  json["fragments"] = c.fragments;
  json["written"] = c.written;
  json["fragments_per_clock"] = share(c.fragments, r.cycles);
  json["stages"] = std::move(stages);
  json["cache"] = {{"hits", r.cache_hits}, {"misses", r.cache_misses}};
  json["memory"] = {{"reads", r.memory.reads}, {"writes", r.memory.writes}, {"beats", r.memory.beats}};
  json["span_interpolator"] = {{"rtl_exact", r.interpolator_exact},
                               {"span_setup_latency", r.span_setup_latency},
                               {"span_latency", r.span_latency}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int sim(const Options& o) {
  const Config config = find_config(o.config);
  check_writable(o.json);
  check_writable(o.vcd);
  const LoadedScene loaded = load_scene(o.scene, o.view);
  const Scene& scene = loaded.scene;
  check_scene_range(config, scene);
  Progress progress(scene.name);
  SystemcOptions options;
  options.mode = chosen_mode(o);
  options.vcd = o.vcd;
  options.progress = [&](std::uint64_t done) { progress.update(done, scene.triangles.size()); };
  const auto engine = make_systemc(config, options);
  engine->begin(scene);
  // One call: between two the pipeline would drain, and those clocks are no frame's.
  engine->draw(scene.triangles, 0, nullptr);
  engine->close_vcd();
  const TimedReport report = engine->report();
  if (!o.json.empty()) {
    write_file(o.json, sim_json(scene, config, options.mode, report, engine->counters()));
  }
  fmt::print("{}", faces_line(loaded));
  fmt::print("{}", sim_text(scene, config, options.mode, report, engine->counters()));
  return exit_held;
}

}  // namespace

void add_sim(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("sim", "timed run: cycles, utilisation and stall reasons per stage");
  const auto o = std::make_shared<Options>();
  sub->add_option("scene", o->scene, "stream (.tri), mesh, demo or extreme/NAME")->required();
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--mode", o->mode,
                  "cycle (clock by clock) or span (from movement to movement, faster): the same numbers; "
                  "without it cycle where there is --vcd, else span")
      ->check(CLI::IsMember({"cycle", "span"}));
  sub->add_option("--vcd", o->vcd, "write a waveform; mode cycle only");
  sub->add_option("--json", o->json, "write the numbers as JSON");
  add_scene_options(*sub, o->view);
  sub->footer(help_footer("the clocks are counted", "no face of a mesh is drawn (--allow-empty accepts this)",
                          "bitspan sim demo --size 160x120 --vcd demo.vcd"));
  sub->callback([o, &action] { action = [o] { return sim(*o); }; });
}

}  // namespace bitspan
