// SPDX-License-Identifier: Apache-2.0
// The parts of the machine in span mode: what each holds, and the next clock at which it is looked at.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "model/timed/machine.hpp"
#include "model/timed/ring.hpp"
#include "model/timed/span_interpolator_timing.hpp"

namespace bitspan::timed::span_mode {

using Clock = std::uint64_t;
constexpr Clock never = std::numeric_limits<Clock>::max();

struct Part {
  Clock wake = 0;  // the clock to look at it next
  Clock poked = 0;

  // What this part waits for has changed; it sees that from the clock after `now` on.
  void poke(Clock now) {
    poked = now + 1;
    wake = std::min(wake, now + 1);
  }
  // Something becomes true for it at `clock`.
  void look(Clock clock) { wake = std::min(wake, clock); }
  // Has been looked at; by itself it has nothing to do before `next`.
  void sleep(Clock now, Clock next) { wake = poked == now + 1 ? now + 1 : next; }
};

// Counters of a stage, up to the clock its state began with.
struct Meter {
  std::string name;
  std::array<std::uint64_t, stage_states> clocks{};
  StageState state = StageState::starved;
  Clock since = 0;
  std::uint64_t in = 0, out = 0;

  void set(StageState next, Clock now) {
    settle(now);  // whether it changes or not: cheaper than a branch that nothing predicts
    state = next;
  }
  void settle(Clock now) {
    clocks[static_cast<std::size_t>(state)] += now - since;
    since = now;
  }
};

// A FIFO without its records: these are numbers in Workload.
struct Level {
  std::uint64_t capacity = 1;
  std::uint64_t pushed = 0;
  std::uint64_t popped = 0;
  Clock popped_at = never;
  std::uint64_t high_water = 0;

  std::uint64_t size() const { return pushed - popped; }
  // For the reader: only then does its pop change what the writer sees.
  bool full() const { return size() == capacity; }
  // For the writer, which is looked at after the reader.
  bool room(Clock now) const { return size() + (popped_at == now ? 1 : 0) < capacity; }
  // At most one per clock, after the reader's pop: so the next clock begins with this level. True where the
  // reader has to be looked at for it.
  bool push() {
    ++pushed;
    high_water = std::max(high_water, size());
    return size() == 1;
  }
  void pop(Clock now) {
    ++popped;
    popped_at = now;
  }
};

struct Request {
  std::uint64_t beats = 0;
  bool is_read = false;
};

// A record inside a pipe.
struct Entry {
  Clock due = never;       // through the stage; `never` where there is no record
  Clock ready = never;     // to leave: due and answered; `never` as long as the answers' clocks are not known
  Clock answer = 0;        // of the last read that the bus has taken
  std::uint32_t open = 0;  // of its asks: reads that the bus has not taken, writes that have not been put
  std::uint32_t pixel = 0;  // as in FragmentWork
  bool kept = false;
  bool holds_pixel = false;

  // For the memory.
  bool waits(Clock now) const { return due <= now && ready > now; }
  // The clock from `now` on from which it stands otherwise.
  Clock next(Clock now) const { return due > now ? due : ready; }
};

// setup, depth, texture, fog, merge: PipeStage (stage.hpp) without virtual calls and records.
struct Pipe : Part {
  // Behind span: the part in front, and the pipe behind; null for merge.
  Part* from = nullptr;
  Pipe* to = nullptr;
  Meter meter;
  Level in;
  Clock latency = 1, interval = 1;
  Clock next_entry = 0;
  std::uint64_t capacity = 1;  // records inside
  std::vector<Entry> entries;  // record n at n & mask
  std::uint64_t mask = 0;
  std::uint64_t entered = 0, left = 0;
  std::uint32_t asks = 0;            // of the newest record, still to be put: as in FragmentWork
  std::array<Request, 16> requests;  // of two texture units, two levels, four texels each

  std::uint64_t inside() const { return entered - left; }
  bool idle() const { return in.size() == 0 && inside() == 0 && asks == 0; }
  const Entry& head() const { return entries[left & mask]; }
};

struct Walk : Part {
  Meter meter;
  Level in;
  Clock latency = 1, interval = 1;
  Clock next_entry = 0;
  std::uint64_t capacity = 1;
  Ring<Clock> due;  // of the rows inside
  bool has_triangle = false;
  std::uint64_t steps = 0;

  bool idle() const { return in.size() == 0 && due.empty() && !has_triangle; }
};

struct Interpolator : Part {
  explicit Interpolator(const InterpolatorLatency& l) : latency(l), timing(l) {}

  Meter setup, span;
  Level in;
  Ring<std::int64_t> pixels;  // of each row from edge_walk on to the acceptance here
  InterpolatorLatency latency;
  SpanInterpolatorTiming timing;
  Clock seen = 0;          // clocks that `timing` has had
  bool out_ready = false;  // on those after

  bool idle() const { return in.size() == 0 && timing.idle(); }
  // The state of the half that did not start on a record. stands: what it has made is not taken; has_one: it
  // has a record to work on.
  static StageState held(bool stands, bool has_one) {
    return stands ? StageState::blocked : has_one ? StageState::busy : StageState::starved;
  }
  // That of span_setup. is_held: its span record meets a full FIFO; has_rows: rows are inside.
  StageState setup_state(bool is_held, bool in_valid, bool has_rows) const {
    return held(is_held, in_valid || (latency.interval > 1 && has_rows));
  }
};

// A port of the memory and its FIFO of two requests.
struct Port {
  struct Slot {
    const Request* request = nullptr;
    std::uint32_t ask = 0;  // its bit
    Entry* entry = nullptr;
  };
  Level level{.capacity = 2};
  std::array<Slot, 2> slots;  // request n at n & 1
};

struct Bus : Part {
  std::array<Port, 3> ports;  // Memory::Port
  Clock latency = 1;
  Clock free = 0;  // first clock it is free again
  MemoryReport report;

  bool waited_for() const {
    return std::ranges::any_of(ports, [](const Port& p) { return p.level.size() > 0; });
  }
};

struct Source : Part {
  std::uint64_t to_offer = 0;  // triangles
  std::uint64_t offered = 0;   // since begin()
};

}  // namespace bitspan::timed::span_mode
