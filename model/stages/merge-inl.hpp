// SPDX-License-Identifier: Apache-2.0
// merge: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "merge".
#include "model/numeric/quantize-inl.hpp"
#include "model/stages/merge.hpp"

#if defined(BITSPAN_MODEL_STAGES_MERGE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_MERGE_INL
#undef BITSPAN_MODEL_STAGES_MERGE_INL
#else
#define BITSPAN_MODEL_STAGES_MERGE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// 1 on texture.alpha, which can hold it.
HWY_INLINE std::int64_t opaque_alpha(const MergeStage& stage) {
  return std::int64_t{1} << stage.alpha.fraction;
}

// A fragment whose alpha is 1 or more.
template <class V, class Watch>
HWY_INLINE V replaced(const MergeStage& stage, V own, Watch watch) {
  return quantize(own, stage.color_in.fraction, stage.color, watch);
}

// Any fragment; stored: the pixel's code. Alpha above 1 counts as 1, and gives the same as replaced().
template <class Int, class Watch>
HWY_INLINE ValueOf<Int> blended(const MergeStage& stage, ValueOf<Int> own, ValueOf<Int> stored,
                                ValueOf<Int> alpha, Watch watch) {
  using V = ValueOf<Int>;
  const int grid = stage.color_in.fraction > 0 ? stage.color_in.fraction : 0;
  const int a_grid = stage.alpha.fraction;
  const Int dst = Int(stored) << grid;
  const Int difference = (Int(own) << (grid - stage.color_in.fraction)) - dst;
  const Int share(min(alpha, V(1) << a_grid));
  return quantize((dst << a_grid) + difference * share, grid + a_grid, stage.color, watch);
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
