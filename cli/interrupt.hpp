// SPDX-License-Identifier: Apache-2.0
// Ctrl-C as a request to stop: what runs is finished first.
#pragma once

#include <atomic>
#include <stop_token>
#include <thread>

namespace bitspan {

// While one exists, the first SIGINT or SIGTERM requests a stop, and a second one ends the program at once.
// To be made before any other thread: threads and programs started later do not see the signals.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  // 128 + the signal's number, as a shell has it; 0 where none came.
  int exit_code() const { return signal_ == 0 ? 0 : 128 + signal_; }

 private:
  std::stop_source source_;
  std::atomic<int> signal_{0};
  std::jthread watcher_;
};

}  // namespace bitspan
