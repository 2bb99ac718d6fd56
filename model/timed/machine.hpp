// SPDX-License-Identifier: Apache-2.0
// One run of the timed model, from begin() to begin(): what both modes have in common.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/timed/engine_systemc.hpp"
#include "model/timed/run.hpp"

namespace bitspan::timed {

class Machine {
 public:
  Machine(const Config& config, const Scene& scene, const SystemcOptions& options);
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;
  virtual ~Machine() = default;

  // As TimedEngine's.
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace);
  // As Engine's: a command waits until the pipeline is empty, which it is between two draws.
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace);
  TimedReport report() const;
  virtual const std::vector<HandshakeClock>& handshake() const { return no_handshake_; }
  virtual void close_vcd() {}
  const Run& run() const { return run_; }

 protected:
  // Clocks until the last record of these triangles is through; at least one triangle.
  virtual void clock_until_drained(std::span<const Triangle> triangles, std::int64_t first_index) = 0;
  virtual std::uint64_t cycles() const = 0;
  // The draw state has changed; nothing is inside. Throws InputError where the machine has no such state.
  virtual void state_changed() {}
  // Planes have been cleared; nothing is inside.
  virtual void cleared(const Clear& /*clear*/) {}
  // Depth, stencil and colour are others from here on; nothing is inside.
  virtual void target_changed() {}
  // The scene is another one than at that version; nothing is inside. Throws InputError where the machine
  // draws one scene.
  virtual void scene_changed(std::uint64_t /*since*/) {}
  // The stages, the cache and the memory.
  virtual void fill(TimedReport& report) const = 0;

  // A stage's state as the watchdog tells it.
  static std::string state_text(const std::string& name, StageState state, std::uint64_t occupancy,
                                std::uint64_t capacity, const std::string& detail);
  [[noreturn]] void nothing_moved(std::uint64_t cycle, std::string states) const;

  Run run_;
  std::function<void(std::uint64_t)> progress_;
  static constexpr std::uint64_t progress_clocks = 65536;
  std::uint64_t watchdog_clocks_;
  std::uint64_t last_move_ = 0;  // cycles() after the last clock on which a stage moved something

 private:
  bool failed_ = false;
  std::vector<HandshakeClock> no_handshake_;
};

std::unique_ptr<Machine> make_cycle_machine(const Config& config, const Scene& scene,
                                            const SystemcOptions& options);
std::unique_ptr<Machine> make_span_machine(const Config& config, const Scene& scene,
                                           const SystemcOptions& options);
// In either mode.
std::unique_ptr<Machine> make_ports_machine(const Config& config, const Scene& scene,
                                            const SystemcOptions& options);

}  // namespace bitspan::timed
