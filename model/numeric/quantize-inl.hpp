// SPDX-License-Identifier: Apache-2.0
// Q[name](x) for lanes: the same value, lane by lane, as quantize() of quantize.hpp gives (the tests go
// through every rounding and overflow mode, exhaustively at small widths). ratio-inl.hpp has the quotients.
#include <algorithm>

#include "model/numeric/observe-inl.hpp"
#include "model/numeric/overflow-inl.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/rounding-inl.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_QUANTIZE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#undef BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#else
#define BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

using model::quantize;

// The dropped part of x in 2^-32 ulp, rounded down.
HWY_INLINE Lanes dropped_part(Lanes dropped, int shift) {
  return shift >= bias_fraction ? dropped >> (shift - bias_fraction) : dropped << (bias_fraction - shift);
}

// A shift has room for the sign and for the rounding's addition up to here.
template <class L>
inline constexpr int most_shift = static_cast<int>(sizeof(typename L::Element)) * 8 - 2;
inline constexpr int most_wide_shift = 126;
// Farther down: x 2^-excess with all that is below its last place gathered into that place. Under a shift by
// the most this keeps the sign, the guard bit and whether anything is below it.
template <class T, class Shift>
HWY_NOINLINE LanesOf<T> gathered(LanesOf<T> x, Shift excess) {
  const LanesOf<T> kept = x >> excess;
  return kept | one_where((kept << excess) != x);
}
HWY_NOINLINE inline WideLanes gathered(WideLanes x, Lanes excess) {
  const WideLanes kept = x >> excess;
  const WideLanes lost = x - (kept << excess);
  return {kept.hi, kept.lo | one_where((lost.hi | lost.lo) != Lanes(0))};
}

// raw 2^-fraction into register r. raw, and raw on r's grid where that is the finer one, fit the lane with a
// bit to spare; so does what r holds where that is Lanes32.
template <class Watch>
HWY_INLINE Lanes quantize(Lanes raw, int fraction, const Register& r, Watch watch) {
  int shift = fraction - r.fraction;
  if (shift > most_shift<Lanes>) [[unlikely]] {
    raw = gathered(raw, std::min(shift - most_shift<Lanes>, 63));
    shift = most_shift<Lanes>;
  }
  const Lanes rounded = shift > 0 ? rounded_shift(raw, shift, r.mode) : shift == 0 ? raw : raw << -shift;
  if constexpr (Watch::enabled) {
    Lanes error(0);
    if (shift > 0) {
      const Lanes floor = raw >> shift;
      error = ((rounded - floor) << bias_fraction) - dropped_part(raw - (floor << shift), shift);
    }
    watch.note(r, rounded, (rounded < Lanes(r.min)) | (rounded > Lanes(r.max)), error);
  }
  return into_range(rounded, r);
}
HWY_INLINE Lanes32 quantize(Lanes32 raw, int fraction, const Register& r, NoObserve /*watch*/) {
  int shift = fraction - r.fraction;
  if (shift > most_shift<Lanes32>) [[unlikely]] {
    raw = gathered(raw, std::min(shift - most_shift<Lanes32>, 31));
    shift = most_shift<Lanes32>;
  }
  return into_range(shift > 0 ? rounded_shift(raw, shift, r.mode) : shift == 0 ? raw : raw << -shift, r);
}

template <class T>
HWY_INLINE LanesOf<T> quantize_branch_free(LanesOf<T> raw, int fraction, const Register& r) {
  const int shift = fraction - r.fraction;
  const int down = shift > 0 ? shift : 0;
  const int up = shift < 0 ? -shift : 0;
  T add = 0;
  if (shift > 0 && r.mode != Rounding::trn) {
    add = static_cast<T>((T{1} << (shift - 1)) - (r.mode == Rounding::rnd_min_inf ? 1 : 0));
  }
  const LanesOf<T> rounded = ((raw << up) + LanesOf<T>(add)) >> down;
  return min(max(rounded, LanesOf<T>(static_cast<T>(r.min))), LanesOf<T>(static_cast<T>(r.max)));
}
HWY_INLINE Lanes quantize(Lanes raw, int fraction, const Register& r, BranchFree /*watch*/) {
  return quantize_branch_free(raw, fraction, r);
}
HWY_INLINE Lanes32 quantize(Lanes32 raw, int fraction, const Register& r, BranchFree /*watch*/) {
  return quantize_branch_free(raw, fraction, r);
}

