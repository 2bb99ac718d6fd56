// SPDX-License-Identifier: Apache-2.0
// Tags of a set-associative cache with least-recently-used replacement; no data.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "model/timed/miss_kinds.hpp"
#include "model/timed/timed_report.hpp"

namespace bitspan::timed {

// All numbers >= 1; with a hash, the sets are a power of two.
struct CacheShape {
  int line_bytes = 64, sets = 1, ways = 1;
  SetHash hash = SetHash::none;
};

class Cache {
 public:
  // keeps_writes: a write brings its line in, and the line is written back when it is replaced. Otherwise a
  // write brings nothing in.
  explicit Cache(const CacheShape& shape, bool keeps_writes = false);

  // From the first access on, counts what becomes of each, and tells it to `watch`, which may be empty.
  void measure(std::string_view name, const CacheWatch& watch);

  // What an access asks of the memory: first the write of the line that is replaced, then the read of its
  // own.
  struct LookUp {
    bool hit = false, writes_back = false, fetches = false;
  };
  // Looks a byte up. Where its line is brought in, the set's least recently used one goes.
  LookUp look_up(std::uint64_t address, bool is_write) {
    return look_up(address, line_of(address), is_write);
  }
  // The same for a read; true on a hit.
  bool access(std::uint64_t address) {
    const std::uint64_t line = line_of(address);
    if (line != last_) return look_up(address, line, false).hit;
    ++hits_;  // it is the most recently used one already
    return true;
  }
  // Writes back what is to be, and leaves the cache empty, as it was at first.
  void flush();

  std::uint64_t hits() const { return hits_; }
  std::uint64_t misses() const { return misses_; }
  // What was measured, with a flush at the end; none where nothing was.
  std::optional<CacheReport> report() const;

 private:
  struct Way {
    std::uint64_t line = 0;
    std::uint64_t used = 0;  // time of the last access; 0: empty
    bool dirty = false;
  };
  struct Measured {
    CacheReport report;
    CacheWatch watch;
    MissKinds kinds;
  };
  static constexpr std::uint64_t no_line = std::numeric_limits<std::uint64_t>::max();

  std::uint64_t line_of(std::uint64_t address) const {
    return line_shift_ >= 0 ? address >> line_shift_ : address / line_bytes_;
  }
  LookUp look_up(std::uint64_t address, std::uint64_t line, bool is_write);
  std::uint64_t dirty_lines() const;

  std::uint64_t line_bytes_, sets_, ways_;
  int line_shift_;  // where line_bytes_ is a power of two, else -1
  bool folds_upper_bits_, keeps_writes_;
  std::vector<Way> slots_;
  std::uint64_t last_ = no_line;  // line of the last access, where nothing is measured
  std::uint64_t time_ = 0;
  std::uint64_t hits_ = 0;
  std::uint64_t misses_ = 0;
  std::unique_ptr<Measured> measured_;  // null: nothing is
};

}  // namespace bitspan::timed
