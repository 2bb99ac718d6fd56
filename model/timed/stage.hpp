// SPDX-License-Identifier: Apache-2.0
// What the clocked stages of the timed model share: state, counters, signals, the pipeline inside a stage.
//
// A stage is stepped once per clock by clock(now). It sees its FIFOs as they were at the start of the clock
// (fifo.hpp), so the stages of one clock may be stepped in any order. No SystemC here.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "model/timed/clocked.hpp"
#include "model/timed/fifo.hpp"
#include "model/timed/memory.hpp"
#include "model/timed/timed_report.hpp"

namespace bitspan::timed {

// Counters and signals of one stage; `moves` counts the clocks on which something went forward.
struct StageMeter {
  StageReport report;
  StageSignals signals;
  std::uint64_t moves = 0;

  void see_fifo(std::uint64_t occupancy) {
    signals.occupancy = static_cast<unsigned>(occupancy);
    report.fifo_high_water = std::max(report.fifo_high_water, occupancy);
  }
  void count(StageState state) {
    switch (state) {
      case StageState::starved:
        ++report.starved;
        break;
      case StageState::busy:
        ++report.busy;
        break;
      case StageState::blocked:
        ++report.blocked;
        break;
      case StageState::memory:
        ++report.memory;
        break;
    }
    signals.state = static_cast<unsigned>(state);
  }
};

class TimedStage : public Clocked {
 public:
  virtual bool idle() const = 0;  // nothing inside; its FIFOs are asked apart
  // One, or several where a module of the RTL holds stages of the pipeline.
  virtual std::vector<StageMeter*> meters() = 0;
  // The name of that module; empty where there is one stage.
  virtual std::string_view module() const { return {}; }
};

// Items on their way between stages: made once, passed by pointer, given back when they leave the pipeline.
template <class T>
class Pool {
 public:
  T* get() {
    if (free_.empty()) {
      all_.push_back(std::make_unique<T>());
      return all_.back().get();
    }
    T* item = free_.back();
    free_.pop_back();
    return item;
  }
  void put(T* item) { free_.push_back(item); }
  std::size_t in_use() const { return all_.size() - free_.size(); }

 private:
  std::vector<std::unique_ptr<T>> all_;
  std::vector<T*> free_;
};

// The items inside a stage, in order. One enters at most every `interval` clocks and may leave `latency`
// clocks later; bubbles close up while the head stands. It holds what full throughput needs, and `extra`
// more.
template <class T>
class DelayLine {
 public:
  struct Entry {
    T* item = nullptr;
    std::uint64_t due = 0;
    std::uint64_t ticket = 0;  // last read it waits for
    bool kept = true;          // false: ends here
  };

  DelayLine(const StageTiming& timing, int extra)
      : latency_(static_cast<std::uint64_t>(timing.latency)),
        interval_(static_cast<std::uint64_t>(timing.interval)),
        capacity_((latency_ + interval_ - 1) / interval_ + static_cast<std::uint64_t>(extra)) {}

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  bool has_due(std::uint64_t now) const { return !entries_.empty() && entries_.front().due <= now; }
  const Entry& head() const { return entries_.front(); }
  void pop() { entries_.pop(); }
  // Room, and the interval since the last one has passed.
  bool can_enter(std::uint64_t now) const { return entries_.size() < capacity_ && !in_interval(now); }
  bool in_interval(std::uint64_t now) const { return now < next_entry_; }
  // Spends an interval without an item.
  void take_interval(std::uint64_t now) { next_entry_ = now + interval_; }
  // The entry stays valid until the next one enters.
  Entry* enter(T* item, std::uint64_t now) {
    next_entry_ = now + interval_;
    Entry& entry = entries_.push_slot();
    entry = {item, now + latency_, 0, true};
    return &entry;
  }

