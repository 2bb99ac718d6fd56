// SPDX-License-Identifier: Apache-2.0
// The comparisons by number of docs/numeric-spec.md.
#pragma once

#include "config/modes.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::golden {

// "v func reference" holds.
template <class T>
bool holds(CompareFunc func, T v, T reference) {
  using enum CompareFunc;
  const bool below =
      (func == less || func == less_equal || func == not_equal || func == always) && v < reference;
  const bool same =
      (func == equal || func == less_equal || func == greater_equal || func == always) && v == reference;
  const bool above =
      (func == greater || func == greater_equal || func == not_equal || func == always) && v > reference;
  return below || same || above;
}

// Whether a translucency pass takes a fragment of that alpha.
template <class T>
bool takes_alpha(TranslucencyPass pass, const T& alpha) {
  switch (pass) {
    case TranslucencyPass::all:
      return true;
    case TranslucencyPass::opaque:
      return alpha >= 1;
    case TranslucencyPass::candidate:
      return alpha > 0 && alpha < 1;
  }
  unreachable();
}

// Whether a fragment whose alpha is 0 is killed.
inline bool kills_zero(const DrawState& state) { return state.alpha_zero == AlphaZero::kill; }

}  // namespace bitspan::golden
