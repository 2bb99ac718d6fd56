// SPDX-License-Identifier: Apache-2.0
// The levels of a block's fragments: docs/numeric-spec.md, "lod". By gradients in lanes, where the values
// leave them room; else by the scalar stage, a fragment at a time.
#include <algorithm>
#include <array>
#include <limits>

#include "config/modes.hpp"
#include "model/numeric/reciprocal-inl.hpp"
#include "model/pipeline.hpp"
#include "model/simd/fragment_block.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/spans/halves-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_LEVELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_LEVELS_INL
#undef BITSPAN_MODEL_SIMD_LEVELS_INL
#else
#define BITSPAN_MODEL_SIMD_LEVELS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// Level 0 where it is magnified by a filter of its own.
inline constexpr std::int32_t magnified_level = -1;

template <class T>
struct LevelColumns {
  HWY_ALIGN std::int32_t level[FragmentBlock<T>::padded];  // or magnified_level
  HWY_ALIGN T share[FragmentBlock<T>::padded];             // f, raw, lod.frac
};

HWY_INLINE Lanes load_wide(const std::int64_t* p) { return Lanes::load(p); }
HWY_INLINE Lanes load_wide(const std::int32_t* p) { return widened(hn::LoadU(Half(), p)); }

// lod by gradients of one triangle, prepared for its fragments.
struct GradientLod {
  const LodStage& stage;
  const ReciprocalFormats& unit = stage.reciprocal.formats();
  // q = h + B
  int q_fraction = std::max(stage.h.fraction, stage.b.fraction);
  int h_up = q_fraction - stage.h.fraction;
  Lanes b{static_cast<std::int64_t>(stage.b.raw << (q_fraction - stage.b.fraction))};
  // n = g - w h on the finer grid of both.
  int product_fraction = stage.uv.fraction + stage.h_grad.fraction;
  int n_fraction = std::max(stage.g_grad.fraction, product_fraction);
  int g_up = n_fraction - stage.g_grad.fraction;
  int w_up = n_fraction - product_fraction;
  int excess = 1;  // bits of n m beyond 61, at least 1 and below 64

  // Bits of n, and of n m also on the grid of lod.slope; coordinate_bits: of the largest |u| or |v|.
  struct Bits {
    int n, product;
  };
  Bits bits_of(const GradientRecord& g, int coordinate_bits) const {
    const auto bits = [](std::int64_t x) { return bit_length(static_cast<std::uint64_t>(x ^ (x >> 63))); };
    const int of_g = std::max({bits(g.gu_x), bits(g.gu_y), bits(g.gv_x), bits(g.gv_y)}) + g_up;
    const int of_w = std::max(bits(g.h_x), bits(g.h_y)) + coordinate_bits + w_up;
    const int of_n = std::max(of_g, of_w) + 1;
    // The reciprocal's exponent is not below that of one ulp of q.
    const int up = stage.slope.fraction - (n_fraction + unit.output.fraction - std::max(q_fraction, 0)) + 1;
    return {of_n, of_n + unit.output.word + std::max(up, 0)};
  }

  template <class Int>
  HWY_INLINE Lanes derivative(std::int64_t g, std::int64_t h, Lanes w,
                              const InverseOf<Lanes>& inverse) const {
    const Lanes n = (Lanes(g) << g_up) - ((w * Lanes(h)) << w_up);
    const Lanes fraction = inverse.e + Lanes(n_fraction + unit.output.fraction);
    const Int product = times<Int>(n, inverse.m);
    if constexpr (std::is_same_v<Int, WideLanes>) {
      // The bits that are too many for 64, where rounding drops them and two more: only whether one is set
      // counts.
      if (!any(fraction < Lanes(stage.slope.fraction + excess + 2))) [[likely]] {
        const Lanes lost = product.lo & Lanes((std::int64_t{1} << excess) - 1);
        const Lanes kept = (product.hi << (64 - excess)) | shift_right_unsigned(product.lo, Lanes(excess));
        return quantize(kept | one_where(lost != Lanes(0)), fraction - Lanes(excess), stage.slope,
                        NoObserve{});
      }
    }
    return quantize(product, fraction, stage.slope, NoObserve{});
  }

