#include "model/timed/cache.hpp"

#include <span>

namespace bitspan::timed {

Cache::Cache(int line_bytes, int sets, int ways)
    : line_bytes_(static_cast<std::uint64_t>(line_bytes)),
      sets_(static_cast<std::uint64_t>(sets)),
      ways_(static_cast<std::uint64_t>(ways)),
      slots_(sets_ * ways_) {}

bool Cache::access(std::uint64_t address) {
  const std::uint64_t line = address / line_bytes_;
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
