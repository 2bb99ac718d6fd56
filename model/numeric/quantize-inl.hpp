// Q[name](x) for lanes: the same value, lane by lane, as quantize() and quantize_ratio() of quantize.hpp and
// ratio.hpp give (the tests go through every rounding and overflow mode, exhaustively at small widths).
//
// Rounding a binary fraction is one addition and a shift here: floor(x + c), c depending on the mode and, in
// four of them, on x's sign or the floor's parity (rounded_shift).
#include <algorithm>
#include <bit>

#include "model/numeric/lanes-inl.hpp"
#include "model/numeric/observe.hpp"
#include "model/numeric/register.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_QUANTIZE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#undef BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#else
#define BITSPAN_MODEL_NUMERIC_QUANTIZE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

using model::quantize;
using model::quantize_ratio;

// ---------------------------------------------------------------- observers

// Histories of registers, a lane each; summed up by fold().
struct LaneHistory {
  HWY_ALIGN std::int64_t count[Lanes::count] = {};
  HWY_ALIGN std::int64_t outside[Lanes::count] = {};
  HWY_ALIGN std::int64_t min[Lanes::count];
  HWY_ALIGN std::int64_t max[Lanes::count];
  HWY_ALIGN std::int64_t bias[Lanes::count] = {};
  std::int64_t vectors = 0;           // seen with every lane active; count has the others
  Overflow overflow = Overflow::sat;  // the register's, known once something was outside
  LaneHistory() {
    for (std::size_t i = 0; i < Lanes::count; ++i) {
      min[i] = INT64_MAX;
      max[i] = INT64_MIN;
    }
  }
};
struct LaneStatistics {
  std::array<LaneHistory, register_count> of;
  // Adds what was seen since the last fold to `into`.
  void fold(Statistics& into) {
    for (std::size_t i = 0; i < of.size(); ++i) {
      FieldStatistics& to = into.fields[i];
      std::uint64_t outside = 0;
      for (std::size_t l = 0; l < Lanes::count; ++l) {
        const std::int64_t seen = of[i].count[l] + of[i].vectors;
        if (seen == 0) continue;
        to.min = to.count == 0 ? of[i].min[l] : std::min(to.min, of[i].min[l]);
        to.max = to.count == 0 ? of[i].max[l] : std::max(to.max, of[i].max[l]);
        to.count += static_cast<std::uint64_t>(seen);
        to.bias += of[i].bias[l];
        outside += static_cast<std::uint64_t>(of[i].outside[l]);
      }
      if (outside != 0) {
        const bool wraps = of[i].overflow == Overflow::wrap || of[i].overflow == Overflow::wrap_sm;
        (wraps ? to.wraps : to.saturations) += outside;
      }
      of[i] = LaneHistory();
    }
  }
};

// The observer of lanes: where to note, and which lanes hold something.
struct ObserveLanes {
  static constexpr bool enabled = true;
  LaneStatistics* statistics;
  Lanes::Mask active;
  bool whole = false;  // true: all lanes are active

  // rounded: before overflow, clamped to int64; error: rounded - exact in 2^-32 ulp.
  HWY_INLINE void note(const Register& r, Lanes rounded, Lanes::Mask outside, Lanes error) const {
    LaneHistory& h = statistics->of[static_cast<std::size_t>(r.id)];
    const auto add = [this](std::int64_t* at, Lanes x)
                         HWY_ATTR { (Lanes::load(at) + select(active, x, Lanes(0))).store(at); };
    if (whole) {
      ++h.vectors;
      (Lanes::load(h.bias) + error).store(h.bias);
      min(Lanes::load(h.min), rounded).store(h.min);
      max(Lanes::load(h.max), rounded).store(h.max);
    } else {
      add(h.count, Lanes(1));
      add(h.bias, error);
      min(Lanes::load(h.min), select(active, rounded, Lanes(INT64_MAX))).store(h.min);
      max(Lanes::load(h.max), select(active, rounded, Lanes(INT64_MIN))).store(h.max);
    }
    if (any(outside & active)) [[unlikely]] {
      add(h.outside, one_where(outside));
      h.overflow = r.overflow;
    }
  }
  // What was seen of lane i elsewhere.
  void add(const Register& r, std::size_t i, const FieldStatistics& seen) const {
    if (lane(one_where(active), i) == 0) return;
    LaneHistory& h = statistics->of[static_cast<std::size_t>(r.id)];
    h.count[i] += static_cast<std::int64_t>(seen.count);
    h.outside[i] += static_cast<std::int64_t>(seen.wraps + seen.saturations);
    h.overflow = r.overflow;
    h.min[i] = std::min(h.min[i], seen.min);
    h.max[i] = std::max(h.max[i], seen.max);
    h.bias[i] += seen.bias;
  }
};

