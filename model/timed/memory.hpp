// SPDX-License-Identifier: Apache-2.0
// The memory behind the texture cache and the depth and colour buffers: one data bus, a fixed latency.
//
// A stage puts requests into the FIFO of its port. Each clock that the bus is free, the memory takes one
// request, ports in the order of `Port`; its beats take the bus for ceil(bytes / width) clocks. A read's last
// beat comes `latency` + beats - 1 clocks after that; a write needs no answer.
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "model/timed/clocked.hpp"
#include "model/timed/fifo.hpp"
#include "model/timed/timed_report.hpp"

namespace bitspan::timed {

// An access of the memory by a stage.
struct Access {
  std::uint64_t bytes = 0;
  bool is_read = false;
};
// Which ones of a stage's accesses a record asks for: bit i for the i-th; the lowest bit is put first.
using Asks = std::uint16_t;

class Memory : public Clocked {
 public:
  // Downstream first: what drains the pipeline goes before what fills it.
  enum class Port : std::uint8_t { merge, depth, texture, count };

  explicit Memory(const MemoryTiming& timing);

  bool can_request(Port port, std::uint64_t now) const { return at(port).requests.can_push(now); }
  // Returns the read's ticket: the number of reads asked for at this port so far, this one included.
  std::uint64_t read(Port port, std::uint64_t bytes, std::uint64_t now);
  void write(Port port, std::uint64_t bytes, std::uint64_t now);
  // Reads of this port have been answered up to the ticket; ticket 0 always is.
  bool answered(Port port, std::uint64_t ticket, std::uint64_t now);

  void clock(std::uint64_t now) override;
  bool idle() const;
  const MemoryReport& report() const { return report_; }

 private:
  struct Request {
    std::uint64_t beats = 0;
    bool is_read = false;
  };
  struct PortState {
    Fifo<Request> requests{2};
    std::uint64_t tickets = 0;         // reads asked for
    std::uint64_t answered = 0;        // reads known to have been answered
    Ring<std::uint64_t> answer_clock;  // of the reads the bus has taken, not yet known as answered
  };
  PortState& at(Port port) { return ports_[static_cast<std::size_t>(port)]; }
  const PortState& at(Port port) const { return ports_[static_cast<std::size_t>(port)]; }
  std::uint64_t beats(std::uint64_t bytes) const { return (bytes + width_ - 1) / width_; }

  std::uint64_t latency_, width_;
  std::array<PortState, static_cast<std::size_t>(Port::count)> ports_;
  std::uint64_t bus_free_ = 0;  // first clock the bus is free again
  MemoryReport report_;
};

// A stage's register of the memory word it touched last: further accesses to that word cost nothing.
// A word is the bus's width, or one access where that is larger; both are powers of two.
class WordRegister {
 public:
  WordRegister(const MemoryTiming& timing, std::uint64_t access_bytes);
  std::uint64_t word_bytes() const { return std::uint64_t{1} << word_shift_; }
  // True where the access has to go to the memory; accesses are aligned to their size.
  bool access(std::uint64_t address) {
    const std::uint64_t next_word = (address >> word_shift_) + 1;
    if (next_word == next_word_) return false;
    next_word_ = next_word;
    return true;
  }
  // The next access goes to the memory.
  void forget() { next_word_ = 0; }

 private:
  int word_shift_;
  std::uint64_t next_word_ = 0;  // word number + 1; 0 for none
};

}  // namespace bitspan::timed
