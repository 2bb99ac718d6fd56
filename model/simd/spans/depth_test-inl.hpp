// SPDX-License-Identifier: Apache-2.0
// Depth codes of lanes, and the depth test of the pixels of a span.
#include <algorithm>
#include <cstdint>

#include "model/simd/spans/halves-inl.hpp"
#include "model/simd/spans/ramps-inl.hpp"
#include "model/stages/depth-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_DEPTH_TEST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_DEPTH_TEST_INL
#undef BITSPAN_MODEL_SIMD_SPANS_DEPTH_TEST_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_DEPTH_TEST_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

template <class Watch>
HWY_NOINLINE DepthPoint<Lanes> code_by_reciprocal(const DepthFormats& f, const DepthScene& scene, Lanes h,
                                                  Watch watch) {
  return depth_point<WideLanes>(f, scene, h, watch);
}
template <class Watch>
HWY_INLINE DepthPoint<Lanes> depth_code_of(const DepthStage& stage, const DepthFormats& f, Lanes h,
                                           Watch watch) {
  if (!stage.fits_int64) [[unlikely]] {
    return code_by_reciprocal(f, stage.scene, h, watch);
  }
  return depth_point<Lanes>(f, stage.scene, h, watch);
}

HWY_INLINE Lanes biased(const DepthStage& stage, Lanes z) {
  if (stage.bias == 0) return z;
  return min(max(z + Lanes(stage.bias), Lanes(0)), Lanes(stage.formats.zmax));
}

constexpr std::int64_t pixels_a_line = 16;  // of the cache, depth codes or colours

// Small triangles lie anywhere in the buffers, and a span would wait for its depth codes longer than all else
// takes: they are fetched while earlier spans are drawn. All at once would be more than can be under way.
constexpr std::size_t spans_ahead = 16;
constexpr std::size_t few_pixels = 64;
HWY_INLINE void fetch_depth(const Frame& frame, std::int64_t pixel, std::int64_t count) {
  const std::uint32_t* const codes = frame.depth.data() + pixel;
  __builtin_prefetch(codes, 1);
  __builtin_prefetch(codes + count - 1, 1);
  for (std::int64_t k = pixels_a_line; k + pixels_a_line < count; k += pixels_a_line) {
    __builtin_prefetch(codes + k, 1);
  }
}

// How a span's pixels are tested.
enum class Test : std::uint8_t {
  few,    // without branches: what passes is as good as random where spans are short
  many,   // whole vectors pass, or none of their pixels
  walked  // h is no ramp
};

// Whether the draw state adds a bias to the codes.
enum class Bias : std::uint8_t { none, of_state };

// Who had a pixel last.
struct Owners {
  std::int32_t* of = nullptr;  // as `stored`; null: nobody asks
  std::int32_t own = 0;
};

// Tests pixels from .. to of a span, writes the places of those that pass to `passing` and, unless they are
// stored right away, their codes. Returns how many passed. func: a constant where the test must be fast.
// With owners, codes are stored, and `passing` is not written.
template <bool store, Test how, class Watch, Bias bias = Bias::none>
HWY_INLINE std::size_t test_depth(const DepthStage& stage, const DepthFormats& f, DepthFunc func,
                                  const Sequence& h, std::uint32_t* stored, std::size_t from, std::size_t to,
                                  std::int32_t* passing, std::int32_t* codes, const Owners& owners = {}) {
  const Lanes32::Tag d;
  auto* const buffer = reinterpret_cast<std::int32_t*>(stored);
  // Unsigned order by signed comparison.
  const Lanes32 flip(f.z.word > 31 ? INT32_MIN : 0);
  // Two calls per vector would be a third of the loop.
  const auto code_at = [&](Lanes of) HWY_ATTR __attribute__((always_inline)) {
    const Lanes z = depth_code_of(stage, f, of, Watch{}).z;
    return bias == Bias::none ? z : biased(stage, z);
  };
  const Lanes advance(h.increment * static_cast<std::int64_t>(Lanes32::count));
  Lanes first = at(h, Lanes::iota(static_cast<std::int64_t>(from)));
  Lanes second = first + Lanes(h.increment * static_cast<std::int64_t>(Lanes::count));
  std::size_t n = 0;
  for (std::size_t k = from; k < to; k += Lanes32::count) {
    if constexpr (how == Test::walked) {
      first = at(h, Lanes::iota(static_cast<std::int64_t>(k)));
      second = at(h, Lanes::iota(static_cast<std::int64_t>(std::min(k + Lanes::count, to))));
    }
    const Lanes32 z = low_halves(code_at(first), code_at(second));
    first = first + advance;
    second = second + advance;
    const bool whole = how != Test::few && k + Lanes32::count <= to;
    const auto inside = hn::FirstN(d, to - k);
    const auto old = Lanes32::from(whole ? hn::LoadU(d, buffer + k) : hn::MaskedLoad(inside, d, buffer + k));
    Lanes32::Mask pass = depth_passes(f, func, z ^ flip, old ^ flip);
    if (!whole) pass = pass & Lanes32::Mask{inside};
    if (store && owners.of != nullptr) {
      if (!any(pass)) continue;
      hn::BlendedStore(z.v, pass.m, d, buffer + k);
      hn::BlendedStore(Lanes32(owners.own).v, pass.m, d, owners.of + k);
      n += set_in(pass);
      continue;
    }
    if constexpr (how != Test::few) {
      if (!any(pass)) continue;
      if (whole && all(pass)) {  // most often where any does
        Lanes32::iota(static_cast<std::int32_t>(k)).store(passing + n);
        z.store(store ? buffer + k : codes + n);
        n += Lanes32::count;
        continue;
      }
    }
    packed(Lanes32::iota(static_cast<std::int32_t>(k)), pass).store(passing + n);
    if constexpr (store) {
      hn::BlendedStore(z.v, pass.m, d, buffer + k);
    } else {
      packed(z, pass).store(codes + n);
    }
    n += set_in(pass);
  }
  return n;
}

// The same for a ramp and the stage's own comparison, whatever it is.
template <bool store, class Watch>
HWY_NOINLINE std::size_t test_depth_by_func(const DepthStage& stage, const DepthFormats& f, const Sequence& h,
                                            std::uint32_t* stored, std::size_t from, std::size_t to,
                                            std::int32_t* passing, std::int32_t* codes) {
  return test_depth<store, Test::many, Watch>(stage, f, stage.func, h, stored, from, to, passing, codes);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
