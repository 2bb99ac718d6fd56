// SPDX-License-Identifier: Apache-2.0
#include "model/numeric/quantize.hpp"

#include <algorithm>

namespace bitspan::model {

template <class Watch>
std::int64_t quantize_far(int128 raw, int fraction, const Register& r, Watch watch) {
  const auto nothing = [] { return std::int64_t{0}; };
  const std::int64_t shift = static_cast<std::int64_t>(fraction) - r.fraction;
  if (shift >= 128) {  // all bits are dropped; what is above them repeats the sign
    const bool negative = raw < 0;
    const bool guard = shift == 128 ? ((static_cast<uint128>(raw) >> 127) & 1) != 0 : negative;
    const bool sticky = shift == 128 ? (static_cast<uint128>(raw) << 1) != 0 : raw != 0;
    return narrow(negative ? int128{-1} : int128{0}, guard, sticky, r, watch, [&] {
      const auto kept = static_cast<std::int64_t>(raw >> std::min<std::int64_t>(shift - bias_fraction, 127));
      return kept + (negative ? std::int64_t{1} << bias_fraction : 0);
    });
  }
  if (shift > 0) {
    return quantize(raw, fraction, r, watch);  // beyond int64's shifts, within int128's
  }
  const std::int64_t left = -shift;
  const auto magnitude = raw < 0 ? ~static_cast<uint128>(raw) : static_cast<uint128>(raw);
  if (raw == 0 || left + bit_length(magnitude) <= 127) {
    return narrow(raw == 0 ? int128{0} : raw << left, false, false, r, watch, nothing);
  }
  // Too large for any register: only the low bits and the sign matter.
  const uint128 low = left >= 128 ? 0 : static_cast<uint128>(raw) << left;
  if constexpr (Watch::enabled) {
    constexpr int128 far_up = int128{1} << 100;
    watch.note(r, raw < 0 ? -far_up : far_up, false, 0);
  }
  return overflow(low, raw < 0, r);
}

template std::int64_t quantize_far(int128, int, const Register&, NoObserve);
template std::int64_t quantize_far(int128, int, const Register&, Observe);

std::int64_t quantize(int128 raw, int fraction, const Format& format) {
  return quantize(raw, fraction, make_register(format), NoObserve{});
}

}  // namespace bitspan::model
