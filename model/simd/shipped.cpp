// SPDX-License-Identifier: Apache-2.0
#include "model/simd/shipped.hpp"

#include <utility>

#include "config/keys.hpp"
#include "config/shipped_configs.hpp"
#include "model/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/simd/shipped.cpp"
#include "hwy/foreach_target.h"
// After foreach_target: each target's own.
#include "model/simd/shade-inl.hpp"
#include "model/simd/spans-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

template <std::size_t i>
struct Shipped {
  static constexpr SpanFormats span = span_formats(shipped::all[i].make());
  static constexpr DepthFormats depth = depth_formats(shipped::all[i].make());
  static constexpr ShadeFormats shade = shade_formats(shipped::all[i].make());
};

template <std::size_t... i>
SpanKernels<std::int32_t> spans_of(int index, std::index_sequence<i...> /*all*/) {
  SpanKernels<std::int32_t> out{};
  ((static_cast<int>(i) == index
        ? void(out = {.draw = draw<std::int32_t, &Shipped<i>::span, &Shipped<i>::depth>,
                      .evaluate = evaluate_span<std::int32_t, &Shipped<i>::span>})
        : void()),
   ...);
  return out;
}
template <std::size_t... i>
ShadeKernels<std::int32_t> shades_of(int index, std::index_sequence<i...> /*all*/) {
  ShadeKernels<std::int32_t> out{};
  ((static_cast<int>(i) == index ? void(out = shade_table<std::int32_t, &Shipped<i>::shade>()) : void()),
   ...);
  return out;
}
using Each = std::make_index_sequence<specialises ? shipped::all.size() : 0>;

}  // namespace

SpanKernels<std::int32_t> shipped_spans(int index) { return spans_of(index, Each()); }
ShadeKernels<std::int32_t> shipped_shades(int index) { return shades_of(index, Each()); }

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bitspan::model {

HWY_EXPORT(shipped_spans);
HWY_EXPORT(shipped_shades);

ShippedIndex shipped_index(const Config& config) {
  // No kernel reads a value that its kind of reciprocal does not use.
  const Config used = used_part(config);
  ShippedIndex out;
  for (std::size_t i = 0; i < shipped::all.size(); ++i) {
    const Config candidate = used_part(shipped::all[i].make());
    if (span_formats(candidate) == span_formats(used) && depth_formats(candidate) == depth_formats(used)) {
      out.spans = static_cast<int>(i);
    }
    if (shade_formats(candidate) == shade_formats(used)) out.shades = static_cast<int>(i);
  }
  return out;
}

SpanKernels<std::int32_t> shipped_span_kernels(VectorTarget target, int index) {
  return on_target(target, [&] { return HWY_DYNAMIC_DISPATCH(shipped_spans)(index); });
}
ShadeKernels<std::int32_t> shipped_shade_kernels(VectorTarget target, int index) {
  return on_target(target, [&] { return HWY_DYNAMIC_DISPATCH(shipped_shades)(index); });
}

}  // namespace bitspan::model
#endif
