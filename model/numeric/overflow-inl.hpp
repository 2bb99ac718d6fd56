// SPDX-License-Identifier: Apache-2.0
// Overflow for lanes: the same value, lane by lane, as overflow() of overflow.hpp gives.
#include "model/numeric/lanes-inl.hpp"
#include "model/numeric/overflow.hpp"
#include "model/numeric/register.hpp"

#if defined(BITSPAN_MODEL_NUMERIC_OVERFLOW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_NUMERIC_OVERFLOW_INL
#undef BITSPAN_MODEL_NUMERIC_OVERFLOW_INL
#else
#define BITSPAN_MODEL_NUMERIC_OVERFLOW_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

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

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
