// SPDX-License-Identifier: Apache-2.0
// A value on a grid of its own, in one integer or in lanes. Every intermediate fits Int.
#include <algorithm>

#include "model/numeric/lanes-inl.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_SCALED_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_SCALED_INL
#undef BITSPAN_MODEL_NUMERIC_SCALED_INL
#else
#define BITSPAN_MODEL_NUMERIC_SCALED_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// raw 2^-fraction.
template <class Int>
struct Scaled {
  Int raw;
  int fraction;
};

// On a grid that is not coarser than its own.
template <class Int>
HWY_INLINE Int on_grid(const Scaled<Int>& x, int fraction) {
  return x.raw << (fraction - x.fraction);
}
template <class Int>
HWY_INLINE Scaled<Int> one_minus(const Scaled<Int>& x) {
  const int grid = std::max(x.fraction, 0);
  return {(Int(1) << grid) - on_grid(x, grid), grid};
}
template <class Int>
HWY_INLINE Scaled<Int> operator*(const Scaled<Int>& a, const Scaled<Int>& b) {
  return {a.raw * b.raw, a.fraction + b.fraction};
}
template <class Int>
HWY_INLINE Scaled<Int> operator+(const Scaled<Int>& a, const Scaled<Int>& b) {
  const int grid = std::max(a.fraction, b.fraction);
  return {on_grid(a, grid) + on_grid(b, grid), grid};
}
template <class Int>
HWY_INLINE Scaled<Int> smaller(const Scaled<Int>& a, const Scaled<Int>& b) {
  const int grid = std::max(a.fraction, b.fraction);
  return {at_most(on_grid(a, grid), on_grid(b, grid)), grid};
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