// Everything known of a value in front of its register: its floor on the register's grid, and what is below.
// dropped: in 2^-32 ulp, asked for by observers only.
template <class Watch, class Dropped>
inline Lanes narrow(WideLanes floor, Lanes::Mask guard, Lanes::Mask sticky, const Register& r, Watch watch,
                    Dropped dropped) {
  const auto negative = floor.hi < Lanes(0);
  const auto odd = (floor.lo & Lanes(1)) != Lanes(0);
  const Lanes up = one_where(rounds_up(r.mode, negative, odd, guard, sticky));
  const WideLanes rounded = floor + WideLanes(Lanes(0), up);
  const auto fits = rounded.hi == rounded.lo >> 63;
  const auto outside = !fits | (rounded.lo < Lanes(r.min)) | (rounded.lo > Lanes(r.max));
  if constexpr (Watch::enabled) {
    const Lanes far = select(negative, Lanes(INT64_MIN), Lanes(INT64_MAX));
    watch.note(r, select(fits, rounded.lo, far), outside, (up << bias_fraction) - dropped());
  }
  if (!any(outside)) [[likely]] {
    return rounded.lo;
  }
  return select(outside, overflowed(rounded.lo, rounded.hi, rounded.hi < Lanes(0), r), rounded.lo);
}

// raw, and raw on r's grid where that is the finer one, fit a signed 127-bit integer.
template <class Watch>
inline Lanes quantize(WideLanes raw, int fraction, const Register& r, Watch watch) {
  int shift = fraction - r.fraction;
  const Lanes::Mask none = Lanes(0) != Lanes(0);
  if (shift <= 0) {
    return narrow(raw << -shift, none, none, r, watch, []() HWY_ATTR { return Lanes(0); });
  }
  if (shift > most_wide_shift) [[unlikely]] {
    raw = gathered(raw, Lanes(std::min(shift - most_wide_shift, 127)));
    shift = most_wide_shift;
  }
  const WideLanes floor = raw >> shift;
  const WideLanes rest = raw - (floor << shift);  // 0 <= rest < 2^shift
  const WideLanes below_guard = rest - ((rest >> (shift - 1)) << (shift - 1));
  const auto guard = ((rest >> (shift - 1)).lo & Lanes(1)) != Lanes(0);
  const auto sticky = (below_guard.hi | below_guard.lo) != Lanes(0);
  return narrow(floor, guard, sticky, r, watch, [&]() HWY_ATTR {
    return shift >= bias_fraction ? (rest >> (shift - bias_fraction)).lo : rest.lo << (bias_fraction - shift);
  });
}

// Brings raw and shift, a lane each, to shifts of 1 .. most that mean the same: growth on some lanes moves
// them to a finer grid, for which the caller's formats leave the room.
template <class L>
HWY_NOINLINE void moved_shifts(L& raw, Lanes& shift, int most) {
  const Lanes up = max(Lanes(1) - shift, Lanes(0));
  const Lanes excess = max(shift - Lanes(most), Lanes(0));
  raw = gathered(raw << up, min(excess, Lanes(most + 1)));
  shift = shift + up - excess;
}
template <class L>
HWY_INLINE void keep_shifts(L& raw, Lanes& shift, int most) {
  // (unsigned)(shift - 1) > most - 1
  if (any(shift + Lanes(INT64_MAX) > Lanes(INT64_MIN + most - 1))) [[unlikely]] {
    L moved = raw;
    Lanes moved_shift = shift;
    moved_shifts(moved, moved_shift, most);
    raw = moved;
    shift = moved_shift;
  }
}

