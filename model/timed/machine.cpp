// SPDX-License-Identifier: Apache-2.0
#include "model/timed/machine.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "model/timed/span_interpolator_timing.hpp"

namespace bitspan::timed {
namespace {

std::string_view to_string(StageState state) {
  constexpr std::array<std::string_view, stage_states> names{"starved", "busy", "blocked", "memory"};
  return names[static_cast<std::size_t>(state)];
}

// More clocks than a legal configuration can go without a movement.
std::uint64_t longest_rest(const Run& run, const SystemcOptions& options) {
  const Config& config = run.config;
  const auto wide = [](int n) { return static_cast<std::uint64_t>(n); };
  const InterpolatorLatency interpolator = interpolator_latency(config);
  std::uint64_t clocks =
      wide(interpolator.span_setup) + wide(interpolator.span) + wide(interpolator.pixel_interval);
  for (const StageTiming& timing : run.timings) clocks += wide(timing.latency) + wide(timing.interval);
  const MemoryTiming& memory = config.memory;
  // Each port's requests may have to wait for those of the others.
  const std::uint64_t largest =
      std::max({wide(memory.cache_line_bytes), wide(memory.depth_cache.line_bytes),
                wide(memory.color_cache.line_bytes), wide(memory.width_bytes), color_bytes});
  clocks += 8 * (wide(memory.latency) + largest / wide(memory.width_bytes) + 1);
  if (options.memory == TimedMemory::ports) {
    // A read and the fragments in front of it; a port that stalls takes a hundred times as long at most.
    clocks += 1000 + 100 * wide(options.ports.most);
  }
  return 64 + 4 * clocks;
}

}  // namespace

Machine::Machine(const Config& config, const Scene& scene, const SystemcOptions& options)
    : run_(config, scene, options),
      progress_(options.progress),
      watchdog_clocks_(options.watchdog_clocks != 0 ? options.watchdog_clocks : longest_rest(run_, options)) {
}

void Machine::draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) {
  run_.deliver_constants(trace);
  std::int64_t index = first_index;
  for (const Triangle& triangle : triangles) model::check_triangle(*run_.scene, triangle, index++);
  if (triangles.empty()) return;
  if (failed_) throw std::logic_error("Engine::draw after a failed run");

  run_.trace = trace;
  last_move_ = cycles();
  failed_ = true;
  clock_until_drained(triangles, first_index);
  failed_ = false;
  run_.trace = nullptr;
  run_.counters.cycles = cycles();
}

void Machine::execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) {
  const int target = run_.targets.current();
  const std::uint64_t version = run_.scene.version();
  run_.execute(run_.config, command, next_index, trace);
  if (run_.targets.current() != target) target_changed();
  if (run_.scene.version() != version) scene_changed(version);
  if (std::holds_alternative<StateChange>(command.what)) state_changed();
  if (const auto* clear = std::get_if<Clear>(&command.what)) cleared(*clear);
}

TimedReport Machine::report() const {
  TimedReport report;
  report.cycles = cycles();
  fill(report);
  const InterpolatorLatency latency = interpolator_latency(run_.config);
  report.interpolator_exact = latency.exact;
  report.span_setup_latency = latency.span_setup;
  report.span_latency = latency.span;
  return report;
}

std::string Machine::state_text(const std::string& name, StageState state, std::uint64_t occupancy,
                                std::uint64_t capacity, const std::string& detail) {
  return " " + name + " " + std::string(to_string(state)) + " (" + detail + "FIFO " +
         std::to_string(occupancy) + "/" + std::to_string(capacity) + ");";
}

void Machine::nothing_moved(std::uint64_t cycle, std::string states) const {
  states.back() = '.';
  throw std::runtime_error("timed model: nothing moved for " + std::to_string(watchdog_clocks_) +
                           " clocks, at clock " + std::to_string(cycle) + ":" + states);
}

}  // namespace bitspan::timed