 private:
  std::uint64_t latency_, interval_, capacity_;
  std::uint64_t next_entry_ = 0;
  Ring<Entry> entries_;
};

// A stage that takes one item and gives back the same one, with its own record filled in: setup, depth,
// texture, fog, merge.
template <class T>
class PipeStage : public TimedStage {
 public:
  // `out` may be null (merge). `memory` null: the stage has no memory accesses; else it holds as many more
  // items as the memory's latency has clocks, so that the latency alone does not limit its throughput.
  PipeStage(std::string_view name, const StageTiming& timing, Fifo<T*>& in, Fifo<T*>* out, Pool<T>& pool,
            Memory* memory = nullptr, Memory::Port port = Memory::Port::merge, int memory_latency = 0)
      : in_(in), out_(out), pool_(pool), memory_(memory), port_(port), line_(timing, memory_latency) {
    meter_.report.name = name;
    meter_.report.fifo_capacity = in.capacity();
  }

  void clock(std::uint64_t now) final {
    StageSignals& s = meter_.signals;
    meter_.see_fifo(in_.occupancy(now));
    s.in_valid = in_.can_pop(now);
    s.out_ready = out_ == nullptr || out_->can_push(now);
    s.out_valid = false;
    bool moved = false;
    bool accepted = false;
    bool blocked = false;
    bool waits = false;

    if (line_.has_due(now)) {
      const auto& head = line_.head();
      const bool requests_out = requests_.empty() || line_.size() > 1;
      if (!requests_out || (memory_ != nullptr && !memory_->answered(port_, head.ticket, now))) {
        waits = true;
      } else if (!head.kept || out_ == nullptr) {
        leaves(*head.item, head.kept, now);
        if (head.kept) ++meter_.report.records_out;
        pool_.put(head.item);
        line_.pop();
        moved = true;
      } else {
        s.out_valid = true;
        if (s.out_ready) {
          leaves(*head.item, true, now);
          out_->push(now) = head.item;
          ++meter_.report.records_out;
          line_.pop();
          moved = true;
        } else {
          blocked = true;
        }
      }
    }

    const bool in_interval = line_.in_interval(now);
    s.in_ready = requests_.empty() && line_.can_enter(now);
    waits = waits || !requests_.empty();
    if (s.in_ready && s.in_valid) {
      T* item = in_.front();
      if (may_enter(*item, now)) {
        in_.pop(now);
        ++meter_.report.records_in;
        newest_ = line_.enter(item, now);
        newest_->kept = enters(*item);
        accepted = true;
      } else {
        s.in_ready = false;
        waits = true;
      }
    }
    if (!requests_.empty()) {
      if (memory_->can_request(port_, now)) {
        const Access request = requests_.front();
        requests_.pop();
        if (request.is_read) {
          newest_->ticket = memory_->read(port_, request.bytes, now);
        } else {
          memory_->write(port_, request.bytes, now);
        }
        moved = true;
      }
    }

    if (moved || accepted) ++meter_.moves;
    meter_.count(accepted || in_interval ? StageState::busy
                 : blocked               ? StageState::blocked
                 : waits                 ? StageState::memory
                 : s.in_valid            ? StageState::busy
                                         : StageState::starved);
  }

  bool idle() const final { return line_.empty() && requests_.empty(); }
  // Where the records go from now on; nothing is inside.
  void set_out(Fifo<T*>& out) { out_ = &out; }
  std::vector<StageMeter*> meters() final { return {&meter_}; }

 protected:
  // May this item enter now? Asked while it is at the front of the FIFO.
  virtual bool may_enter(const T& /*item*/, std::uint64_t /*now*/) { return true; }
  // Calls the stage function, asks for memory; false: the item ends in this stage.
  virtual bool enters(T& item) = 0;
  // The item leaves, to the next stage (kept) or for good.
  virtual void leaves(T& /*item*/, bool /*kept*/, std::uint64_t /*now*/) {}

  void ask(std::span<const Access> accesses, Asks asks) {
    for (; asks != 0; asks = static_cast<Asks>(asks & (asks - 1))) {
      requests_.push(accesses[static_cast<std::size_t>(std::countr_zero(asks))]);
    }
  }

 private:
  Fifo<T*>& in_;
  Fifo<T*>* out_;
  Pool<T>& pool_;
  Memory* memory_;
  Memory::Port port_;
  DelayLine<T> line_;
  typename DelayLine<T>::Entry* newest_ = nullptr;
  Ring<Access> requests_;  // of the newest item, not yet handed to the memory: one per clock
  StageMeter meter_;
};

}  // namespace bitspan::timed
