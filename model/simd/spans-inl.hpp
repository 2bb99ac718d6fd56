// SPDX-License-Identifier: Apache-2.0
// The kernels of spans.hpp, for formats read at run time (fixed null) or compiled in.
#include "model/simd/spans/draw-inl.hpp"
#include "model/simd/spans/draw_any-inl.hpp"
#include "model/simd/spans/every_fragment-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_SPANS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_SPANS_INL
#undef BITSPAN_MODEL_SIMD_SPANS_INL
#else
#define BITSPAN_MODEL_SIMD_SPANS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

template <class T, const SpanFormats* fixed, const DepthFormats* fixed_depth>
SpanKernels<T> table_of() {
  return {draw<T, fixed, fixed_depth>, draw_any<T>, draw_traced<T>, evaluate_span<T, fixed>,
          evaluate_span_observed<T>};
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
