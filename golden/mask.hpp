// SPDX-License-Identifier: Apache-2.0
// Scissor and stipple; docs/numeric-spec.md, "state".
#pragma once

#include <cstdint>

#include "scene/draw_state.hpp"

namespace bitspan::golden {

inline bool is_outside_scissor(const DrawState& s, std::int64_t x, std::int64_t y) {
  return x < s.scissor_left || x >= s.scissor_right || y < s.scissor_top || y >= s.scissor_bottom;
}
inline bool is_masked(const DrawState& s, std::int64_t x, std::int64_t y) {
  if (is_outside_scissor(s, x, y)) return true;
  const std::int64_t bit = 8 * (y % 4) + x % 8;
  return s.stipple / (std::int64_t{1} << bit) % 2 == 0;
}

}  // namespace bitspan::golden
