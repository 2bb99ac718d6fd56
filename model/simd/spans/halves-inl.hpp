// SPDX-License-Identifier: Apache-2.0
// Between lanes of 64 and of 32 bits, and lanes of 32 bits moved side by side.
#include <array>
#include <cstdint>

#include "model/numeric/lanes-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_HALVES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_HALVES_INL
#undef BITSPAN_MODEL_SIMD_SPANS_HALVES_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_HALVES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

using Half = hn::Rebind<std::int32_t, Lanes::Tag>;  // as many as Lanes, 32 bits each
using HalfVector = hn::Vec<Half>;

// The low 32 bits.
HWY_INLINE HalfVector low_half(Lanes x) {
  const hn::Rebind<std::uint32_t, Lanes::Tag> d;
  return hn::BitCast(Half(), hn::TruncateTo(d, hn::BitCast(hn::ScalableTag<std::uint64_t>(), x.v)));
}
// The low 32 bits of both, a first.
HWY_INLINE Lanes32 low_halves(Lanes a, Lanes b) {
#if HWY_TARGET == HWY_SCALAR
  static_cast<void>(b);
  return Lanes32::from(low_half(a));
#else
  return Lanes32::from(hn::Combine(Lanes32::Tag(), low_half(b), low_half(a)));
#endif
}
// The lanes of a mask side by side. Highway 1.0's Compress copies its table to the stack each time.
#if HWY_TARGET == HWY_AVX3
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask mask) {
  return Lanes32::from(Lanes32::Vector{_mm512_maskz_compress_epi32(mask.m.raw, x.v.raw)});
}
#elif HWY_TARGET == HWY_SCALAR
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask /*mask*/) { return x; }
#else
constexpr auto make_orders32() {
  std::array<std::array<std::int32_t, Lanes32::count>, std::size_t{1} << Lanes32::count> orders{};
  for (std::size_t bits = 0; bits < orders.size(); ++bits) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < Lanes32::count; ++i) {
      if ((bits >> i & 1) != 0) orders[bits][to++] = static_cast<std::int32_t>(i);
    }
  }
  return orders;
}
constexpr auto orders32 = make_orders32();
HWY_INLINE Lanes32 packed(Lanes32 x, Lanes32::Mask mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Lanes32::Tag(), mask.m, bits);
  return Lanes32::from(
      hn::TableLookupLanes(x.v, hn::SetTableIndices(Lanes32::Tag(), orders32[bits[0]].data())));
}
#endif
HWY_INLINE Lanes widened(HalfVector x) { return Lanes::from(hn::PromoteTo(Lanes::Tag(), x)); }
HWY_INLINE void store_as(std::int64_t* at, Lanes x) { x.store(at); }
HWY_INLINE void store_as(std::int32_t* at, Lanes x) { hn::StoreU(low_half(x), Half(), at); }

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
