// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texture_second.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/texture_second-inl.hpp"

namespace bitspan::model {

TextureSecondStage prepare_texture_second(const Config& config) {
  TextureSecondStage s;
  s.fetch = prepare_texture(config);
  s.fetch.transparent.reset();
  s.has_lod = has_lod(config);
  s.mixes_levels = mixes_levels(config.mip);
  s.lambda = make_register(config, FormatId::lod_lambda);
  s.depth = depth_formats(config);
  return s;
}

void set_texture_second(TextureSecondStage& stage, const DrawState& state, const Texture* image) {
  stage.image = image;
  set_kill(stage.fetch, state);
  stage.fetch.lookup = second_lookup(state);
  stage.compares = is_projected(state) && state.texture1_compare && image != nullptr &&
                   image->format == TexelFormat::depth;
  stage.func = state.texture1_func;
  stage.bias = state.texture1_bias;
  stage.dark_outside = state.texture1_outside == ProjectOutside::dark;
  stage.fetch.magnified = stage.has_lod ? second_magnified(state) : stage.fetch.lookup;
  stage.fetch.range = second_levels(state);
  stage.more_bias = {state.texture1_lod_bias - state.texture_lod_bias, 4};
  stage.op = state.texture1_op;
  stage.scale = state.texture1_scale;
  stage.constant = {state.texture1_red, state.texture1_green, state.texture1_blue};
}

TexelTest comparison(const TextureSecondStage& stage, std::int64_t z) {
  if (!stage.compares) return {};
  const auto& [r, g, b] = stage.constant;
  return {.depth = &stage.depth,
          .func = stage.func,
          .z = std::clamp<std::int64_t>(z + stage.bias, 0, stage.depth.zmax),
          .failed = r | g << 8 | b << 16 | std::int64_t{255} << 24};
}

std::int64_t second_lambda(const TextureSecondStage& stage, std::int64_t lambda) {
  if (stage.more_bias.raw == 0) return lambda;
  return quantize(value_of(lambda, stage.lambda) + stage.more_bias, stage.lambda, NoObserve{});
}

LodRecord second_level(const TextureSecondStage& stage, const LodRecord& lod, int levels) {
  LodRecord out = lod;
  out.level = out.f = 0;
  if (!stage.has_lod) return out;
  out.lambda = second_lambda(stage, lod.lambda);
  hold_level(value_of(out.lambda, stage.lambda), stage.fetch.range, levels, stage.mixes_levels,
             stage.fetch.share, out, NoObserve{});
  return out;
}

namespace {

// What a fragment finds that lies outside of a projected texture.
template <class Watch>
Sampled found_outside(const TextureSecondStage& stage, Watch watch) {
  Sampled out;
  const std::array<std::int64_t, 3> codes = codes_outside(stage);
  for (std::size_t c = 0; c < 3; ++c) out.texel[c] = quantize(codes[c], 0, stage.fetch.mix, watch);
  out.texel[3] = quantize(std::int64_t{1}, 0, stage.fetch.alpha, watch);
  return out;
}

// The same within it.
template <class Watch>
Sampled found_within(const TextureSecondStage& stage, const FragmentRecord& fragment,
                     const ProjectRecord& projected, Watch watch) {
  FragmentRecord at = fragment;
  at.u = projected.s;
  at.v = projected.t;
  // Level 0 of a chain is the texture itself.
  return sample(stage.fetch, *stage.image, nullptr, at, {}, watch, comparison(stage, projected.z));
}

}  // namespace

template <class Watch>
bool texture_second(const TextureSecondStage& stage, const MipChain* chain, const FragmentRecord& fragment,
                    const LodRecord& lod, const TextureRecord& first, const ProjectRecord* projected,
                    TextureSecondRecord& out, Watch watch) {
  LodRecord level;
  Sampled found;
  if (projected == nullptr) {
    level = second_level(stage, lod, chain == nullptr ? 1 : static_cast<int>(chain->size()));
    found = sample(stage.fetch, *stage.image, chain, fragment, level, watch);
  } else if (projected->inside == 0) {
    found = found_outside(stage, watch);
  } else {
    found = found_within(stage, fragment, *projected, watch);
  }
  const auto& [v_r, v_g, v_b, v_a] = found.texel;
  const TextureStage& f = stage.fetch;
  const auto share = [&](std::int64_t v) { return quantize_ratio(v, 255, -f.mix.fraction, f.alpha, watch); };
  std::array<std::int64_t, 4> color{first.r, first.g, first.b, first.a};
  HWY_NAMESPACE::combine<int128>(stage, found.texel, false, share, color, watch);
  const auto& [r, g, b, a] = color;
  const bool killed = (f.kills_zero && a == 0) || !passes_alpha_test(f, a);
  out = {fragment.triangle,
         fragment.x,
         fragment.y,
         level.level,
         level.f,
         found.i,
         found.j,
         found.ex,
         found.ey,
         v_r,
         v_g,
         v_b,
         v_a,
         r,
         g,
         b,
         a,
         killed ? 1 : 0};
  return !killed;
}

TextureRecord combined(const TextureRecord& first, const TextureSecondRecord& second) {
  TextureRecord out = first;
  out.r = second.r;
  out.g = second.g;
  out.b = second.b;
  out.a = second.a;
  out.killed = second.killed;
  // A map of normals is for light.
  out.texel_r = second.texel_r;
  out.texel_g = second.texel_g;
  out.texel_b = second.texel_b;
  return out;
}

template bool texture_second(const TextureSecondStage&, const MipChain*, const FragmentRecord&,
                             const LodRecord&, const TextureRecord&, const ProjectRecord*,
                             TextureSecondRecord&, NoObserve);
template bool texture_second(const TextureSecondStage&, const MipChain*, const FragmentRecord&,
                             const LodRecord&, const TextureRecord&, const ProjectRecord*,
                             TextureSecondRecord&, Observe);

}  // namespace bitspan::model
