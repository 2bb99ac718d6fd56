// SPDX-License-Identifier: Apache-2.0
// bitspan sim: the timed model's run in numbers.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.hpp"
#include "cli/progress.hpp"
#include "cli/scene_options.hpp"
#include "config/modes.hpp"
#include "config/store.hpp"
#include "engine/range.hpp"
#include "io/atomic_file.hpp"
#include "model/timed/engine_systemc.hpp"
#include "report/table.hpp"

namespace bitspan {
namespace {

struct SimArguments {
  std::string scene;
  std::string config{default_config};
  std::string mode;  // empty: whichever suits
  std::string memory{"bus"};
  std::string port_latency{"1"};
  double port_stall = 0;
  std::uint64_t seed = 1;
  bool asks_for_ports = false;  // by an option that nothing else reads
  bool caches = false;
  std::string vcd, json, access_log;
  SceneOptions view;
};

// Both modes have the same numbers, so the faster one is taken where nothing needs the other.
TimedMode chosen_mode(const SimArguments& o) {
  if (o.mode.empty()) return o.vcd.empty() ? TimedMode::span : TimedMode::cycle;
  return o.mode == "cycle" ? TimedMode::cycle : TimedMode::span;
}

// MIN or MIN:MAX.
PortTiming parse_ports(const SimArguments& o) {
  PortTiming ports{.stall = o.port_stall, .seed = o.seed};
  const std::string& text = o.port_latency;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const auto number = [&](std::string_view digits) {
    int n = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), n);
    if (error != std::errc() || end != digits.data() + digits.size()) {
      throw InputError("--port-latency " + text + ": expected MIN or MIN:MAX in clocks, such as 1 or 1:25");
    }
    return n;
  };
  ports.least = number(std::string_view(text).substr(0, colon));
  ports.most = colon == text.size() ? ports.least : number(std::string_view(text).substr(colon + 1));
  check_ports(ports);
  return ports;
}

std::string latency_words(const PortTiming& p) {
  std::string text = p.least == p.most
                         ? fmt::format("{} clocks from request to answer", p.most)
                         : fmt::format("{} to {} clocks from request to answer", p.least, p.most);
  if (p.most == 1) text = "answers on the clock after the request";
  if (p.stall > 0) text += fmt::format(", stalls with probability {}", p.stall);
  if (p.least != p.most || p.stall > 0) text += fmt::format(", seed {}", p.seed);
  return text;
}

constexpr std::array<std::string_view, read_ports> port_names{"depth",   "colour",  "texel 0", "texel 1",
                                                              "texel 2", "texel 3", "texel 4", "texel 5",
                                                              "texel 6", "texel 7"};

std::string_view to_string(TimedMode mode) { return mode == TimedMode::cycle ? "cycle" : "span"; }

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{:.1f}", 100 * share(part, whole));
}

// Empty where none was measured.
std::string caches_text(const TimedReport& r) {
  if (r.caches.empty()) return "";
  std::vector<std::vector<std::string>> rows{{"cache", "reads", "writes", "hits %", "compulsory", "capacity",
                                              "conflict", "written back", "flushed"}};
  for (const CacheReport& c : r.caches) {
    const auto count = [&](CacheResult result) { return c.results[static_cast<std::size_t>(result)]; };
    rows.push_back({std::string(c.name), fmt::format("{}", c.reads), fmt::format("{}", c.writes),
                    percent(count(CacheResult::hit), c.reads + c.writes),
                    fmt::format("{}", count(CacheResult::compulsory)),
                    fmt::format("{}", count(CacheResult::capacity)),
                    fmt::format("{}", count(CacheResult::conflict)), fmt::format("{}", c.written_back),
                    fmt::format("{}", c.flushed)});
  }
  return text_table(rows);
}

nlohmann::ordered_json caches_json(const TimedReport& r) {
  auto out = nlohmann::ordered_json::array();
  for (const CacheReport& c : r.caches) {
    nlohmann::ordered_json cache{{"cache", c.name}, {"reads", c.reads}, {"writes", c.writes}};
    for (std::size_t i = 0; i < c.results.size(); ++i) {
      cache[std::string(enum_names<CacheResult>[i])] = c.results[i];
    }
    cache["written_back"] = c.written_back;
    cache["flushed"] = c.flushed;
    out.push_back(std::move(cache));
  }
  return out;
}

