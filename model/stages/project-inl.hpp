// SPDX-License-Identifier: Apache-2.0
// project: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "project".
#include "model/numeric/reciprocal-inl.hpp"
#include "model/stages/project.hpp"
#include "model/stages/span-inl.hpp"

#if defined(BITSPAN_MODEL_STAGES_PROJECT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_PROJECT_INL
#undef BITSPAN_MODEL_STAGES_PROJECT_INL
#else
#define BITSPAN_MODEL_STAGES_PROJECT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// A constant of the view on its grid.
template <class Int>
HWY_INLINE Int view_constant(int128 x) {
  if constexpr (std::is_same_v<Int, Lanes>) {
    return Lanes(static_cast<std::int64_t>(x));
  } else {
    return Int(x);
  }
}

// 1 / W, as m 2^-e, and the fraction bits that m has then.
template <class V>
struct InverseOfW {
  V m, e, fraction;
};
// Where w is positive, and anything elsewhere. Int, here and below: int128, Lanes or WideLanes, which every
// intermediate fits.
template <class Int, class Watch>
HWY_INLINE InverseOfW<ValueOf<Int>> inverse_of_w(const ProjectStage& stage, ValueOf<Int> w, Watch watch) {
  using V = ValueOf<Int>;
  const auto inverse = reciprocal(stage.reciprocal.formats(), stage.reciprocal.table().data(),
                                  DepthSumOf<Int>(w), stage.xyw.fraction, watch);
  return {inverse.m, V(inverse.e), V(inverse.e) + V(stage.reciprocal.output().fraction)};
}

// s of X, t of Y.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> place_of(const ProjectStage& stage, ValueOf<Int> value,
                                 const InverseOfW<ValueOf<Int>>& by, Watch watch) {
  return quantize(times<Int>(value, by.m), by.fraction + ValueOf<Int>(stage.xyw.fraction), stage.uv, watch);
}

// h + B of the viewer, on its grid.
template <class Int>
HWY_INLINE DepthSumOf<Int> depth_sum(const ProjectStage& stage, ValueOf<Int> h) {
  return (DepthSumOf<Int>(h) << stage.q.h_up) + depth_constant<Int>(stage.q.b);
}
// (h + B) / W
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> ratio_of(const ProjectStage& stage, DepthSumOf<Int> q,
                                 const InverseOfW<ValueOf<Int>>& by, Watch watch) {
  const ValueOf<Int> fraction = by.fraction + ValueOf<Int>(stage.q.fraction);
  if constexpr (std::is_same_v<Int, int128>) {
    return quantize(q * by.m, fraction, stage.ratio, watch);
  } else {
    return quantize(times<Int>(q, by.m), fraction, stage.ratio, watch);
  }
}
// h as the projector sees it.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> far_h_of(const ProjectStage& stage, ValueOf<Int> ratio, Watch watch) {
  const ValueOf<Int> a(static_cast<std::int64_t>(stage.a.raw));
  return quantize((times<Int>(a, ratio) << stage.product_up()) -
                      view_constant<Int>(on_grid(stage.projector_b, stage.h_grid())),
                  stage.h_grid(), stage.far_h, watch);
}
// Its depth code.
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> code_of(const ProjectStage& stage, ValueOf<Int> far_h, Watch watch) {
  const int grid = std::max(stage.far_h.fraction, 0);
  const Int far = Int(far_h) << (grid - stage.far_h.fraction);
  return quantize(stage.is_complement ? view_constant<Int>(on_grid(stage.zmax, grid)) - far : far, grid,
                  stage.z, watch);
}

// Whether floor(at) lies in 0 .. size - 1. Int: int128 or Lanes, which the floor fits.
template <class Int>
HWY_INLINE auto lies_within(const ProjectStage& stage, Int at, int size) {
  const Int place = stage.uv.fraction >= 0 ? at >> stage.uv.fraction : at << -stage.uv.fraction;
  return (place >= Int(0)) & (place < Int(size));
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
