// SPDX-License-Identifier: Apache-2.0
// The specialised form: the kernels of spans.hpp and shade.hpp with the formats of the shipped configurations
// compiled in. The same text; the compiler folds shifts, limits and modes.
#pragma once

#include <cstdint>

#include "config/config.hpp"
#include "model/simd/shade.hpp"
#include "model/simd/spans.hpp"

namespace bitspan::model {

// Not in a sanitized build: it compiles for minutes, and its text is looked at in the general form.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool specialises = false;
#else
inline constexpr bool specialises = true;
#endif

// The shipped configurations whose compiled-in kernels compute as this configuration asks; -1 for none. The
// formats that are compiled in are compared, and nothing else: a kernel reads all the rest at run time.
struct ShippedIndex {
  int spans = -1, shades = -1;
  bool any() const { return spans >= 0 || shades >= 0; }
};
ShippedIndex shipped_index(const Config& config);

// Only the kernels that are specialised are set: draw and evaluate, and shade.
SpanKernels<std::int32_t> shipped_span_kernels(VectorTarget target, int index);
ShadeKernels<std::int32_t> shipped_shade_kernels(VectorTarget target, int index);

}  // namespace bitspan::model