std::string log_line(const CacheAccess& a) {
  if (a.kind == CacheAccessKind::flush) return fmt::format("{},flush,,,\n", a.cache);
  return fmt::format("{},{},{},{},{}\n", a.cache, to_string(a.kind), a.address, to_string(a.result),
                     a.writes_back ? 1 : 0);
}

// What stands behind the pixel stages, and what they have asked of it.
std::string memory_text(const SystemcOptions& options, const TimedReport& r) {
  if (options.memory == TimedMemory::bus) {
    const std::uint64_t texels = r.cache_hits + r.cache_misses;
    return fmt::format("texture cache: {} accesses, {} misses ({} %)\n", texels, r.cache_misses,
                       percent(r.cache_misses, texels)) +
           fmt::format("memory: {} reads, {} writes, data bus taken {} clocks ({} %)\n", r.memory.reads,
                       r.memory.writes, r.memory.beats, percent(r.memory.beats, r.cycles)) +
           caches_text(r);
  }
  std::vector<std::vector<std::string>> rows{{"port", "reads", "writes", "stalled %"}};
  for (std::size_t p = 0; p < r.ports.size(); ++p) {
    const PortReport& port = r.ports[p];
    rows.push_back({std::string(port_names[p]), fmt::format("{}", port.requests),
                    p < write_ports ? fmt::format("{}", port.writes) : "-", percent(port.stalled, r.cycles)});
  }
  return text_table(rows);
}

std::string sim_text(const Scene& scene, const Config& config, const SystemcOptions& options,
                     const TimedReport& r, const Counters& c) {
  const bool ports = options.memory == TimedMemory::ports;
  std::string out = fmt::format("scene {}, configuration {} ({}), mode {}, memory {}\n\n", scene.name,
                                config.name, config_hash(config), to_string(options.mode),
                                ports ? "ports: " + latency_words(options.ports) : "bus");
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
  out += memory_text(options, r);
  out += fmt::format("span interpolator: span_setup {} clocks, span {} clocks; {}\n", r.span_setup_latency,
                     r.span_latency,
                     r.interpolator_exact ? "equal to the RTL clock for clock, stalls included"
                                          : "an estimate: no RTL has this configuration");
  if (ports) {
    out +=
        "depth, texture, fog, merge: equal to the RTL clock for clock, stalls and memory latency included\n";
    out += "the other stages: latencies and intervals as configured, not those of any RTL\n";
  } else {
    out +=
        "depth, texture, fog, merge: latencies of the RTL behind FIFOs, cache and bus that it does not "
        "have\n";
    out += "setup and the walk: latencies and intervals as configured, not those of any RTL\n";
  }
  return out;
}