// For registers that are plain (is_plain): the same without a choice per value.
struct Plain : NoObserve {};

// ---------------------------------------------------------------- rounding

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

// ---------------------------------------------------------------- overflow

// The low `word` bits of x.
template <class L>
HWY_INLINE L kept_bits(L x, const Register& r) {
  constexpr int bits = sizeof(typename L::Element) * 8;
  if (r.word >= bits) return x;
  return r.is_signed ? (x << (bits - r.word)) >> (bits - r.word)
                     : x & L(static_cast<typename L::Element>((std::int64_t{1} << r.word) - 1));
}

// overflow() of overflow.hpp for lanes that are outside; low, high: of the 128-bit value, negative: its sign.
HWY_NOINLINE inline Lanes overflowed(Lanes low, Lanes high, Lanes::Mask negative, const Register& r) {
  switch (r.overflow) {
    case Overflow::wrap:
      return kept_bits(low, r);
    case Overflow::sat:
    case Overflow::sat_sym:
      return select(negative, Lanes(r.min), Lanes(r.max));
    case Overflow::sat_zero:
      return Lanes(0);
    case Overflow::wrap_sm: {
      const Lanes above = r.word >= 64 ? high : low >> r.word;  // its lowest bit is wanted
      const auto sign = (above & Lanes(1)) != Lanes(0);
      const auto old_sign = ((low >> (r.word - 1)) & Lanes(1)) != Lanes(0);
      const std::int64_t magnitude = static_cast<std::int64_t>((std::uint64_t{1} << (r.word - 1)) - 1);
      const Lanes rest = select(sign ^ old_sign, ~low, low) & Lanes(magnitude);
      return kept_bits(rest | select(sign, ~Lanes(magnitude), Lanes(0)), r);
    }
  }
  return low;
}

HWY_INLINE Lanes into_range(Lanes x, const Register& r) {
  if (r.overflow == Overflow::sat || r.overflow == Overflow::sat_sym) {
    return min(max(x, Lanes(r.min)), Lanes(r.max));
  }
  const auto outside = (x < Lanes(r.min)) | (x > Lanes(r.max));
  if (!any(outside)) [[likely]] {
    return x;
  }
  return select(outside, overflowed(x, x >> 63, x < Lanes(0), r), x);
}
HWY_NOINLINE inline Lanes32 into_range_rare(Lanes32 x, const Register& r) {
  if (r.overflow == Overflow::wrap) {
    return kept_bits(x, r);
  }
  HWY_ALIGN std::int32_t raw[Lanes32::count];
  x.store(raw);
  for (std::int32_t& one : raw) {
    if (one < r.min || one > r.max) {
      one = static_cast<std::int32_t>(overflow(static_cast<uint128>(static_cast<int128>(one)), one < 0, r));
    }
  }
  return Lanes32::load(raw);
}
HWY_INLINE Lanes32 into_range(Lanes32 x, const Register& r) {
  const Lanes32 low(static_cast<std::int32_t>(r.min));
  const Lanes32 high(static_cast<std::int32_t>(r.max));
  if (r.overflow == Overflow::sat || r.overflow == Overflow::sat_sym) {
    return min(max(x, low), high);
  }
  if (!any((x < low) | (x > high))) [[likely]] {
    return x;
  }
  return into_range_rare(x, r);
}

