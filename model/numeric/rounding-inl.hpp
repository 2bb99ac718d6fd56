// SPDX-License-Identifier: Apache-2.0
// Rounding for lanes: the same value, lane by lane, as rounding.hpp gives.
//
// Rounding a binary fraction is one addition and a shift here: floor(x + c), c depending on the mode and, in
// four of them, on x's sign or the floor's parity (rounded_shift).
#include "config/config.hpp"
#include "model/numeric/lanes-inl.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_ROUNDING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_ROUNDING_INL
#undef BITSPAN_MODEL_NUMERIC_ROUNDING_INL
#else
#define BITSPAN_MODEL_NUMERIC_ROUNDING_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// x 2^-shift rounded, by an addition in units of 2^-shift of the kept place; shift >= 1. What is rare stands
// out of line here and below: inlined everywhere it would only cost compile time and instruction cache.
template <class L, class Shift>
HWY_NOINLINE L rounded_shift_rare(L x, Shift shift, Rounding mode) {
  const L one(1);
  switch (mode) {
    case Rounding::rnd_zero:
      return (x + ((one << (shift - Shift(1))) - one) + one_where(x < L(0))) >> shift;
    case Rounding::rnd_min_inf:
      return (x + ((one << (shift - Shift(1))) - one)) >> shift;
    case Rounding::rnd_inf:
      return (x + (one << (shift - Shift(1))) - one_where(x < L(0))) >> shift;
    case Rounding::rnd_conv:
      return (x + ((one << (shift - Shift(1))) - one) + ((x >> shift) & one)) >> shift;
    case Rounding::trn_zero:
      return (x + select(x < L(0), (one << shift) - one, L(0))) >> shift;
    case Rounding::trn:
    case Rounding::rnd:
      break;
  }
  return x >> shift;
}
template <class L, class Shift>
HWY_INLINE L rounded_shift(L x, Shift shift, Rounding mode) {
  if (mode == Rounding::trn) return x >> shift;
  if (mode == Rounding::rnd) return (x + (L(1) << (shift - Shift(1)))) >> shift;
  return rounded_shift_rare(x, shift, mode);
}

// Whether to add one to a floor: rounds_up of rounding.hpp.
template <class T>
HWY_INLINE MaskOf<T> rounds_up(Rounding mode, MaskOf<T> negative, MaskOf<T> odd, MaskOf<T> guard,
                               MaskOf<T> sticky) {
  switch (mode) {
    case Rounding::rnd:
      return guard;
    case Rounding::rnd_zero:
      return guard & (sticky | negative);
    case Rounding::rnd_min_inf:
      return guard & sticky;
    case Rounding::rnd_inf:
      return guard & (sticky | !negative);
    case Rounding::rnd_conv:
      return guard & (sticky | odd);
    case Rounding::trn:
      return guard & !guard;
    case Rounding::trn_zero:
      return negative & (guard | sticky);
  }
  return guard;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