std::string sim_json(const Scene& scene, const Config& config, const SystemcOptions& options,
                     const TimedReport& r, const Counters& c) {
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
  json["mode"] = to_string(options.mode);
  json["cycles"] = r.cycles;
  json["fragments"] = c.fragments;
  json["written"] = c.written;
  json["fragments_per_clock"] = share(c.fragments, r.cycles);
  json["stages"] = std::move(stages);
  if (options.memory == TimedMemory::bus) {
    json["cache"] = {{"hits", r.cache_hits}, {"misses", r.cache_misses}};
    if (!r.caches.empty()) json["caches"] = caches_json(r);
    json["memory"] = {{"reads", r.memory.reads}, {"writes", r.memory.writes}, {"beats", r.memory.beats}};
  } else {
    const PortTiming& p = options.ports;
    Json ports = Json::array();
    for (std::size_t i = 0; i < r.ports.size(); ++i) {
      ports.push_back({{"port", port_names[i]},
                       {"reads", r.ports[i].requests},
                       {"writes", r.ports[i].writes},
                       {"stalled", r.ports[i].stalled}});
    }
    json["ports"] = {{"latency_min", p.least},
                     {"latency_max", p.most},
                     {"stall", p.stall},
                     {"seed", p.seed},
                     {"accesses", ports}};
  }
  json["span_interpolator"] = {{"rtl_exact", r.interpolator_exact},
                               {"span_setup_latency", r.span_setup_latency},
                               {"span_latency", r.span_latency}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int sim(const SimArguments& o) {
  const Config config = with_lines(find_config(o.config), o.view);
  check_writable(o.json);
  check_writable(o.vcd);
  check_writable(o.access_log);
  const LoadedScene loaded = load_scene(o.scene, seen_with(config, o.view));
  const Scene& scene = loaded.scene;
  check_scene_range(config, scene);
  Progress progress(scene.name);
  SystemcOptions options;
  options.mode = chosen_mode(o);
  if (o.memory == "ports") {
    if (o.caches || !o.access_log.empty()) {
      throw InputError("--caches and --access-log describe caches: --memory bus has them");
    }
    options.memory = TimedMemory::ports;
    options.ports = parse_ports(o);
  } else if (o.asks_for_ports) {
    throw InputError(
        "--port-latency, --port-stall and --seed describe the RTL's ports: --memory ports reads them");
  }
  const bool has_caches =
      has_cache(config.memory.depth_cache.mode) || has_cache(config.memory.color_cache.mode);
  options.measure_texture_cache = o.caches || !o.access_log.empty() || has_caches;
  std::optional<AtomicFile> log;
  if (!o.access_log.empty()) {
    log.emplace(o.access_log);
    log->write("cache,access,byte,result,writes_back\n");
    options.watch_caches = [&log](const CacheAccess& access) { log->write(log_line(access)); };
  }
  options.vcd = o.vcd;
  options.progress = [&](std::uint64_t done) { progress.update(done, scene.triangles.size()); };
  const auto engine = make_systemc(config, options);
  engine->begin(scene);
  // One call: between two the pipeline would drain, and those clocks are no frame's.
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  engine->close_vcd();
  const TimedReport report = engine->report();
  if (log) log->commit();
  if (!o.json.empty()) {
    write_file(o.json, sim_json(scene, config, options, report, engine->counters()));
  }
  fmt::print("{}", faces_line(loaded));
  fmt::print("{}", sim_text(scene, config, options, report, engine->counters()));
  return exit_held;
}

}  // namespace

void add_sim(CLI::App& app, Action& action) {
  CLI::App* sub = app.add_subcommand("sim", "timed run: cycles, utilisation and stall reasons per stage");
  const auto o = std::make_shared<SimArguments>();
  sub->add_option("scene", o->scene, "stream (.tri, .trib), mesh, demo or extreme/NAME")->required();
  sub->add_option("--config", o->config, "shipped name or TOML file")->capture_default_str();
  sub->add_option("--mode", o->mode,
                  "cycle (clock by clock) or span (from movement to movement, faster): the same numbers; "
                  "without it cycle where there is --vcd, else span")
      ->check(CLI::IsMember({"cycle", "span"}));
  sub->add_option(
         "--memory", o->memory,
         "bus (FIFOs, texture cache, one memory bus) or ports (the RTL's queues and a memory per port)")
      ->check(CLI::IsMember({"bus", "ports"}))
      ->capture_default_str();
  sub->add_option("--port-latency", o->port_latency,
                  "MIN or MIN:MAX: clocks from a request to its answer, random per request in between; with "
                  "--memory ports")
      ->capture_default_str();
  sub->add_option("--port-stall", o->port_stall,
                  "probability per clock that a port takes no request, 0 to 0.99; with --memory ports")
      ->capture_default_str();
  sub->add_option("--seed", o->seed, "of the random latencies and stalls; with --memory ports")
      ->capture_default_str();
  sub->add_option("--vcd", o->vcd, "write a waveform; mode cycle only");
  sub->add_option("--json", o->json, "write the numbers as JSON");
  sub->add_flag("--caches", o->caches, "count the misses of each cache by their kind; with --memory bus");
  sub->add_option("--access-log", o->access_log,
                  "write each access of the caches as a line of CSV; with --memory bus");
  add_scene_options(*sub, o->view);
  sub->footer(help_footer("the clocks are counted", "no face of a mesh is drawn (--allow-empty accepts this)",
                          "bitspan sim demo --size 160x120 --vcd demo.vcd\n"
                          "  bitspan sim demo --memory ports --port-latency 1:25 --seed 7"));
  sub->callback([o, sub, &action] {
    o->asks_for_ports = sub->count("--port-latency") + sub->count("--port-stall") + sub->count("--seed") > 0;
    action = [o] { return sim(*o); };
  });
}

}  // namespace bitspan
