// Progress of long work: one line on a terminal, nothing in a pipe.
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
  void update(std::size_t done, std::size_t total);

 private:
  std::string label_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace bitspan
