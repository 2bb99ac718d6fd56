// SPDX-License-Identifier: Apache-2.0
// What a timed run measured, as plain numbers; docs/timing.md says what each promises.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "config/names.hpp"
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

// What became of an access of a cache. A miss is compulsory where a cache without end would miss, too; else
// it is of capacity where a cache of as many lines in a single set would miss, too; else it is a conflict.
BITSPAN_ENUM(CacheResult, hit, compulsory, capacity, conflict);
BITSPAN_ENUM(CacheAccessKind, read, write, flush);

struct CacheReport {
  std::string_view name;  // "texture", "depth", "color"
  std::uint64_t reads = 0, writes = 0;
  std::array<std::uint64_t, enum_names<CacheResult>.size()> results{};  // of both
  std::uint64_t written_back = 0;  // lines that had been written, when they were replaced
  std::uint64_t flushed = 0;       // such lines at a clear, and those that there are now
  bool operator==(const CacheReport&) const = default;
};

// A line of a cache's log.
struct CacheAccess {
  std::string_view cache{};
  CacheAccessKind kind = CacheAccessKind::read;
  std::uint64_t address = 0;  // byte; of a flush 0, as the rest
  CacheResult result = CacheResult::hit;
  bool writes_back = false;  // the line that is replaced had been written
};
using CacheWatch = std::function<void(const CacheAccess&)>;

struct TimedReport {
  std::uint64_t cycles = 0;         // clocks since begin()
  std::vector<StageReport> stages;  // in the order of the pipeline
  std::uint64_t cache_hits = 0;     // texel accesses, four a bilinear fragment
  std::uint64_t cache_misses = 0;
  // Of the caches of depth and colour that there are; of the texture cache where it was asked for.
  std::vector<CacheReport> caches;
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
