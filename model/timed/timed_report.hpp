// SPDX-License-Identifier: Apache-2.0
// What a timed run measured, as plain numbers; docs/timing.md says what each promises.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/timed/memory_ports.hpp"

namespace bitspan {

// What became of a stage's chance to start on a record, clock by clock: each clock is exactly one of these,
// so the four sum to the cycles, and busy / cycles is the use made of the stage.
enum class StageState : std::uint8_t {
  starved,  // no record to start on
  busy,     // started on one, or is within the interval of the last
  blocked,  // a finished record stands because the next FIFO is full
  memory,   // waits for the memory, or for an earlier fragment of the same pixel
};
inline constexpr int stage_states = 4;

struct StageReport {
  std::string name;  // "setup", "edge_walk" or "plane_walk", ...
  std::uint64_t busy = 0;
  std::uint64_t starved = 0;
  std::uint64_t blocked = 0;
  std::uint64_t memory = 0;
  std::uint64_t records_in = 0;   // accepted
  std::uint64_t records_out = 0;  // delivered to the next stage (merge: written)
  // The FIFO in front of the stage; 0 and 0 for span, whose place is span_setup's result register.
  std::uint64_t fifo_capacity = 0;
  std::uint64_t fifo_high_water = 0;
};

struct MemoryReport {
  std::uint64_t reads = 0;  // requests
  std::uint64_t writes = 0;
  std::uint64_t beats = 0;  // clocks the data bus was taken
};

struct TimedReport {
  std::uint64_t cycles = 0;         // clocks since begin()
  std::vector<StageReport> stages;  // in the order of the pipeline
  std::uint64_t cache_hits = 0;     // texel accesses, four a bilinear fragment
  std::uint64_t cache_misses = 0;
  MemoryReport memory;
  // With the RTL's ports instead of cache and bus: depth, colour, four of texels. Else empty.
  std::vector<PortReport> ports;
  bool interpolator_exact = false;  // span_setup and span are the RTL's, clock for clock
  int span_setup_latency = 0;       // LS and LP of docs/rtl.md
  int span_latency = 0;
};

// One clock of the span interpolator's handshake, as `verify` replays it through the RTL.
struct HandshakeClock {
  bool in_valid : 1;
  bool out_ready : 1;
  bool in_ready : 1;
  bool out_valid : 1;
  bool operator==(const HandshakeClock&) const = default;
};

}  // namespace bitspan
