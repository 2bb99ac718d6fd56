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

// 1 / (t 2^-fraction) = v 2^-(fraction of light.inverse + e); t = 0 is taken as 1.
template <class V>
struct DividedOf {
  V v, e;
};
template <class Int, class Watch>
HWY_INLINE DividedOf<ValueOf<Int>> inverse_of(const LightStage& stage, ValueOf<Int> t, int fraction,
                                              Watch watch) {
  const auto root = reciprocal_root<Int>(stage.root, Int(max(t, ValueOf<Int>(1))), fraction, watch);
  return {quantize(times<Int>(root.m, root.m), 2 * stage.root.output.fraction, stage.inverse, watch),
          root.e << 1};
}

// What the length of x leaves of a brightness; unit: x, of length 1.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> fall_along(const LightStage& stage, const VectorOf<ValueOf<Int>>& x,
                                   const VectorOf<ValueOf<Int>>& unit, Watch watch) {
  using V = ValueOf<Int>;
  const V d = quantize(times<Int>(x[0], unit[0]) + times<Int>(x[1], unit[1]) + times<Int>(x[2], unit[2]),
                       stage.position.fraction + stage.direction.fraction, stage.position, watch);
  const int grid = stage.distance.fraction;
  const V reached = quantize(Int(d) * constant<Int>(stage.per_reach.raw),
                             stage.position.fraction + stage.per_reach.fraction, stage.distance, watch);
  const V t = stage.by_square ? quantize(times<Int>(reached, reached) + (Int(V(stage.offset)) << grid),
                                         2 * grid, stage.distance, watch)
                              : quantize(Int(reached) + Int(V(stage.offset)), grid, stage.distance, watch);
  const auto inverse = inverse_of<Int>(stage, t, grid, watch);
  return quantize(Int(inverse.v), inverse.e + V(stage.inverse.fraction), stage.fall, watch);
}

template <class V>
struct TowardOf {
  VectorOf<V> direction;
  V fall;      // where brightness falls
  V share{0};  // that a shadow leaves, where there may be one
};
// From a point of the view to the light; x and y from the left and from the top, in 2^-fraction pixels.
// Wide: what the square of its length fits; Product: what the place across is rounded from.
template <class Int, class Wide, class Product, class Watch>
HWY_INLINE TowardOf<ValueOf<Int>> toward_light(const LightStage& stage, ValueOf<Int> x, ValueOf<Int> y,
                                               int fraction, ValueOf<Int> s, int s_fraction, Watch watch) {
  using V = ValueOf<Int>;
  const VectorOf<V> far{V(stage.far_direction[0]), V(stage.far_direction[1]), V(stage.far_direction[2])};
  if (!stage.takes_place) return {far, V(0), V(0)};
  // The picture's middle lies at halves of a pixel.
  const int grid = std::max(fraction, 1);
  const auto across = [&](V at, std::int64_t size) HWY_ATTR {
    const Int from_middle = (Int(at) << (grid - fraction)) - (Int(V(size)) << (grid - 1));
    const auto product = product_in<Product>(from_middle * constant<Int>(stage.scale.raw), s);
    return quantize(product, grid + stage.scale.fraction + s_fraction, stage.position, watch);
  };
  const VectorOf<V> here{across(x, stage.width), across(y, stage.height),
                         quantize(Int(s), s_fraction, stage.position, watch)};
  const VectorOf<V> from_here{V(stage.place[0]) - here[0], V(stage.place[1]) - here[1],
                              V(stage.place[2]) - here[2]};
  const auto unit = [&](const VectorOf<V>& of) HWY_ATTR {
    return of_length_1<Int, Wide>(stage.root, of, stage.position.fraction, stage.direction, watch);
  };
  TowardOf<V> out{stage.is_point ? unit(from_here) : far, V(0), V(0)};
  if (stage.falls) {
    out.fall = stage.to_viewer ? fall_along<Int>(stage, here, unit(here), watch)
                               : fall_along<Int>(stage, from_here, out.direction, watch);
  }
  return out;
}

// From a fragment to the light, in the field of a map of normals; place: on relief.value, u and v: on
// span.uv. Wide: what the square of its length fits.
template <class Int, class Wide, class Watch>
HWY_INLINE VectorOf<ValueOf<Int>> direction_in_field(const LightStage& stage,
                                                     const VectorOf<ValueOf<Int>>& place, ValueOf<Int> u,
                                                     ValueOf<Int> v, Watch watch) {
  const int grid = std::max({stage.relief.fraction, stage.uv.fraction, 0});
  const int up = grid - stage.relief.fraction;
  const int uv_up = grid - stage.uv.fraction;
  return of_length_1<Int, Wide>(
      stage.root, {(place[0] << up) - (u << uv_up), (place[1] << up) - (v << uv_up), place[2] << up}, grid,
      stage.direction, watch);
}

