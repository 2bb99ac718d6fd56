// SPDX-License-Identifier: Apache-2.0
// texture: the texel or four of them, the reserved colour, and the product with the fragment's colour.
// docs/numeric-spec.md, "texture" (T3, T4, T5).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/mip_chain.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/quantize.hpp"
#include "model/stages/depth.hpp"
#include "model/stages/lod.hpp"
#include "scene/draw_state.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

// Colours low..high, both included, with red in element 0.
struct ChromaRange {
  ChromaTest test = ChromaTest::none;
  std::array<std::int64_t, 3> low{}, high{255, 255, 255};
  bool operator==(const ChromaRange&) const = default;
};
ChromaRange chroma_of(const DrawState& state);

// The alpha test of a draw state. The codes of two alphas, AS, compare as the alphas do with the least ones,
// raw on texture.alpha, whose code is the reference's or above it.
struct AlphaTest {
  CompareFunc func = CompareFunc::always;
  std::int64_t least = 0, least_above = 0;
  bool operator==(const AlphaTest&) const = default;
};
// alpha: the format texture.alpha.
AlphaTest alpha_test_of(CompareFunc func, std::int64_t ref, const Register& alpha);

struct TextureStage {
  TexelLookup lookup;     // of the draw state
  TexelLookup magnified;  // the same where `range` holds the level of detail to at most 0
  LevelRange range;       // of the draw state
  Rgba border{};
  std::optional<std::array<std::uint8_t, 3>> transparent;
  ChromaRange chroma;       // of the draw state
  bool fits_int64 = false;  // every intermediate fits int64
  Register uv, shade;       // formats of the fragment
  Register frac, mix, color, alpha;
  AlphaTest alpha_test;
  TranslucencyPass pass = TranslucencyPass::all;
  bool kills_zero = true;  // alpha.zero
  bool is_last = true;     // no second unit behind it, so that alpha 0 and the alpha test kill here
  bool mixes_levels = false;
  Register share;  // of the coarser level
  bool operator==(const TextureStage&) const = default;
};
constexpr TextureStage prepare_texture(const Config& config) {
  TextureStage s;
  s.lookup = s.magnified = lookup_of(config);
  s.border = config.border;
  s.transparent = config.transparent;
  s.uv = make_register(config, FormatId::span_uv);
  s.shade = make_register(config, shade_factor(config));
  s.frac = make_register(config, FormatId::texture_frac);
  s.mix = make_register(config, FormatId::texture_mix);
  s.color = make_register(config, FormatId::texture_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  // 1 - Ex has a bit more than Ex; either times a colour, and the sum of two such.
  const Grid share = integer_grid(1) - signed_grid(config.format(FormatId::texture_frac));
  const auto mixes = [&](Grid v) { return fits_int64(v * share + v * share); };
  const Grid mix = signed_grid(config.format(FormatId::texture_mix));
  const Grid alpha = signed_grid(config.format(FormatId::texture_alpha));
  const Grid shade = signed_grid(config.format(shade_factor(config)));
  // u - 1/2, and its floor plus one.
  const Grid below = signed_grid(config.format(FormatId::span_uv)) - Grid{0, 1, true};
  s.mixes_levels = mixes_levels(config.mip);
  s.share = make_register(config, FormatId::lod_frac);
  bool levels_fit = true;
  if (has_lod(config)) {
    const Grid level = signed_grid(config.format(FormatId::lod_frac));
    const Grid rest_of_level = integer_grid(1) - level;
    const Format& uv = config.format(FormatId::span_uv);
    // u - 1/2 on the grid of the deepest level.
    levels_fit = fits_int64(mix * rest_of_level + mix * level) &&
                 fits_int64(alpha * rest_of_level + alpha * level) &&
                 std::max(uv.word, uv.fraction() + max_mip_level) + 2 <= 63;
  }
  s.fits_int64 = levels_fit && mixes(integer_grid(8)) && mixes(mix) && mixes(alpha) &&
                 fits_int64(mix * shade) && fits_int64(alpha * shade) && fits_int64(below);
  return s;
}

// Which alphas a unit kills.
void set_kill(TextureStage& stage, const DrawState& state);

// A comparison that takes the place of a texel, of textures of the format depth: white where it holds.
struct TexelTest {
  const DepthFormats* depth = nullptr;  // null: texels are taken as they are
  DepthFunc func = DepthFunc::lequal;
  std::int64_t z = 0;       // the fragment's code
  std::int64_t failed = 0;  // the texel's word where it does not hold
};
// How a fragment with that level of detail looks texels up; without mip chains both ways are one.
constexpr const TexelLookup& lookup_at(const TextureStage& stage, const LodRecord& lod) {
  return magnifies(stage.range, lod.lambda) ? stage.magnified : stage.lookup;
}

// Where a unit looks, and what it finds there.
struct Sampled {
  std::int64_t i = 0, j = 0, ex = 0, ey = 0;  // as in the record
  std::array<std::int64_t, 4> texel{};        // on texture.mix, alpha on texture.alpha
};
// Looks up a fragment's u and v. chain: the levels of which `level` has chosen; null without mip chains,
// where `level` is not read. The level of detail in it is the unit's own.
template <class Watch = NoObserve>
Sampled sample(const TextureStage& stage, const Texture& image, const MipChain* chain,
               const FragmentRecord& fragment, const LodRecord& level, Watch watch = {},
               const TexelTest& test = {});
// Whether the translucency pass and the alpha test take a fragment; a: raw, texture.alpha.
bool passes_alpha_test(const TextureStage& stage, std::int64_t a);

// A fragment that passed the depth test; texture null for none. True where it lives (not out.killed).
template <class Watch = NoObserve>
bool texture(const TextureStage& stage, const Texture* image, const FragmentRecord& fragment,
             TextureRecord& out, Watch watch = {});
// The same from the levels of the texture's chain that lod has chosen; chain null for no texture.
template <class Watch = NoObserve>
bool texture(const TextureStage& stage, const MipChain* chain, const FragmentRecord& fragment,
             const LodRecord& lod, TextureRecord& out, Watch watch = {});

}  // namespace bitspan::model
