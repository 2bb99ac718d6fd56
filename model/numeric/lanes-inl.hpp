// SPDX-License-Identifier: Apache-2.0
// Lanes: integers side by side in a vector register, with the operators of one integer, so that the text of a
// stage reads the same for std::int64_t, for __int128 and for these. Included once a target (Highway's
// foreach_target.h); every name lives in the target's namespace.
//
//   LanesOf<std::int32_t>, LanesOf<std::int64_t>   as many as a register holds
//   WideLanes                                      128-bit integers, a lane each of two registers
//
// As in the scalar code an intermediate must fit its type; the stages ask that of their formats (extent.hpp)
// when they are prepared. Shift amounts are 0 .. bits - 1.
#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "model/numeric/exact.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/ratio.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_LANES_INL
#undef BITSPAN_MODEL_NUMERIC_LANES_INL
#else
#define BITSPAN_MODEL_NUMERIC_LANES_INL
#endif

#if !defined(__OPTIMIZE__) && HWY_TARGET != HWY_STATIC_TARGET
// Not inlined, the friends of LanesOf take their vectors in memory where their callers have them in
// registers.
#error "vectors need -O1 at least"
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// One truth value per lane.
template <class T>
struct MaskOf {
  using Tag = hn::ScalableTag<T>;
  hn::Mask<Tag> m;

  friend HWY_INLINE MaskOf operator&(MaskOf a, MaskOf b) { return {hn::And(a.m, b.m)}; }
  friend HWY_INLINE MaskOf operator|(MaskOf a, MaskOf b) { return {hn::Or(a.m, b.m)}; }
  friend HWY_INLINE MaskOf operator^(MaskOf a, MaskOf b) { return {hn::Xor(a.m, b.m)}; }
  friend HWY_INLINE MaskOf operator!(MaskOf a) { return {hn::Not(a.m)}; }
  friend HWY_INLINE bool any(MaskOf a) { return !hn::AllFalse(Tag(), a.m); }
  friend HWY_INLINE bool all(MaskOf a) { return hn::AllTrue(Tag(), a.m); }
  friend HWY_INLINE std::size_t set_in(MaskOf a) { return hn::CountTrue(Tag(), a.m); }
};

template <class T>
struct LanesOf {
  using Element = T;
  using Tag = hn::ScalableTag<T>;
  using Vector = hn::Vec<Tag>;
  using Mask = MaskOf<T>;
  static constexpr std::size_t count = hn::MaxLanes(Tag());

  LanesOf() = default;
  HWY_INLINE LanesOf(T x) : v(hn::Set(Tag(), x)) {}  // NOLINT(google-explicit-constructor): as a number
  static HWY_INLINE LanesOf from(Vector x) {
    LanesOf out;
    out.v = x;
    return out;
  }
  static HWY_INLINE LanesOf load(const T* p) { return from(hn::LoadU(Tag(), p)); }
  // first, first + 1, ... Highway's Iota of what is no constant goes through memory, a lane at a time.
  static HWY_INLINE LanesOf iota(T first) { return LanesOf(first) + from(hn::Iota(Tag(), T{0})); }
  HWY_INLINE void store(T* p) const { hn::StoreU(v, Tag(), p); }

  friend HWY_INLINE LanesOf operator+(LanesOf a, LanesOf b) { return from(hn::Add(a.v, b.v)); }
  friend HWY_INLINE LanesOf operator-(LanesOf a, LanesOf b) { return from(hn::Sub(a.v, b.v)); }
  friend HWY_INLINE LanesOf operator-(LanesOf a) { return from(hn::Neg(a.v)); }
  friend HWY_INLINE LanesOf operator*(LanesOf a, LanesOf b) { return from(a.v * b.v); }
  friend HWY_INLINE LanesOf operator&(LanesOf a, LanesOf b) { return from(hn::And(a.v, b.v)); }
  friend HWY_INLINE LanesOf operator|(LanesOf a, LanesOf b) { return from(hn::Or(a.v, b.v)); }
  friend HWY_INLINE LanesOf operator^(LanesOf a, LanesOf b) { return from(hn::Xor(a.v, b.v)); }
  friend HWY_INLINE LanesOf operator~(LanesOf a) { return from(hn::Not(a.v)); }
  // By one amount, and lane by lane. Right shifts keep the sign.
  friend HWY_INLINE LanesOf operator<<(LanesOf a, int by) {
#if HWY_TARGET == HWY_AVX3
    return from(a.v << hn::Set(Tag(), static_cast<T>(by)));
#else
    return from(hn::ShiftLeftSame(a.v, by));
#endif
  }
  friend HWY_INLINE LanesOf operator>>(LanesOf a, int by) {
#if HWY_TARGET == HWY_AVX3
    return from(a.v >> hn::Set(Tag(), static_cast<T>(by)));
#else
    return from(hn::ShiftRightSame(a.v, by));
#endif
  }
  friend HWY_INLINE LanesOf operator<<(LanesOf a, LanesOf by) { return from(a.v << by.v); }
  friend HWY_INLINE LanesOf operator>>(LanesOf a, LanesOf by) { return from(a.v >> by.v); }

