// SPDX-License-Identifier: Apache-2.0
#include "model/simd/spans.hpp"

#include "config/modes.hpp"
#include "model/numeric/integers.hpp"
#include "model/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/simd/spans.cpp"
#include "hwy/foreach_target.h"
#include "model/simd/spans-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

SpanKernels<std::int32_t> span_table32() { return table_of<std::int32_t, nullptr, nullptr>(); }
SpanKernels<std::int64_t> span_table64() { return table_of<std::int64_t, nullptr, nullptr>(); }

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bitspan::model {

HWY_EXPORT(span_table32);
HWY_EXPORT(span_table64);

template <>
SpanKernels<std::int32_t> span_kernels(VectorTarget target) {
  return on_target(target, [&] { return HWY_DYNAMIC_DISPATCH(span_table32)(); });
}
template <>
SpanKernels<std::int64_t> span_kernels(VectorTarget target) {
  return on_target(target, [&] { return HWY_DYNAMIC_DISPATCH(span_table64)(); });
}

const char* spans_refusal(const Config& config) {
  if (has_plane_rows(config.perspective) &&
      (has_lod(config) || has_distance(config) || has_dz(config.depth_code))) {
    return "rows of constant depth are not in lanes with texture.mip, fog by distance or depth.code = "
           "float_dz";
  }
  if (has_subspans(config)) return "perspective.subspan_bits is not in lanes";
  const auto of = [&](FormatId id) { return signed_grid(config.format(id)); };
  return !has_plane_rows(config.perspective) &&
                 aligned(of(FormatId::span_h) + of(FormatId::setup_b), 0).bits() > 63
             ? "h + B needs more than 63 bits"
             : nullptr;
}

}  // namespace bitspan::model
#endif
