// SPDX-License-Identifier: Apache-2.0
#include "model/timed/miss_kinds.hpp"

namespace bitspan::timed {

CacheResult MissKinds::see(std::uint64_t line, bool hit, bool brings_in) {
  const auto found = time_of_.find(line);
  const bool in_one_set = found != time_of_.end();
  if (in_one_set) {
    by_time_.erase(found->second);
  } else if (brings_in && time_of_.size() == lines_) {
    time_of_.erase(by_time_.begin()->second);
    by_time_.erase(by_time_.begin());
  }
  if (in_one_set || brings_in) {
    time_of_[line] = ++time_;
    by_time_[time_] = line;
  }
  const bool seen = seen_.contains(line);
  if (brings_in && !seen) seen_.insert(line);
  return hit          ? CacheResult::hit
         : !seen      ? CacheResult::compulsory
         : in_one_set ? CacheResult::conflict
                      : CacheResult::capacity;
}

}  // namespace bitspan::timed
