// SPDX-License-Identifier: Apache-2.0
// The second texture unit: its own texel, combined with what the first unit gives. [L7]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments that the first unit did not kill, that unit's records, those of lod where there are mip
// chains, those of project where it is projected, the levels of texture1 (one without chains), and the draw
// state; appends a record for each.
using TextureSecondStage = std::function<void(
    std::span<const FragmentRecord* const>, std::span<const TextureRecord* const>,
    std::span<const LodRecord* const>, std::span<const ProjectRecord>, std::span<const Texture> levels,
    const DrawState&, std::vector<TextureSecondRecord>& out)>;
TextureSecondStage make_texture_second(Arithmetic arithmetic, const Config& config);

// What a combiner makes of a colour code and of the texel's; share: the texel's as 0..1; alpha: the texel's;
// constant: a code; scale: 1, 2 or 4. As the sum of two products.
template <class Real>
struct CombinedColor {
  Real a, by_a, b, by_b;
  bool saturates = false;  // at 255
};
template <class Real>
CombinedColor<Real> combined_color(TextureOp op, Real first, Real texel, Real share, Real alpha,
                                   Real constant, Real scale) {
  switch (op) {
    case TextureOp::replace:
      return {texel, 1, 0, 0};
    case TextureOp::modulate:
      return {first, share, 0, 0};
    case TextureOp::relief:
    case TextureOp::shadow:
      return {first, 1, 0, 0};
    case TextureOp::decal:
      return {first, 1 - alpha, texel, alpha};
    case TextureOp::blend:
      return {first, 1 - share, constant, share};
    case TextureOp::add:
      return {first, 1, texel, 1, true};
    case TextureOp::modulate_scaled:
      return {first, share * scale, 0, 0, true};
  }
  unreachable();
}
// The same of the alphas: one of them, or their product.
constexpr bool keeps_first_alpha(TextureOp op) {
  return op == TextureOp::decal || op == TextureOp::relief || op == TextureOp::shadow;
}
constexpr bool takes_texel_alpha(TextureOp op) { return op == TextureOp::replace; }

}  // namespace bitspan::golden