  friend HWY_INLINE Mask operator<(LanesOf a, LanesOf b) { return {hn::Lt(a.v, b.v)}; }
  friend HWY_INLINE Mask operator>(LanesOf a, LanesOf b) { return {hn::Gt(a.v, b.v)}; }
  friend HWY_INLINE Mask operator<=(LanesOf a, LanesOf b) { return {hn::Not(hn::Lt(b.v, a.v))}; }
  friend HWY_INLINE Mask operator>=(LanesOf a, LanesOf b) { return {hn::Not(hn::Lt(a.v, b.v))}; }
  friend HWY_INLINE Mask operator==(LanesOf a, LanesOf b) { return {hn::Eq(a.v, b.v)}; }
  friend HWY_INLINE Mask operator!=(LanesOf a, LanesOf b) { return {hn::Ne(a.v, b.v)}; }

  friend HWY_INLINE LanesOf min(LanesOf a, LanesOf b) { return from(hn::Min(a.v, b.v)); }
  friend HWY_INLINE LanesOf max(LanesOf a, LanesOf b) { return from(hn::Max(a.v, b.v)); }
  friend HWY_INLINE LanesOf select(Mask m, LanesOf a, LanesOf b) {
    return from(hn::IfThenElse(m.m, a.v, b.v));
  }
  // 1 where true, else 0.
  friend HWY_INLINE LanesOf as_number(Mask m, const LanesOf* /*tag*/) {
    return from(hn::IfThenElseZero(m.m, hn::Set(Tag(), T{1})));
  }

  Vector v;
};

using Lanes = LanesOf<std::int64_t>;
using Lanes32 = LanesOf<std::int32_t>;

template <class T>
HWY_INLINE LanesOf<T> one_where(MaskOf<T> m) {
  return as_number(m, static_cast<const LanesOf<T>*>(nullptr));
}
// The first n lanes.
template <class T>
HWY_INLINE MaskOf<T> first_lanes(std::size_t n) {
  return {hn::FirstN(hn::ScalableTag<T>(), n)};
}
// table[index], lane by lane.
template <class T>
HWY_INLINE LanesOf<T> lookup(const T* table, LanesOf<T> index) {
  return LanesOf<T>::from(hn::GatherIndex(hn::ScalableTag<T>(), table, index.v));
}
// Calls f(lane number) for each lane and collects what it returns: where no vector form is worth having.
template <class F>
HWY_INLINE Lanes by_lane(F f) {
  HWY_ALIGN std::int64_t out[Lanes::count];
  for (std::size_t i = 0; i < Lanes::count; ++i) out[i] = f(i);
  return Lanes::load(out);
}
HWY_INLINE std::int64_t lane(Lanes x, std::size_t i) {
  HWY_ALIGN std::int64_t out[Lanes::count];
  x.store(out);
  return out[i];
}

using Doubles = hn::Vec<hn::ScalableTag<double>>;
HWY_INLINE Doubles to_double(Lanes x) { return hn::ConvertTo(hn::ScalableTag<double>(), x.v); }
// Toward zero; |x| < 2^63.
HWY_INLINE Lanes to_int(Doubles x) { return Lanes::from(hn::ConvertTo(hn::ScalableTag<std::int64_t>(), x)); }

// floor(log2 x) of 0 < x < 2^63. With the bit below the highest one cleared the conversion to double cannot
// round up to the next power of two, so the exponent field is right.
HWY_INLINE Lanes top_bit(Lanes x) {
  const Lanes clear = x & ~(x >> 1);
  const auto bits = hn::BitCast(hn::ScalableTag<std::int64_t>(), to_double(clear));
  return Lanes::from(hn::ShiftRight<52>(bits)) - Lanes(1023);
}

// ---------------------------------------------------------------- 128 bits

