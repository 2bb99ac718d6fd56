// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texture.hpp"

#include <array>

#include "model/channels.hpp"
#include "model/numeric/compare.hpp"
#include "model/stages/texture-inl.hpp"

namespace bitspan::model {
namespace {

namespace text = HWY_NAMESPACE;

// 255 a against alpha.ref.
bool passes_alpha_test(const TextureStage& stage, std::int64_t a) {
  if (stage.alpha_func == CompareFunc::always) return true;
  return compares(stage.alpha_func, int128(a) * 255, int128(stage.alpha_ref) << stage.alpha.fraction);
}

template <class Int, class Watch>
bool texture_on(const TextureStage& stage, const Texture* texture, const FragmentRecord& fragment,
                TextureRecord& out, Watch watch) {
  std::array<std::int64_t, channel_count> shade{};
  for (std::size_t c = 0; c < channel_count; ++c) {
    shade[c] = fragment.*fragment_shades[c];
  }
  const auto all =
      text::textured<Int>(stage, text::TextureImage{texture, stage.wrap, text::word_of(stage.border)},
                          fragment.u, fragment.v, shade, watch);
  const auto& [v_r, v_g, v_b, v_a] = all.texel;
  const auto& [r, g, b, a] = all.color;
  const bool killed = all.killed || !passes_alpha_test(stage, a);
  out = {
      fragment.triangle, fragment.x, fragment.y, all.i, all.j, all.ex, all.ey, v_r, v_g, v_b, v_a, r, g, b, a,
      killed ? 1 : 0};
  return !killed;
}

}  // namespace

template <class Watch>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch) {
  return stage.fits_int64 ? texture_on<std::int64_t>(stage, image, fragment, out, watch)
                          : texture_on<int128>(stage, image, fragment, out, watch);
}

template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, Observe);

}  // namespace bitspan::model
