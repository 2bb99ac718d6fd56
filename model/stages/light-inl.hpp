// SPDX-License-Identifier: Apache-2.0
// light: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "light".
#include "model/numeric/forms-inl.hpp"
#include "model/numeric/root-inl.hpp"
#include "model/stages/light.hpp"

#if defined(BITSPAN_MODEL_STAGES_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_LIGHT_INL
#undef BITSPAN_MODEL_STAGES_LIGHT_INL
#else
#define BITSPAN_MODEL_STAGES_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// A colour times a brightness. Int: int128 or lanes, which the product fits.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> lit(const LightStage& stage, ValueOf<Int> color, ValueOf<Int> value, Watch watch) {
  return quantize(Int(color) * Int(value), stage.color.fraction + stage.value.fraction, stage.color, watch);
}

template <class V>
using VectorOf = std::array<V, 3>;

// The direction from a point of the view to the light; x and y from the left and from the top, in 2^-fraction
// pixels. Wide: what the square of its length fits; Product: what the place across is rounded from.
template <class Int, class Wide, class Product, class Watch>
HWY_INLINE VectorOf<ValueOf<Int>> direction_from(const LightStage& stage, ValueOf<Int> x, ValueOf<Int> y,
                                                 int fraction, ValueOf<Int> s, int s_fraction, Watch watch) {
  using V = ValueOf<Int>;
  if (!stage.is_point) {
    return {V(stage.far_direction[0]), V(stage.far_direction[1]), V(stage.far_direction[2])};
  }
  // The picture's middle lies at halves of a pixel.
  const int grid = std::max(fraction, 1);
  const auto across = [&](V at, std::int64_t size) HWY_ATTR {
    const Int from_middle = (Int(at) << (grid - fraction)) - (Int(V(size)) << (grid - 1));
    const auto product = product_in<Product>(from_middle * constant<Int>(stage.scale.raw), s);
    return quantize(product, grid + stage.scale.fraction + s_fraction, stage.position, watch);
  };
  const V here_x = across(x, stage.width);
  const V here_y = across(y, stage.height);
  const V here_z = quantize(Int(s), s_fraction, stage.position, watch);
  return of_length_1<Int, Wide>(
      stage.root, {V(stage.place[0]) - here_x, V(stage.place[1]) - here_y, V(stage.place[2]) - here_z},
      stage.position.fraction, stage.direction, watch);
}

// The power of a cosine that is not below 0.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> highlight_of(const LightStage& stage, ValueOf<Int> cosine, Watch watch) {
  using V = ValueOf<Int>;
  const V g = min(cosine, V(1) << stage.cosine.fraction);
  const int down = stage.cosine.fraction - stage.index_bits;
  const int below = down > 0 ? down : 0;  // places of the point within an interval
  const V j = min(shifted_down(g, down), V((std::int64_t{1} << stage.index_bits) - 1));
  const V low = entry_of(stage.table.data(), j);
  const V rise = entry_of(stage.table.data(), j + V(1)) - low;
  const V within = (g << (below - down)) - (j << below);
  return quantize((Int(low) << below) + Int(rise) * Int(within), stage.specular.fraction + below,
                  stage.specular, watch);
}

template <class V>
struct ShineOf {
  VectorOf<V> normal, direction;
  V cosine, mirrored, specular, value;
};
// n: raw, normal.value. Wide: what the square of its length fits.
template <class Int, class Wide, class Watch>
HWY_INLINE ShineOf<ValueOf<Int>> shine(const LightStage& stage, const VectorOf<ValueOf<Int>>& n,
                                       const VectorOf<ValueOf<Int>>& direction, Watch watch) {
  using V = ValueOf<Int>;
  ShineOf<V> out;
  out.direction = direction;
  out.normal = of_length_1<Int, Wide>(stage.root, n, stage.given_normal.fraction, stage.normal, watch);
  const auto share = [&](std::size_t i) HWY_ATTR { return times<Int>(out.normal[i], direction[i]); };
  out.cosine = quantize(share(0) + share(1) + share(2), stage.normal.fraction + stage.direction.fraction,
                        stage.cosine, watch);
  // The viewer is at (0, 0, -1).
  const int twice = stage.cosine.fraction + stage.normal.fraction - 1;
  const int grid = std::max(stage.direction.fraction, twice);
  out.mirrored = quantize((Int(direction[2]) << (grid - stage.direction.fraction)) -
                              (times<Int>(out.cosine, out.normal[2]) << (grid - twice)),
                          grid, stage.cosine, watch);
  out.specular = V(0);
  const auto is_lit = out.cosine > V(0);
  const auto shines = is_lit & (out.mirrored > V(0));
  if (any(shines)) {
    out.specular = select(shines, highlight_of<Int>(stage, max(out.mirrored, V(0)), watch), V(0));
  }
  const int sum_grid = std::max(stage.cosine.fraction, stage.specular.fraction);
  const Int sum =
      (constant<Int>(stage.ambient) << sum_grid) +
      ((constant<Int>(stage.diffuse) * Int(max(out.cosine, V(0)))) << (sum_grid - stage.cosine.fraction)) +
      ((constant<Int>(stage.highlight) * Int(out.specular)) << (sum_grid - stage.specular.fraction));
  out.value = quantize(sum, stage.value.fraction + sum_grid, stage.value, watch);
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