// The same with a binary point that differs from lane to lane: raw 2^-fraction. Raw fits one place below r's
// grid too.
template <class Watch>
HWY_INLINE Lanes quantize(Lanes raw, Lanes fraction, const Register& r, Watch watch) {
  Lanes shift = fraction - Lanes(r.fraction);
  keep_shifts(raw, shift, most_shift<Lanes>);
  const Lanes rounded = rounded_shift(raw, shift, r.mode);
  if constexpr (Watch::enabled) {
    const Lanes floor = raw >> shift;
    const Lanes dropped = raw - (floor << shift);
    const Lanes part = (dropped << max(Lanes(bias_fraction) - shift, Lanes(0))) >>
                       max(shift - Lanes(bias_fraction), Lanes(0));
    watch.note(r, rounded, (rounded < Lanes(r.min)) | (rounded > Lanes(r.max)),
               ((rounded - floor) << bias_fraction) - part);
  }
  return into_range(rounded, r);
}
HWY_INLINE Lanes quantize(Lanes raw, Lanes fraction, const Register& r, BranchFree /*watch*/) {
  Lanes shift = fraction - Lanes(r.fraction);
  keep_shifts(raw, shift, most_shift<Lanes>);
  const Lanes half = (Lanes(1) << (shift - Lanes(1))) - Lanes(r.mode == Rounding::rnd_min_inf ? 1 : 0);
  const Lanes add = half & Lanes(r.mode == Rounding::trn ? 0 : -1);
  return min(max((raw + add) >> shift, Lanes(r.min)), Lanes(r.max));
}
template <class Watch>
inline Lanes quantize(WideLanes raw, Lanes fraction, const Register& r, Watch watch) {
  Lanes shift = fraction - Lanes(r.fraction);
  keep_shifts(raw, shift, most_wide_shift);
  const WideLanes floor = raw >> shift;
  const WideLanes rest = raw - (floor << shift);
  const WideLanes half = WideLanes(Lanes(0), Lanes(1)) << (shift - Lanes(1));
  const WideLanes over = rest - half;
  const auto guard = over.hi >= Lanes(0);
  const auto sticky = select(guard, over.hi | over.lo, rest.hi | rest.lo) != Lanes(0);
  return narrow(floor, guard, sticky, r, watch, [&]() HWY_ATTR {
    return ((rest << max(Lanes(bias_fraction) - shift, Lanes(0))) >>
            max(shift - Lanes(bias_fraction), Lanes(0)))
        .lo;
  });
}
// One integer, for the same text.
template <class Int, class Watch>
HWY_INLINE std::int64_t quantize(Int raw, std::int64_t fraction, const Register& r,
                                 Watch watch) requires(std::is_same_v<Int, std::int64_t> ||
                                                       std::is_same_v<Int, int128>) {
  return model::quantize(raw, static_cast<int>(fraction), r, watch);
}

// quantize() where every lane's shift is known to be downward and to fit: 1 .. 62 places.
template <class Int, class Fraction, class Watch>
HWY_INLINE auto quantize_down(Int raw, Fraction fraction, const Register& r, Watch watch) {
  return quantize(raw, fraction, r, watch);
}
HWY_INLINE Lanes quantize_down(Lanes raw, Lanes fraction, const Register& r, BranchFree /*watch*/) {
  const Lanes shift = fraction - Lanes(r.fraction);
  const Lanes half = (Lanes(1) << (shift - Lanes(1))) - Lanes(r.mode == Rounding::rnd_min_inf ? 1 : 0);
  const Lanes add = half & Lanes(r.mode == Rounding::trn ? 0 : -1);
  return min(max((raw + add) >> shift, Lanes(r.min)), Lanes(r.max));
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
