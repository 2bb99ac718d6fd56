// SPDX-License-Identifier: Apache-2.0
// The bounded FIFO between two stages of the timed model.
//
// Registered on both sides: what a clock pushes or pops is seen from the next clock on. So the order in which
// the stages of one clock are evaluated does not matter, and a FIFO of capacity 1 passes a record every
// second clock, and one of 2 or more passes one record per clock. At most one push and one pop occur per
// clock.
#pragma once

#include <cstdint>

#include "model/timed/ring.hpp"

namespace bitspan::timed {

template <class T>
class Fifo {
 public:
  explicit Fifo(int capacity) : capacity_(static_cast<std::uint64_t>(capacity)) {}  // >= 1

  // Records inside at the start of clock `now`.
  std::uint64_t occupancy(std::uint64_t now) const {
    return ring_.size() - (pushed_before_ == now + 1 ? 1U : 0U) + (popped_before_ == now + 1 ? 1U : 0U);
  }
  bool can_pop(std::uint64_t now) const { return occupancy(now) > 0; }
  bool can_push(std::uint64_t now) const { return occupancy(now) < capacity_; }
  // front: only where can_pop and not popped on this clock.
  const T& front() const { return ring_.front(); }
  void pop(std::uint64_t now) {
    ring_.pop();
    popped_before_ = now + 1;
  }
  // The slot to fill; its old contents are stale. Only where can_push.
  T& push(std::uint64_t now) {
    pushed_before_ = now + 1;
    return ring_.push_slot();
  }

  std::uint64_t capacity() const { return capacity_; }
  bool empty() const { return ring_.empty(); }

 private:
  std::uint64_t capacity_;
  Ring<T> ring_;
  std::uint64_t pushed_before_ = 0;  // clock of the last push, plus 1; 0 for never
  std::uint64_t popped_before_ = 0;
};

}  // namespace bitspan::timed
