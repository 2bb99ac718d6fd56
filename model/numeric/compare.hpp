// SPDX-License-Identifier: Apache-2.0
// Comparisons of numbers by name: the alpha test's and the stencil test's.
#pragma once

#include "config/modes.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::model {

template <class Int>
constexpr bool compares(CompareFunc func, Int a, Int b) {
  switch (func) {
    case CompareFunc::never:
      return false;
    case CompareFunc::less:
      return a < b;
    case CompareFunc::equal:
      return a == b;
    case CompareFunc::less_equal:
      return a <= b;
    case CompareFunc::greater:
      return a > b;
    case CompareFunc::not_equal:
      return a != b;
    case CompareFunc::greater_equal:
      return a >= b;
    case CompareFunc::always:
      return true;
  }
  unreachable();
}

}  // namespace bitspan::model
