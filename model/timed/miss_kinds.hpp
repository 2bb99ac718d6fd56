// SPDX-License-Identifier: Apache-2.0
// Why an access of a cache misses: because no cache however large would have the line, because one of the
// same size would not have it either, or because its set is too small.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "model/timed/timed_report.hpp"

namespace bitspan::timed {

class MissKinds {
 public:
  // lines: that the cache has room for.
  explicit MissKinds(std::size_t lines) : lines_(lines) {}
  // An access that has or has not hit. brings_in: where a cache does not have the line, it takes it in.
  CacheResult see(std::uint64_t line, bool hit, bool brings_in);

 private:
  std::size_t lines_;
  std::unordered_set<std::uint64_t> seen_;  // lines that a cache without end has
  // Those that a cache with a single set has, by the time of their last access, and that time.
  std::map<std::uint64_t, std::uint64_t> by_time_;
  std::unordered_map<std::uint64_t, std::uint64_t> time_of_;
  std::uint64_t time_ = 0;
};

}  // namespace bitspan::timed