// ---------------------------------------------------------------- Q of a binary fraction

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
HWY_INLINE LanesOf<T> quantize_plain(LanesOf<T> raw, int fraction, const Register& r) {
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
HWY_INLINE Lanes quantize(Lanes raw, int fraction, const Register& r, Plain /*watch*/) {
  return quantize_plain(raw, fraction, r);
}
HWY_INLINE Lanes32 quantize(Lanes32 raw, int fraction, const Register& r, Plain /*watch*/) {
  return quantize_plain(raw, fraction, r);
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
HWY_INLINE Lanes quantize(Lanes raw, Lanes fraction, const Register& r, Plain /*watch*/) {
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
HWY_INLINE Lanes quantize_down(Lanes raw, Lanes fraction, const Register& r, Plain /*watch*/) {
  const Lanes shift = fraction - Lanes(r.fraction);
  const Lanes half = (Lanes(1) << (shift - Lanes(1))) - Lanes(r.mode == Rounding::rnd_min_inf ? 1 : 0);
  const Lanes add = half & Lanes(r.mode == Rounding::trn ? 0 : -1);
  return min(max((raw + add) >> shift, Lanes(r.min)), Lanes(r.max));
}
// ---------------------------------------------------------------- Q of a quotient

// A numerator for quotient(): its low 64 bits, and itself in floating point, off by 2^-52 of itself at most.
struct Numerator {
  Lanes low;
  Doubles near;
};
HWY_INLINE Numerator numerator(Lanes n) { return {n, to_double(n)}; }
HWY_INLINE Numerator numerator(WideLanes n) {
  // hi 2^64 + lo, with lo taken as signed and the carry given to hi: each part rounds by 2^-53 of itself.
  const hn::ScalableTag<double> d;
  const Lanes hi = n.hi + one_where(n.lo < Lanes(0));
  return {n.lo, hn::Add(hn::Mul(to_double(hi), hn::Set(d, 0x1p64)), to_double(n.lo))};
}

// floor(n 2^scale / d) and the rest n 2^scale - floor d; d > 0. ok false on a lane: it has to be done by
// other means. Why exact, with e = 2^-53, what one conversion, sum or division rounds by at most, of its
// result:
//   near    n is off by 2 e of itself at most. Lanes: e. WideLanes: the halves and their sum round; hi' 2^64
//   rounds
//           only where |hi'| > 2^53, and then lo's part is nothing beside it; lo, at most 2^63 in size, by
//           2^9, and |n| >= 2^63 wherever hi' is not 0 - so e for the halves together and e for the sum.
//   near_q  before Floor: that, e of d and e of the division: 4 e (1 + 4 e) of the quotient. Below 2^49 this
//   is
//           little more than 1/4, so the floor is off by one at most. Powers of two scale exactly.
//   rest    of such a floor is in -d .. 2 d, and d < 2^61: its low 64 bits, all that is computed of it, are
//   it.
// A divisor or quotient beyond double's range is an infinity or a NaN here and fails `small`.
struct FloorQuotientLanes {
  Lanes floor, rest;
  Lanes d;  // times 2^-scale where scale < 0
  Lanes::Mask ok;
};
// 2^e; infinite from 1024.
constexpr double power_of_two(int e) {
  return std::bit_cast<double>(static_cast<std::uint64_t>((e < 1024 ? e : 1024) + 1023) << 52);
}
HWY_INLINE FloorQuotientLanes quotient(Numerator n, Lanes d, int scale) {
  const hn::ScalableTag<double> tag;
  const int up = scale > 0 ? scale : 0;
  const int down = scale < 0 ? -scale : 0;
  const Lanes divisor = d << (down < 63 ? down : 63);
  const auto near_d = hn::Mul(to_double(d), hn::Set(tag, power_of_two(down)));
  const auto near_q = hn::Floor(hn::Div(hn::Mul(n.near, hn::Set(tag, power_of_two(up))), near_d));
  const auto small =
      hn::And(hn::Lt(hn::Abs(near_q), hn::Set(tag, 0x1p49)), hn::Lt(near_d, hn::Set(tag, 0x1p61)));
  const Lanes::Mask ok{hn::RebindMask(Lanes::Tag(), small)};
  Lanes floor = to_int(hn::IfThenElseZero(small, near_q));
  const Lanes shifted = up < 64 ? n.low << up : Lanes(0);
  Lanes rest = shifted - floor * divisor;
  const auto low = rest < Lanes(0);
  floor = floor - one_where(low);
  rest = rest + select(low, divisor, Lanes(0));
  const auto high = rest >= divisor;
  floor = floor + one_where(high);
  rest = rest - select(high, divisor, Lanes(0));
  return {floor, rest, divisor, ok};
}

HWY_INLINE int128 wide_lane(Lanes n, std::size_t i) { return lane(n, i); }
HWY_INLINE int128 wide_lane(WideLanes n, std::size_t i) {
  return static_cast<int128>(static_cast<uint128>(static_cast<std::uint64_t>(lane(n.hi, i))) << 64 |
                             static_cast<std::uint64_t>(lane(n.lo, i)));
}

// Rare sizes, one by one. Observers see them there as well.
template <class Int, class Watch>
HWY_NOINLINE Lanes quantize_ratio_rare(Int n, Lanes d, int scale, const Register& r, Watch watch) {
  return by_lane([&](std::size_t i) HWY_ATTR {
    const std::int64_t divisor = std::max<std::int64_t>(lane(d, i), 1);
    if constexpr (Watch::enabled) {
      Statistics one;
      const std::int64_t out = model::quantize_ratio(wide_lane(n, i), divisor, scale, r, Observe{&one});
      watch.add(r, i, one.of(r.id));
      return out;
    } else {
      return model::quantize_ratio(wide_lane(n, i), divisor, scale, r, NoObserve{});
    }
  });
}

// (n / d) 2^scale into r; d > 0, or the lane gives anything. Int: Lanes or WideLanes.
template <class Int, class Watch>
inline Lanes quantize_ratio(Int n, Lanes d, int scale, const Register& r,
                            Watch watch) requires(std::is_same_v<Int, Lanes> ||
                                                  std::is_same_v<Int, WideLanes>) {
  const FloorQuotientLanes q = quotient(numerator(n), d, r.fraction + scale);
  if (any(!q.ok)) [[unlikely]] {
    return quantize_ratio_rare(n, d, scale, r, watch);
  }
  const Lanes up = q.d - q.rest;
  const auto guard = q.rest >= up;
  const auto sticky = select(guard, q.rest ^ up, q.rest) != Lanes(0);
  const Lanes floor = q.floor;
  const Lanes add =
      one_where(rounds_up(r.mode, floor < Lanes(0), (floor & Lanes(1)) != Lanes(0), guard, sticky));
  const Lanes rounded = floor + add;
  if constexpr (Watch::enabled) {
    // rest / d in 2^-32 ulp, rounded down, by the same division.
    const FloorQuotientLanes part = quotient(
        {q.rest << bias_fraction,
         hn::Mul(to_double(q.rest), hn::Set(hn::ScalableTag<double>(), power_of_two(bias_fraction)))},
        q.d, 0);
    watch.note(r, rounded, (rounded < Lanes(r.min)) | (rounded > Lanes(r.max)),
               (add << bias_fraction) - part.floor);
  }
  return into_range(rounded, r);
}

// A divisor of several quotients: 0 < d, near its nearest double, inverse the double nearest to 1 / near.
struct Divisor {
  Lanes d;
  Doubles near, inverse;
};
HWY_INLINE Divisor make_divisor(Lanes d) {
  const auto near = to_double(d);
  return {d, near, hn::Div(hn::Set(hn::ScalableTag<double>(), 1.0), near)};
}

// (n / d) 2^scale to the nearest integer or the one beside it, off by less than 0.8, and the rest
// n 2^scale - whole d, both times 2^-scale where scale < 0. With fused multiply-adds all is exact: a rest of
// less than near in size is an integer below 2^53. Why 0.8: n and d are doubles themselves, so that the
// quotient before rounding to `whole` is off by 2^-52.9 of itself, and it is below 2^50.
struct NearQuotient {
  Doubles whole, rest, near;
  bool ok;  // on every lane; or it has to be done by other means
};
inline constexpr bool has_fused = HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX2;
HWY_INLINE NearQuotient near_quotient(Lanes n, const Divisor& d, int scale) {
  const hn::ScalableTag<double> tag;
  constexpr int most_scale = 500;
  const int up = scale > 0 ? std::min(scale, most_scale) : 0;
  const int down = scale < 0 ? std::min(-scale, most_scale) : 0;
  const auto exact = hn::Set(tag, 0x1p53);
  const auto n_near = to_double(n);
  const auto n_up = hn::Mul(n_near, hn::Set(tag, power_of_two(up)));
  const auto d_up = hn::Mul(d.near, hn::Set(tag, power_of_two(down)));
  const auto ratio = hn::Mul(hn::Mul(n_up, d.inverse), hn::Set(tag, power_of_two(-down)));
  const auto whole = hn::Round(ratio);
  const auto ok = hn::And(hn::And(hn::Lt(hn::Abs(n_near), exact), hn::Lt(d_up, exact)),
                          hn::Lt(hn::Abs(ratio), hn::Set(tag, 0x1p50)));
  return {whole, hn::NegMulAdd(whole, d_up, n_up), d_up,
          has_fused && scale <= most_scale && scale >= -most_scale && hn::AllTrue(tag, ok)};
}

// quantize_ratio() of a prepared divisor.
template <class Watch>
HWY_INLINE Lanes quantize_ratio(Lanes n, const Divisor& d, int scale, const Register& r, Watch watch) {
  return quantize_ratio(n, d.d, scale, r, watch);
}
HWY_INLINE Lanes quantize_ratio(Lanes n, const Divisor& d, int scale, const Register& r, Plain /*watch*/) {
  const NearQuotient q = near_quotient(n, d, r.fraction + scale);
  if (!q.ok) [[unlikely]] {
    return quantize_ratio_rare(n, d.d, scale, r, NoObserve{});
  }
  const hn::ScalableTag<double> tag;
  const auto zero = hn::Zero(tag);
  const auto one = hn::Set(tag, 1.0);
  const auto twice = hn::Add(q.rest, q.rest);
  auto rounded = q.whole;
  if (r.mode == Rounding::trn) {
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Lt(q.rest, zero), one));
  } else if (r.mode == Rounding::rnd) {
    rounded = hn::Add(rounded, hn::IfThenElseZero(hn::Ge(twice, q.near), one));
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Lt(twice, hn::Neg(q.near)), one));
  } else {
    rounded = hn::Add(rounded, hn::IfThenElseZero(hn::Gt(twice, q.near), one));
    rounded = hn::Sub(rounded, hn::IfThenElseZero(hn::Le(twice, hn::Neg(q.near)), one));
  }
  return min(max(to_int(rounded), Lanes(r.min)), Lanes(r.max));
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
