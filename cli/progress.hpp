// SPDX-License-Identifier: Apache-2.0
// Progress of long work: one line on a terminal, with the time left once that can be told; nothing in a pipe.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace bitspan {

class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // total: 0 where it is not known.
  void update(std::size_t done, std::size_t total);

 private:
  std::string label_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_, next_;
};

}  // namespace bitspan
