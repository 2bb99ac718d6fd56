// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/observe.hpp"

#include <algorithm>

namespace bitspan::model {

int used_bits(const FieldStatistics& s, bool is_signed) {
  if (s.count == 0) {
    return 0;
  }
  const auto magnitude = [](std::int64_t v) {
    return bit_length(static_cast<std::uint64_t>(v < 0 ? ~v : v));  // -2^n takes n bits and a sign
  };
  return std::max(magnitude(s.min), magnitude(s.max)) + (is_signed || s.min < 0 ? 1 : 0);
}

void Observe::note(const Register& r, int128 rounded, bool in_range, std::int64_t error) const {
  FieldStatistics& s = statistics->fields[static_cast<std::size_t>(r.id)];
  const auto value =
      static_cast<std::int64_t>(std::clamp<int128>(rounded, int128{INT64_MIN}, int128{INT64_MAX}));
  s.min = s.count == 0 ? value : std::min(s.min, value);
  s.max = s.count == 0 ? value : std::max(s.max, value);
  ++s.count;
  s.bias += error;
  if (!in_range) {
    const bool wraps = r.overflow == Overflow::wrap || r.overflow == Overflow::wrap_sm;
    ++(wraps ? s.wraps : s.saturations);
  }
}

}  // namespace bitspan::model