// A texel as a normal, 255 times as long, in 2^-fraction of texture.mix.
template <class V>
HWY_INLINE VectorOf<V> normal_of(const LightStage& stage, const VectorOf<V>& texel) {
  const int up = std::max(-stage.texel.fraction, 0);
  const V middle(std::int64_t{255} << (stage.texel.fraction + up));
  return {(texel[0] << (up + 1)) - middle, (texel[1] << (up + 1)) - middle, (texel[2] << (up + 1)) - middle};
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
  VectorOf<V> normal;
  V cosine, mirrored, specular, value;
};

// The cosine of a surface that is lit, divided by the lunar law.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> lunar_cosine(const LightStage& stage, ValueOf<Int> cosine, ValueOf<Int> normal_z,
                                     Watch watch) {
  using V = ValueOf<Int>;
  const int grid = stage.lunar.fraction + stage.normal.fraction;
  const V to_viewer = max(V(0) - normal_z, V(0));
  const V t = quantize((constant<Int>(1) << grid) + times<Int>(V(stage.lunar_k), to_viewer), grid,
                       stage.lunar, watch);
  const auto inverse = inverse_of<Int>(stage, t, stage.lunar.fraction, watch);
  return quantize(times<Int>(cosine, inverse.v),
                  inverse.e + V(stage.cosine.fraction + stage.inverse.fraction), stage.cosine, watch);
}
// n: in 2^-n_fraction; of a map's field where the stage has a map. Wide: what the square of its length fits.
template <class Int, class Wide, class Watch>
HWY_INLINE ShineOf<ValueOf<Int>> shine(const LightStage& stage, const VectorOf<ValueOf<Int>>& n,
                                       int n_fraction, const TowardOf<ValueOf<Int>>& toward, Watch watch) {
  using V = ValueOf<Int>;
  ShineOf<V> out;
  const VectorOf<V>& direction = toward.direction;
  out.normal = of_length_1<Int, Wide>(stage.root, n, n_fraction, stage.normal, watch);
  const auto share = [&](std::size_t i) HWY_ATTR { return times<Int>(out.normal[i], direction[i]); };
  out.cosine = quantize(share(0) + share(1) + share(2), stage.normal.fraction + stage.direction.fraction,
                        stage.cosine, watch);
  out.mirrored = V(0);
  // The viewer is at (0, 0, -1); where a map's field sees it, is not known.
  if (!stage.has_map) {
    const int twice = stage.cosine.fraction + stage.normal.fraction - 1;
    const int grid = std::max(stage.direction.fraction, twice);
    out.mirrored = quantize((Int(direction[2]) << (grid - stage.direction.fraction)) -
                                (times<Int>(out.cosine, out.normal[2]) << (grid - twice)),
                            grid, stage.cosine, watch);
  }
  out.specular = V(0);
  const auto is_lit = out.cosine > V(0);
  const auto shines = is_lit & (out.mirrored > V(0));
  if (any(shines)) {
    out.specular = select(shines, highlight_of<Int>(stage, max(out.mirrored, V(0)), watch), V(0));
  }
  V scattered = max(out.cosine, V(0));
  if (stage.is_lunar && !stage.has_map) scattered = lunar_cosine<Int>(stage, scattered, out.normal[2], watch);
  const int sum_grid = std::max(stage.cosine.fraction, stage.specular.fraction);
  const Int sum =
      ((constant<Int>(stage.diffuse) * Int(scattered)) << (sum_grid - stage.cosine.fraction)) +
      ((constant<Int>(stage.highlight) * Int(out.specular)) << (sum_grid - stage.specular.fraction));
  const Int ambient = constant<Int>(stage.ambient);
  if (stage.falls || stage.has_shadow) {
    V near = quantize(sum, stage.value.fraction + sum_grid, stage.value, watch);
    if (stage.has_shadow) {
      near = quantize(times<Int>(near, toward.share), stage.value.fraction + stage.share.fraction,
                      stage.value, watch);
    }
    const int grid = stage.falls ? stage.fall.fraction : 0;
    const Int far = stage.falls ? times<Int>(near, toward.fall) : Int(near);
    out.value = quantize(far + (ambient << grid), stage.value.fraction + grid, stage.value, watch);
  } else {
    out.value = quantize(sum + (ambient << sum_grid), stage.value.fraction + sum_grid, stage.value, watch);
  }
  return out;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
