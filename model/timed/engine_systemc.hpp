// SPDX-License-Identifier: Apache-2.0
// The timed model behind the Engine interface. Free of SystemC itself; docs/timing.md says what the numbers
// promise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "engine/engine.hpp"
#include "model/timed/timed_report.hpp"

namespace bitspan {

// Two ways to the same numbers: every one of TimedReport, Counters, Frame and Trace is equal.
enum class TimedMode : std::uint8_t {
  cycle,  // clock by clock, each stage a SystemC module; shows waveforms and handshakes
  span,   // from one clock on which something moves to the next, values one span at a time; no SystemC
};

// What stands behind depth, texture, fog and merge.
enum class TimedMemory : std::uint8_t {
  bus,    // FIFOs between them as configured, a texture cache, one memory bus
  ports,  // the RTL: its own queues, and a memory per port; no cache and no bus
};

// One clock of what the RTL has from span_setup to merge, as `verify` drives it: the span interpolator's
// handshakes, and those of the pixel stages.
struct ChainClock {
  HandshakeClock rows;
  PixelChainDrive drive;
  PixelChainPorts ports;
};

struct SystemcOptions {
  TimedMode mode = TimedMode::cycle;
  TimedMemory memory = TimedMemory::bus;
  PortTiming ports{};                                    // TimedMemory::ports only
  std::function<void(const ChainClock&)> watch_chain{};  // the same; called on every clock, may be empty
  // TimedMemory::bus only:
  bool measure_texture_cache = false;  // TimedReport::caches has it; takes time
  // Called with each access of the caches that TimedReport::caches has, for each cache in the order of the
  // fragments; may be empty.
  CacheWatch watch_caches{};
  // Mode cycle only:
  std::filesystem::path vcd{};    // waveform of the run since begin(); empty for none
  bool record_handshake = false;  // keep the span interpolator's handshake, four bits per clock
  // Clocks without any movement after which the run is given up as a deadlock; 0: more than any legal
  // configuration can stand still.
  std::uint64_t watchdog_clocks = 0;
  // Called every 65536 clocks of a draw with the number of triangles offered since begin(); may be empty. A
  // frame has its true timing only when it is drawn by one call, so progress is told from within.
  std::function<void(std::uint64_t)> progress{};
};

// draw() clocks until the last record is through; the next draw() goes on from that clock. It throws
// std::runtime_error with the state of each stage where nothing moves any more; then only begin() may follow.
class TimedEngine : public Engine {
 public:
  // Since begin(). counters().cycles is the same as report().cycles.
  virtual TimedReport report() const = 0;
  // One entry a clock since begin(), where record_handshake was asked for; else empty. The spans offered are
  // the trace's row (plane_row) records in order, the pixels delivered its fragment records.
  virtual const std::vector<HandshakeClock>& handshake() const = 0;
  // Completes the waveform under its name: also done by begin() and the destructor, but those cannot say that
  // it failed. Throws InputError.
  virtual void close_vcd() = 0;
};

// Throws InputError where the configuration has no timing, or the mode not what is asked for.
std::unique_ptr<TimedEngine> make_systemc(const Config& config, const SystemcOptions& options = {});

}  // namespace bitspan
