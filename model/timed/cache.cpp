// SPDX-License-Identifier: Apache-2.0
#include "model/timed/cache.hpp"

#include <bit>
#include <span>

namespace bitspan::timed {

Cache::Cache(int line_bytes, int sets, int ways)
    : line_bytes_(static_cast<std::uint64_t>(line_bytes)),
      sets_(static_cast<std::uint64_t>(sets)),
      ways_(static_cast<std::uint64_t>(ways)),
      line_shift_(std::has_single_bit(line_bytes_) ? std::countr_zero(line_bytes_) : -1),
      slots_(sets_ * ways_) {}

bool Cache::access_line(std::uint64_t line) {
  last_ = line;
  const std::span<Way> set = std::span(slots_).subspan(line % sets_ * ways_, ways_);
  ++time_;
  Way* victim = &set.front();
  for (Way& way : set) {
    if (way.used != 0 && way.line == line) {
      way.used = time_;
      ++hits_;
      return true;
    }
    if (way.used < victim->used) victim = &way;
  }
  *victim = {line, time_};
  ++misses_;
  return false;
}

}  // namespace bitspan::timed