  // Of fragments.
  template <class Int>
  HWY_INLINE Lanes lambda(const GradientRecord& g, Lanes h, Lanes u, Lanes v) const {
    const InverseOf<Lanes> inverse =
        reciprocal(unit, stage.reciprocal.table().data(), (h << h_up) + b, q_fraction, NoObserve{});
    Lanes rho(1);  // one ulp, where all are 0
    for (const Lanes t :
         {derivative<Int>(g.gu_x, g.h_x, u, inverse), derivative<Int>(g.gu_y, g.h_y, u, inverse),
          derivative<Int>(g.gv_x, g.h_x, v, inverse), derivative<Int>(g.gv_y, g.h_y, v, inverse)}) {
      rho = max(rho, max(t, -t));
    }
    // Lg of numeric/log2.hpp, plus bias, on a grid that has both.
    const int grid = std::max(stage.slope.word, stage.bias.fraction);
    const Lanes top = top_bit(rho);
    const Lanes rest = rho - (Lanes(1) << top);
    const Lanes logarithm = ((top - Lanes(stage.slope.fraction)) << grid) + (rest << (Lanes(grid) - top));
    const Lanes bias(static_cast<std::int64_t>(stage.bias.raw << (grid - stage.bias.fraction)));
    return quantize(logarithm + bias, grid, stage.lambda, NoObserve{});
  }
  // Of the second texture unit, from the first one's.
  HWY_INLINE Lanes second_lambda(const TextureSecondStage& second, Lanes lambda) const {
    if (second.more_bias.raw == 0) return lambda;
    const int point = stage.lambda.fraction;
    const int grid = std::max(point, second.more_bias.fraction);
    const Lanes more(static_cast<std::int64_t>(second.more_bias.raw << (grid - second.more_bias.fraction)));
    return quantize((lambda << (grid - point)) + more, grid, stage.lambda, NoObserve{});
  }
  // Level and f between these levels: hold_level of lod.hpp.
  HWY_INLINE std::array<Lanes, 2> level(Lanes lambda, LevelEnds ends) const {
    const int point = stage.lambda.fraction;
    const Lanes held = min(max(lambda, Lanes(ends.least << point)), Lanes(ends.greatest << point));
    if (mixes_levels(stage.mip)) {
      const Lanes level = held >> point;
      return {level, quantize(held - (level << point), point, stage.frac, NoObserve{})};
    }
    return {(held + Lanes(point > 0 ? std::int64_t{1} << (point - 1) : 0)) >> point, Lanes(0)};
  }
};

// What scalar stages behind the depth test read of fragment k; grid: of the frame.
template <class T>
FragmentRecord fragment_of(const FragmentBlock<T>& block, std::size_t k, PixelGrid grid) {
  FragmentRecord f;
  f.triangle = block.triangle[k];
  f.x = grid.x_of(block.pixel[k]);
  f.y = grid.y_of(block.pixel[k]);
  f.h = block.h[k];
  f.u = block.u[k];
  f.v = block.v[k];
  return f;
}
inline DistanceRecord distance_of(const Pipeline& pipeline, const FragmentRecord& fragment) {
  DistanceRecord out;
  if (pipeline.has_distance) distance(pipeline.distance, fragment, out);
  return out;
}

