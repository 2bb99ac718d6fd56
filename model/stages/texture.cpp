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

std::array<std::int64_t, channel_count> shades_of(const FragmentRecord& fragment) {
  std::array<std::int64_t, channel_count> shade{};
  for (std::size_t c = 0; c < channel_count; ++c) {
    shade[c] = fragment.*fragment_shades[c];
  }
  return shade;
}

bool record(const TextureStage& stage, const FragmentRecord& fragment,
            const text::Textured<std::int64_t>& all, TextureRecord& out) {
  const auto& [v_r, v_g, v_b, v_a] = all.texel;
  const auto& [r, g, b, a] = all.color;
  const bool killed = all.killed || !passes_alpha_test(stage, a);
  out = {
      fragment.triangle, fragment.x, fragment.y, all.i, all.j, all.ex, all.ey, v_r, v_g, v_b, v_a, r, g, b, a,
      killed ? 1 : 0};
  return !killed;
}

template <class Int, class Watch>
bool texture_on(const TextureStage& stage, const Texture* texture, const FragmentRecord& fragment,
                TextureRecord& out, Watch watch) {
  return record(
      stage, fragment,
      text::textured<Int>(stage, text::TextureImage{texture, stage.wrap, text::word_of(stage.border)},
                          fragment.u, fragment.v, shades_of(fragment), watch),
      out);
}

template <class Int, class Watch>
bool texture_on_levels(const TextureStage& stage, const MipChain* chain, const FragmentRecord& fragment,
                       const LodRecord& lod, TextureRecord& out, Watch watch) {
  const auto at_level = [&](std::int64_t level) {
    const Texture* image = chain == nullptr ? nullptr : &(*chain)[static_cast<std::size_t>(level)];
    return text::sampled<Int>(stage, text::TextureImage{image, stage.wrap, text::word_of(stage.border)},
                              fragment.u, fragment.v, stage.uv.fraction + static_cast<int>(level), watch);
  };
  auto all = at_level(lod.level);
  // Where f is 0 the mix is the level's own value.
  if (stage.mixes_levels && lod.f != 0) {
    const auto coarser = at_level(lod.level + 1);
    for (std::size_t c = 0; c < channel_count; ++c) {
      const Register& r = c < 3 ? stage.mix : stage.alpha;
      all.texel[c] =
          text::blend<Int>(all.texel[c], coarser.texel[c], lod.f, stage.share.fraction, r.fraction, r, watch);
    }
  }
  text::colour<Int>(stage, shades_of(fragment), all, watch);
  return record(stage, fragment, all, out);
}

}  // namespace

template <class Watch>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch) {
  return stage.fits_int64 ? texture_on<std::int64_t>(stage, image, fragment, out, watch)
                          : texture_on<int128>(stage, image, fragment, out, watch);
}

template <class Watch>
bool texture(const TextureStage& stage, const MipChain* chain, const FragmentRecord& fragment,
             const LodRecord& lod, TextureRecord& out, Watch watch) {
  return stage.fits_int64 ? texture_on_levels<std::int64_t>(stage, chain, fragment, lod, out, watch)
                          : texture_on_levels<int128>(stage, chain, fragment, lod, out, watch);
}

template bool texture(const TextureStage&, const MipChain*, const FragmentRecord&, const LodRecord&,
                      TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const MipChain*, const FragmentRecord&, const LodRecord&,
                      TextureRecord&, Observe);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, Observe);

}  // namespace bitspan::model
