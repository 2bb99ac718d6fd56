// SPDX-License-Identifier: Apache-2.0
// distance: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "distance".
#include "model/numeric/reciprocal-inl.hpp"
#include "model/stages/distance.hpp"

#if defined(BITSPAN_MODEL_STAGES_DISTANCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_DISTANCE_INL
#undef BITSPAN_MODEL_STAGES_DISTANCE_INL
#else
#define BITSPAN_MODEL_STAGES_DISTANCE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

template <class V>
struct DistancePoint {
  V recip_m, recip_e, s;
};

// The distance along the axis. Int: what h + B is formed in; int128 or Lanes.
template <class Int, class Watch>
HWY_INLINE DistancePoint<ValueOf<Int>> distance_point(const DistanceStage& stage, ValueOf<Int> h,
                                                      Watch watch) {
  using V = ValueOf<Int>;
  const Int q = (Int(h) << stage.q.h_up) + constant<Int>(stage.q.b);
  const ReciprocalUnit& unit = stage.reciprocal;
  const auto inverse = reciprocal(unit.formats(), unit.table().data(), q, stage.q.fraction, watch);
  const V fraction = V(inverse.e) + V(stage.a.fraction + unit.output().fraction);
  const auto rounded = [&]<class Product>() HWY_ATTR {
    return quantize(times<Product>(constant<V>(stage.a.raw), inverse.m), fraction, stage.s, watch);
  };
  if constexpr (std::is_same_v<Int, Lanes>) {
    if (stage.fits_int64) return {inverse.m, V(inverse.e), rounded.template operator()<Lanes>()};
  }
  return {inverse.m, V(inverse.e), rounded.template operator()<typename WideOf<V>::type>()};
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