// grid: of the frame; levels: of the block's texture and of the second unit's, 1 where there is none.
template <class T>
HWY_NOINLINE void find_levels(const Pipeline& pipeline, const FragmentBlock<T>& block,
                              const std::array<int, 2>& levels, const TriangleGradients& gradients,
                              PixelGrid grid, std::array<LevelColumns<T>, 2>& out) {
  GradientLod lod{pipeline.lod};
  const std::size_t units = pipeline.texture_second.is_on() ? 2 : 1;
  if (units == 1) {
    std::fill_n(out[1].level, block.size, 0);
    std::fill_n(out[1].share, block.size, T{0});
  }
  const std::array<const TextureStage*, 2> stages{&pipeline.texture, &pipeline.texture_second.fetch};
  std::array<bool, 2> magnified{};  // by a filter of its own
  std::array<LevelEnds, 2> ends{};
  for (std::size_t unit = 0; unit < units; ++unit) {
    magnified[unit] = stages[unit]->magnified != stages[unit]->lookup;
    ends[unit] = level_ends(stages[unit]->range, levels[unit]);
  }
  const bool in_lanes = fits_lanes(pipeline.lod);
  Lanes sizes(0);
  for (std::size_t k = 0; in_lanes && k < block.size; k += Lanes::count) {
    const Lanes u = load_wide(block.u + k);
    const Lanes v = load_wide(block.v + k);
    const Lanes::Mask inside = first_lanes<std::int64_t>(block.size - k);
    sizes = sizes | select(inside, (u ^ (u >> 63)) | (v ^ (v >> 63)), Lanes(0));
  }
  std::uint64_t size = 0;
  for (std::size_t i = 0; i < Lanes::count; ++i) size |= static_cast<std::uint64_t>(lane(sizes, i));
  const int coordinate_bits = bit_length(size);
  // A triangle's fragments follow one another. Vectors that look past them are written over.
  for (std::size_t first = 0, end = 0; first < block.size; first = end) {
    const std::int32_t triangle = block.triangle[first];
    while (end < block.size && block.triangle[end] == triangle) ++end;
    const GradientRecord* gradient =
        pipeline.has_gradients ? &gradients.of[static_cast<std::size_t>(triangle - gradients.first_index)]
                               : nullptr;
    const GradientLod::Bits bits =
        in_lanes ? lod.bits_of(*gradient, coordinate_bits) : GradientLod::Bits{128, 128};
    const auto run = [&]<class Int>() HWY_ATTR {
      for (std::size_t k = first; k < end; k += Lanes::count) {
        Lanes lambda = lod.lambda<Int>(*gradient, Lanes::load(block.h + k), load_wide(block.u + k),
                                       load_wide(block.v + k));
        for (std::size_t unit = 0; unit < units; ++unit) {
          if (unit == 1) lambda = lod.second_lambda(pipeline.texture_second, lambda);
          auto [level, share] = lod.level(lambda, ends[unit]);
          if (magnified[unit] && stages[unit]->range.least == 0) {
            const Lanes most(stages[unit]->range.greatest == 0 ? std::numeric_limits<std::int64_t>::max()
                                                               : 0);
            level = select(lambda <= most, Lanes(magnified_level), level);
          }
          store_as(out[unit].level + k, level);
          store_as(out[unit].share + k, share);
        }
      }
    };
    if (bits.product <= 61) {
      run.template operator()<Lanes>();
    } else if (bits.n <= 61 && bits.product <= 125) {
      lod.excess = std::clamp(bits.product - 61, 1, 63);
      run.template operator()<WideLanes>();
    } else {
      for (std::size_t k = first; k < end; ++k) {
        const FragmentRecord f = fragment_of(block, k, grid);
        const DistanceRecord far = distance_of(pipeline, f);
        LodRecord record;
        model::lod(pipeline.lod, f, gradient, far, levels[0], record);
        for (std::size_t unit = 0; unit < units; ++unit) {
          if (unit == 1) record = second_level(pipeline.texture_second, record, levels[1]);
          const bool magnify = magnified[unit] && magnifies(stages[unit]->range, record.lambda);
          out[unit].level[k] = magnify ? magnified_level : static_cast<std::int32_t>(record.level);
          out[unit].share[k] = static_cast<T>(record.f);
        }
      }
    }
  }
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
