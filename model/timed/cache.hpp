// SPDX-License-Identifier: Apache-2.0
// Tags of a set-associative cache with least-recently-used replacement; no data.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace bitspan::timed {

class Cache {
 public:
  // All >= 1. Line n is kept in set n mod sets.
  Cache(int line_bytes, int sets, int ways);

  // Looks a byte up and, on a miss, brings its line in over the set's least recently used one. True on a hit.
  bool access(std::uint64_t address) {
    const std::uint64_t line = line_shift_ >= 0 ? address >> line_shift_ : address / line_bytes_;
    if (line != last_) return access_line(line);
    ++hits_;  // it is the most recently used one already
    return true;
  }
  std::uint64_t hits() const { return hits_; }
  std::uint64_t misses() const { return misses_; }

 private:
  struct Way {
    std::uint64_t line = 0;
    std::uint64_t used = 0;  // time of the last access; 0: empty
  };
  bool access_line(std::uint64_t line);

  std::uint64_t line_bytes_, sets_, ways_;
  int line_shift_;  // where line_bytes_ is a power of two, else -1
  std::vector<Way> slots_;
  std::uint64_t last_ = std::numeric_limits<std::uint64_t>::max();  // line of the last access
  std::uint64_t time_ = 0;
  std::uint64_t hits_ = 0;
  std::uint64_t misses_ = 0;
};

}  // namespace bitspan::timed