// Two's complement, hi 2^64 + lo (lo unsigned).
struct WideLanes {
  Lanes hi, lo;
  WideLanes() = default;
  HWY_INLINE WideLanes(Lanes h, Lanes l) : hi(h), lo(l) {}
  HWY_INLINE WideLanes(Lanes x) : hi(x >> 63), lo(x) {}  // NOLINT(google-explicit-constructor): as a number
  HWY_INLINE WideLanes(int128 x)                         // NOLINT(google-explicit-constructor)
      : hi(static_cast<std::int64_t>(x >> 64)), lo(static_cast<std::int64_t>(x)) {}
};

HWY_INLINE Lanes::Mask below_unsigned(Lanes a, Lanes b) {
  const Lanes flip(INT64_MIN);
  return (a ^ flip) < (b ^ flip);
}
HWY_INLINE Lanes shift_right_unsigned(Lanes a, Lanes by) {
  using U = hn::ScalableTag<std::uint64_t>;
  return Lanes::from(hn::BitCast(Lanes::Tag(), hn::BitCast(U(), a.v) >> hn::BitCast(U(), by.v)));
}
HWY_INLINE WideLanes operator+(WideLanes a, WideLanes b) {
  const Lanes lo = a.lo + b.lo;
  return {a.hi + b.hi + one_where(below_unsigned(lo, a.lo)), lo};
}
HWY_INLINE WideLanes operator-(WideLanes a, WideLanes b) {
  return {a.hi - b.hi - one_where(below_unsigned(a.lo, b.lo)), a.lo - b.lo};
}
// By 0..127, one amount or a lane each.
HWY_INLINE WideLanes operator<<(WideLanes a, Lanes by) {
  const auto whole = by >= Lanes(64);
  const Lanes part = by & Lanes(63);
  // lo >> (64 - part), of which part = 0 gives nothing.
  const Lanes carried = shift_right_unsigned(shift_right_unsigned(a.lo, Lanes(1)), Lanes(63) - part);
  const Lanes lo = a.lo << part;
  return {select(whole, lo, (a.hi << part) | carried), select(whole, Lanes(0), lo)};
}
HWY_INLINE WideLanes operator>>(WideLanes a, Lanes by) {
  const auto whole = by >= Lanes(64);
  const Lanes part = by & Lanes(63);
  const Lanes carried = (a.hi << (Lanes(63) - part)) << 1;
  const Lanes hi = a.hi >> part;
  return {select(whole, a.hi >> 63, hi), select(whole, hi, shift_right_unsigned(a.lo, part) | carried)};
}
HWY_INLINE WideLanes operator<<(WideLanes a, int by) {
  if (by == 0) return a;
  if (by >= 64) return {a.lo << (by - 64), Lanes(0)};
  return {(a.hi << by) | shift_right_unsigned(a.lo, Lanes(64 - by)), a.lo << by};
}
HWY_INLINE WideLanes operator>>(WideLanes a, int by) {
  if (by == 0) return a;
  if (by >= 64) return {a.hi >> 63, a.hi >> (by - 64)};
  return {a.hi >> by, shift_right_unsigned(a.lo, Lanes(by)) | (a.hi << (64 - by))};
}
// floor(log2 x) of x > 0.
HWY_INLINE Lanes top_bit(WideLanes x) {
  const auto is_wide = x.hi != Lanes(0);
  const auto is_full = x.lo < Lanes(0);  // of a word without a sign
  const Lanes of_word = select(is_full, Lanes(63), top_bit(select(is_full, Lanes(1), x.lo)));
  return select(is_wide, top_bit(select(is_wide, x.hi, Lanes(1))) + Lanes(64), of_word);
}
// The whole product of two 64-bit integers.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE WideLanes product_of(Lanes a, Lanes b) { return int128{hn::GetLane(a.v)} * hn::GetLane(b.v); }
#else
// Four 32 x 32 products. A signed half read as unsigned is 2^32 too large where negative: the other factor's
// low half is taken off again.
HWY_INLINE WideLanes product_of(Lanes a, Lanes b) {
  using S = hn::Repartition<std::int32_t, Lanes::Tag>;
  using U = hn::Repartition<std::uint32_t, Lanes::Tag>;
  const auto of_unsigned = [](Lanes x, Lanes y) HWY_ATTR {
    return Lanes::from(hn::BitCast(Lanes::Tag(), hn::MulEven(hn::BitCast(U(), x.v), hn::BitCast(U(), y.v))));
  };
  const Lanes a_hi = a >> 32;
  const Lanes b_hi = b >> 32;
  const Lanes mask(0xffffffffLL);
  const Lanes low = of_unsigned(a, b);
  const Lanes ah_bl = of_unsigned(a_hi, b) - (((b & mask) << 32) & (a >> 63));
  const Lanes al_bh = of_unsigned(a, b_hi) - (((a & mask) << 32) & (b >> 63));
  const Lanes high =
      Lanes::from(hn::BitCast(Lanes::Tag(), hn::MulEven(hn::BitCast(S(), a_hi.v), hn::BitCast(S(), b_hi.v))));
  const Lanes mid = ah_bl + shift_right_unsigned(low, Lanes(32));  // at least -2^63 + 2^31: no overflow
  const Lanes mid2 = al_bh + (mid & mask);
  return {high + (mid >> 32) + (mid2 >> 32), (mid2 << 32) | (low & mask)};
}
#endif

