// SPDX-License-Identifier: Apache-2.0
// light: the text that one fragment and lanes of fragments share. docs/numeric-spec.md, "light".
#include "model/numeric/quantize-inl.hpp"
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

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
