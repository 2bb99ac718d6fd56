// SPDX-License-Identifier: Apache-2.0
// fog: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "fog".
#include "model/numeric/reciprocal-inl.hpp"
#include "model/stages/fog.hpp"

#if defined(BITSPAN_MODEL_STAGES_FOG_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_FOG_INL
#undef BITSPAN_MODEL_STAGES_FOG_INL
#else
#define BITSPAN_MODEL_STAGES_FOG_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// fog.mode = "none".
template <class V, class Watch>
HWY_INLINE V unfogged(const FogFormats& formats, V own, Watch watch) {
  return quantize(own, formats.color_in.fraction, formats.color, watch);
}

// The mix of the fragment's own colour with the fog's; code: the fog colour's channel, 0..255.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> fogged(const FogFormats& formats, ValueOf<Int> own, int code, ValueOf<Int> factor,
                               Watch watch) {
  const int grid = formats.color_in.fraction > 0 ? formats.color_in.fraction : 0;
  const int f_grid = formats.factor.fraction;  // not negative: the format can hold 1
  const Int own_code = Int(code) << grid;
  const Int difference = (Int(own) << (grid - formats.color_in.fraction)) - own_code;
  return quantize((own_code << f_grid) + difference * Int(factor), grid + f_grid, formats.color, watch);
}

template <class V>
struct LinearFog {
  V recip_m, recip_e, factor;
};
// Linear fog's factor. Int: what h + B is formed in; int128 or Lanes.
template <class Int, class Watch>
HWY_INLINE LinearFog<ValueOf<Int>> linear_fog(const FogStage& stage, const FogFormats& formats,
                                              ValueOf<Int> h, Watch watch) {
  using V = ValueOf<Int>;
  using Int128 = typename WideOf<V>::type;
  const Int q = (Int(h) << stage.q.h_up) + constant<Int>(stage.q.b);
  const auto inverse =
      reciprocal(formats.reciprocal, stage.reciprocal.table().data(), q, stage.q.fraction, watch);
  // 1 - scale m 2^-e on the product's grid, or on integers where that is coarser.
  const V fraction = V(inverse.e) + V(formats.scale_fraction + formats.reciprocal.output.fraction);
  const V up = max(V(0) - fraction, V(0));
  const Int128 share = times<Int128>(constant<V>(stage.scale.raw), inverse.m) << up;
  const Int128 rest = (Int128(V(1)) << (fraction + up)) - share;
  return {inverse.m, V(inverse.e), quantize(rest, fraction + up, formats.factor, watch)};
}

// The step of depth of h: its top bits, within the table.
template <class V>
HWY_INLINE V fog_step(const FogStage& stage, V h) {
  const V last(stage.last_step);
  const V held = max(h, V(0));
  if (stage.step_shift >= 0) return min(held >> stage.step_shift, last);
  return min(min(held, last) << -stage.step_shift, last);
}

// The entry of the table.
template <class V>
HWY_INLINE V fog_index(const FogStage& stage, V step, V zone) {
  return (step << stage.zones.bits) + zone;
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
