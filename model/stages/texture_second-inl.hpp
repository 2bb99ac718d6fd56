// SPDX-License-Identifier: Apache-2.0
// texture.second: the text that one fragment and lanes of fragments share. docs/numeric-spec.md,
// "texture_second".
#include "model/numeric/quantize-inl.hpp"
#include "model/numeric/scaled-inl.hpp"
#include "model/stages/texture-inl.hpp"
#include "model/stages/texture_second.hpp"

#if defined(BITSPAN_MODEL_STAGES_TEXTURE_SECOND_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_STAGES_TEXTURE_SECOND_INL
#undef BITSPAN_MODEL_STAGES_TEXTURE_SECOND_INL
#else
#define BITSPAN_MODEL_STAGES_TEXTURE_SECOND_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {

// A colour before it is narrowed; share: F, on texture.alpha.
template <class Int>
HWY_INLINE Scaled<Int> combined_color(const TextureSecondStage& stage, ValueOf<Int> of_first, ValueOf<Int> v,
                                      ValueOf<Int> v_alpha, ValueOf<Int> share, std::int64_t constant) {
  const TextureStage& f = stage.fetch;
  const Scaled<Int> first{Int(of_first), f.color.fraction};
  const Scaled<Int> texel{Int(v), f.mix.fraction};
  const Scaled<Int> factor{Int(share), f.alpha.fraction};
  const Scaled<Int> alpha{Int(v_alpha), f.alpha.fraction};
  const Scaled<Int> most{Int(255), 0};
  switch (stage.op) {
    case TextureOp::replace:
      return texel;
    case TextureOp::modulate:
      return first * factor;
    case TextureOp::relief:
    case TextureOp::shadow:
      return first;
    case TextureOp::decal:
      return first * one_minus(alpha) + texel * alpha;
    case TextureOp::blend:
      return first * one_minus(factor) + Scaled<Int>{Int(static_cast<ElementOf<Int>>(constant)), 0} * factor;
    case TextureOp::add:
      return smaller(first + texel, most);
    case TextureOp::modulate_scaled: {
      const Scaled<Int> product = first * factor;
      return smaller({product.raw, product.fraction - stage.scale}, most);
    }
  }
  unreachable();
}

// Colour and alpha of the first unit, combined with the texel of this one; share(v): Q[texture.alpha](v /
// 255) of a colour on texture.mix. grey: red, green and blue of the texel are equal.
template <class Int, class Share, class Watch>
HWY_INLINE void combine(const TextureSecondStage& stage, const std::array<ValueOf<Int>, 4>& texel, bool grey,
                        const Share& share, std::array<ValueOf<Int>, 4>& color, Watch watch) {
  const TextureStage& f = stage.fetch;
  ValueOf<Int> factor = share(texel[0]);
  for (std::size_t c = 0; c < 3; ++c) {
    if (c > 0 && !grey) factor = share(texel[c]);
    const Scaled<Int> all =
        combined_color<Int>(stage, color[c], texel[c], texel[3], factor, stage.constant[c]);
    color[c] = quantize(all.raw, all.fraction, f.color, watch);
  }
  switch (stage.op) {
    case TextureOp::replace:
      color[3] = texel[3];
      break;
    case TextureOp::decal:
    case TextureOp::relief:
    case TextureOp::shadow:
      break;
    case TextureOp::modulate:
    case TextureOp::blend:
    case TextureOp::add:
    case TextureOp::modulate_scaled:
      color[3] = quantize(Int(color[3]) * Int(texel[3]), 2 * f.alpha.fraction, f.alpha, watch);
      break;
  }
}

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
