// SPDX-License-Identifier: Apache-2.0
// Whatever has a clock in the timed model: a stage, the memory, the source of triangles.
#pragma once

#include <cstdint>

namespace bitspan::timed {

class Clocked {
 public:
  Clocked() = default;
  Clocked(const Clocked&) = delete;
  Clocked& operator=(const Clocked&) = delete;
  virtual ~Clocked() = default;

  // Rising edge number `now`, counted from 0. Sees what the others did on earlier clocks only, so the order
  // in which the parts of one clock are stepped does not matter.
  virtual void clock(std::uint64_t now) = 0;
};

// What the waveform shows of a stage on a clock.
struct StageSignals {
  bool in_valid = false;
  bool in_ready = false;
  bool out_valid = false;
  bool out_ready = false;
  unsigned occupancy = 0;  // of the FIFO in front, at the start of the clock
  unsigned state = 0;      // StageState
};

}  // namespace bitspan::timed