// ---------------------------------------------------------------- what intermediates are held in

// ValueOf<Int>: what a register holds in the text that computes in Int.
template <class Int>
struct ValueOfType {
  using type = Int;
};
template <>
struct ValueOfType<int128> {
  using type = std::int64_t;
};
template <>
struct ValueOfType<WideLanes> {
  using type = Lanes;
};
template <class Int>
using ValueOf = typename ValueOfType<Int>::type;

// WideOf<V>: what products of registers are held in whose lanes are V.
template <class V>
struct WideOf {
  using type = int128;
};
template <>
struct WideOf<Lanes> {
  using type = WideLanes;
};

// A number that fits Int.
template <class Int>
HWY_INLINE Int constant(int128 x) {
  if constexpr (std::is_same_v<Int, WideLanes> || std::is_same_v<Int, int128>) {
    return Int(x);
  } else {
    return Int(static_cast<std::int64_t>(x));
  }
}

// ElementOf<Int>: one integer of such a value.
template <class Int>
struct ElementOfType {
  using type = std::int64_t;
};
template <class T>
struct ElementOfType<LanesOf<T>> {
  using type = T;
};
template <class Int>
using ElementOf = typename ElementOfType<Int>::type;

// a b in Int, exactly.
template <class Int>
HWY_INLINE Int times(ValueOf<Int> a, ValueOf<Int> b) {
  if constexpr (std::is_same_v<Int, WideLanes>) {
    return product_of(a, b);
  } else {
    return static_cast<Int>(a) * static_cast<Int>(b);
  }
}

// x << by where by is 0 almost always.
template <class Int>
HWY_INLINE Int shifted_up(Int x, ValueOf<Int> by) {
  if constexpr (std::is_same_v<Int, WideLanes>) {
    if (!any(by != Lanes(0))) [[likely]] {
      return x;
    }
  }
  return x << by;
}
template <class Int>
HWY_INLINE Int at_least(Int x, Int least) {
  if constexpr (std::is_same_v<Int, Lanes> || std::is_same_v<Int, Lanes32>) {
    return max(x, least);
  } else {
    return x < least ? least : x;
  }
}
template <class Int>
HWY_INLINE Int at_least_one(Int x) {
  return at_least(x, Int(1));
}
template <class Int>
HWY_INLINE Int at_most(Int x, Int most) {
  if constexpr (std::is_same_v<Int, Lanes> || std::is_same_v<Int, Lanes32>) {
    return min(x, most);
  } else {
    return x > most ? most : x;
  }
}

// The same words for one integer.
HWY_INLINE std::int64_t select(bool m, std::int64_t a, std::int64_t b) { return m ? a : b; }
HWY_INLINE std::int64_t top_bit(std::int64_t x) { return bit_length(static_cast<std::uint64_t>(x)) - 1; }
HWY_INLINE std::int64_t top_bit(int128 x) { return bit_length(static_cast<uint128>(x)) - 1; }
HWY_INLINE std::int64_t min(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
HWY_INLINE std::int64_t max(std::int64_t a, std::int64_t b) { return a > b ? a : b; }
HWY_INLINE bool any(bool m) { return m; }
// An integer that fits a register.
HWY_INLINE std::int64_t low_word(int128 x) { return static_cast<std::int64_t>(x); }
HWY_INLINE Lanes low_word(Lanes x) { return x; }
HWY_INLINE Lanes low_word(WideLanes x) { return x.lo; }
HWY_INLINE std::int64_t one_where(bool m) { return m ? 1 : 0; }

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
