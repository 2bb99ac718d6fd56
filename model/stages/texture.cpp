// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texture.hpp"

#include <array>
#include <limits>

#include "model/channels.hpp"
#include "model/stages/texture-inl.hpp"

namespace bitspan::model {
namespace {

namespace text = HWY_NAMESPACE;

// f.operator()<Int>(), Int being as wide as the values of the stage need.
template <class F>
auto with_integers(const TextureStage& stage, F f) {
  return stage.fits_int64 ? f.template operator()<std::int64_t>() : f.template operator()<int128>();
}

std::array<std::int64_t, channel_count> shades_of(const FragmentRecord& fragment) {
  std::array<std::int64_t, channel_count> shade{};
  for (std::size_t c = 0; c < channel_count; ++c) {
    shade[c] = fragment.*fragment_shades[c];
  }
  return shade;
}

// The product of what was found with the fragment's colour, and its record.
template <class Int, class Watch>
bool finish(const TextureStage& stage, const FragmentRecord& fragment, text::Textured<std::int64_t> all,
            TextureRecord& out, Watch watch) {
  const bool transparent = all.killed;
  text::colour<Int>(stage, shades_of(fragment), all, watch);
  const auto& [v_r, v_g, v_b, v_a] = all.texel;
  const auto& [r, g, b, a] = all.color;
  const bool killed = stage.is_last ? all.killed || !passes_alpha_test(stage, a) : transparent;
  out = {
      fragment.triangle, fragment.x, fragment.y, all.i, all.j, all.ex, all.ey, v_r, v_g, v_b, v_a, r, g, b, a,
      killed ? 1 : 0};
  return !killed;
}

template <class Int, class Watch>
text::Textured<std::int64_t> found(const TextureStage& stage, const Texture* texture,
                                   const FragmentRecord& fragment, Watch watch, const TexelTest& test = {}) {
  return text::sampled<Int>(stage,
                            text::TextureImage{texture, stage.lookup, text::word_of(stage.border), test},
                            fragment.u, fragment.v, {stage.uv.fraction, stage.uv.fraction}, watch);
}

template <class Int, class Watch>
text::Textured<std::int64_t> found_in_levels(const TextureStage& stage, const MipChain* chain,
                                             const FragmentRecord& fragment, const LodRecord& lod,
                                             Watch watch) {
  const TexelLookup& by = lookup_at(stage, lod);
  const auto at_level = [&](std::int64_t level) {
    const Texture* image = chain == nullptr ? nullptr : &(*chain)[static_cast<std::size_t>(level)];
    const Halvings halved =
        chain == nullptr ? Halvings{} : halvings(chain->front().width, chain->front().height, level);
    return text::sampled<Int>(stage, text::TextureImage{image, by, text::word_of(stage.border)}, fragment.u,
                              fragment.v,
                              {stage.uv.fraction + halved.across, stage.uv.fraction + halved.down}, watch);
  };
  auto all = at_level(lod.level);
  // Where f is 0 the mix is the level's own value.
  if (stage.mixes_levels && lod.f != 0) {
    text::mix_level<Int>(stage, at_level(lod.level + 1), lod.f, all, watch);
  }
  return all;
}

}  // namespace

AlphaTest alpha_test_of(CompareFunc func, std::int64_t ref, const Register& alpha) {
  // floor(255 a + 1/2) >= code where a >= (2 code - 1) / 510.
  const auto least = [&](std::int64_t code) {
    if (code <= 0) return alpha.min;
    if (code > 255) return std::numeric_limits<std::int64_t>::max();
    const int grid = std::max(alpha.fraction, 0);
    const int128 on_grid = (((int128{2 * code - 1}) << grid) + 509) / 510;
    const int down = grid - alpha.fraction;
    return static_cast<std::int64_t>((on_grid + (int128{1} << down) - 1) >> down);
  };
  return {func, least(ref), least(ref + 1)};
}

void set_kill(TextureStage& stage, const DrawState& state) {
  stage.pass = state.translucency_pass;
  stage.alpha_test = alpha_test_of(state.alpha_func, state.alpha_ref, stage.alpha);
  stage.kills_zero = state.alpha_zero == AlphaZero::kill;
}

namespace {

bool takes_alpha(TranslucencyPass pass, const Register& alpha, std::int64_t a) {
  switch (pass) {
    case TranslucencyPass::all:
      return true;
    case TranslucencyPass::opaque:
      return a >= std::int64_t{1} << alpha.fraction;
    case TranslucencyPass::candidate:
      return a > 0 && a < std::int64_t{1} << alpha.fraction;
  }
  unreachable();
}

}  // namespace

bool passes_alpha_test(const TextureStage& stage, std::int64_t a) {
  return takes_alpha(stage.pass, stage.alpha, a) && text::passes_alpha_test(stage.alpha, stage.alpha_test, a);
}

ChromaRange chroma_of(const DrawState& s) {
  return {s.chroma_test,
          {s.chroma_low_red, s.chroma_low_green, s.chroma_low_blue},
          {s.chroma_high_red, s.chroma_high_green, s.chroma_high_blue}};
}

template <class Watch>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch) {
  return with_integers(stage, [&]<class Int>() {
    return finish<Int>(stage, fragment, found<Int>(stage, image, fragment, watch), out, watch);
  });
}

template <class Watch>
bool texture(const TextureStage& stage, const MipChain* chain, const FragmentRecord& fragment,
             const LodRecord& lod, TextureRecord& out, Watch watch) {
  return with_integers(stage, [&]<class Int>() {
    return finish<Int>(stage, fragment, found_in_levels<Int>(stage, chain, fragment, lod, watch), out, watch);
  });
}

template <class Watch>
Sampled sample(const TextureStage& stage, const Texture& image, const MipChain* chain,
               const FragmentRecord& fragment, const LodRecord& level, Watch watch, const TexelTest& test) {
  return with_integers(stage, [&]<class Int>() {
    const text::Textured<std::int64_t> all = chain == nullptr
                                                 ? found<Int>(stage, &image, fragment, watch, test)
                                                 : found_in_levels<Int>(stage, chain, fragment, level, watch);
    return Sampled{all.i, all.j, all.ex, all.ey, all.texel};
  });
}

template Sampled sample(const TextureStage&, const Texture&, const MipChain*, const FragmentRecord&,
                        const LodRecord&, NoObserve, const TexelTest&);
template Sampled sample(const TextureStage&, const Texture&, const MipChain*, const FragmentRecord&,
                        const LodRecord&, Observe, const TexelTest&);
template bool texture(const TextureStage&, const MipChain*, const FragmentRecord&, const LodRecord&,
                      TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const MipChain*, const FragmentRecord&, const LodRecord&,
                      TextureRecord&, Observe);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, NoObserve);
template bool texture(const TextureStage&, const Texture*, const FragmentRecord&, TextureRecord&, Observe);

}  // namespace bitspan::model
