// SPDX-License-Identifier: Apache-2.0
// A queue in a ring that grows by doubling: no allocation in the steady state.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace bitspan::timed {

template <class T>
class Ring {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  // front and pop: not when empty.
  T& front() { return slots_[head_]; }
  const T& front() const { return slots_[head_]; }
  void pop() {
    head_ = (head_ + 1) & mask_;
    --size_;
  }
  void push(T value) { push_slot() = std::move(value); }
  // Appends a slot with a stale value in it, for the caller to fill in place.
  T& push_slot() {
    if (size_ > mask_) grow();
    return slots_[(head_ + size_++) & mask_];
  }

 private:
  void grow() {
    std::vector<T> larger(2 * slots_.size());
    for (std::size_t i = 0; i < size_; ++i) larger[i] = std::move(slots_[(head_ + i) & mask_]);
    slots_.swap(larger);
    mask_ = slots_.size() - 1;
    head_ = 0;
  }

  std::vector<T> slots_ = std::vector<T>(4);  // a power of two of them
  std::size_t mask_ = 3;                      // their number - 1
  std::size_t head_ = 0;
  std::size_t size_ = 0;
};

}  // namespace bitspan::timed
