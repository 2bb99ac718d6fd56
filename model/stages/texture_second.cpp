// SPDX-License-Identifier: Apache-2.0
#include "model/stages/texture_second.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

// Colours above the largest code become that one.
Exact saturated(Exact code) {
  const Exact most{255, 0};
  return sign_of(code - most) > 0 ? most : code;
}

struct Colors {
  Exact first, texel;  // codes
  Exact share;         // the texel's as 0..1
  Exact alpha;         // the texel's
  Exact constant;      // a code
};

Exact combine(TextureOp op, int scale, const Colors& c) {
  const Exact one{1, 0};
  switch (op) {
    case TextureOp::replace:
      return c.texel;
    case TextureOp::modulate:
      return c.first * c.share;
    case TextureOp::decal:
      return c.first * (one - c.alpha) + c.texel * c.alpha;
    case TextureOp::blend:
      return c.first * (one - c.share) + c.constant * c.share;
    case TextureOp::add:
      return saturated(c.first + c.texel);
    case TextureOp::modulate_scaled:
      return saturated(scaled(c.first * c.share, -scale));
  }
  unreachable();
}

}  // namespace

TextureSecondStage prepare_texture_second(const Config& config) {
  TextureSecondStage s;
  s.fetch = prepare_texture(config);
  s.fetch.transparent.reset();
  s.has_lod = has_lod(config);
  s.mixes_levels = mixes_levels(config.mip);
  s.lambda = make_register(config, FormatId::lod_lambda);
  return s;
}

void set_texture_second(TextureSecondStage& stage, const DrawState& state, const Texture* image) {
  stage.image = image;
  stage.fetch.alpha_test = alpha_test_of(state.alpha_func, state.alpha_ref, stage.fetch.alpha);
  stage.op = state.texture1_op;
  stage.scale = state.texture1_scale;
  stage.constant = {state.texture1_red, state.texture1_green, state.texture1_blue};
}

LodRecord second_level(const TextureSecondStage& stage, const LodRecord& lod, int levels) {
  LodRecord out = lod;
  out.level = out.f = 0;
  if (!stage.has_lod) return out;
  hold_level(value_of(lod.lambda, stage.lambda), levels, stage.mixes_levels, stage.fetch.share, out,
             NoObserve{});
  return out;
}

template <class Watch>
bool texture_second(const TextureSecondStage& stage, const MipChain* chain, const FragmentRecord& fragment,
                    const LodRecord& lod, const TextureRecord& first, TextureSecondRecord& out, Watch watch) {
  const LodRecord level = second_level(stage, lod, chain == nullptr ? 1 : static_cast<int>(chain->size()));
  const Sampled found = sample(stage.fetch, *stage.image, chain, fragment, level, watch);
  const std::int64_t v_r = found.texel[0], v_g = found.texel[1], v_b = found.texel[2], v_a = found.texel[3];
  const TextureStage& f = stage.fetch;

  const auto color = [&](std::int64_t of_first, std::int64_t texel, std::int64_t constant) {
    const Exact v = value_of(texel, f.mix);
    Colors c{value_of(of_first, f.color), v, {}, value_of(v_a, f.alpha), {constant, 0}};
    c.share = value_of(quantize_ratio(v, Exact{255, 0}, f.alpha, watch), f.alpha);
    return quantize(combine(stage.op, stage.scale, c), f.color, watch);
  };
  const auto alpha = [&] {
    switch (stage.op) {
      case TextureOp::replace:
        return v_a;
      case TextureOp::decal:
        return first.a;
      case TextureOp::modulate:
      case TextureOp::blend:
      case TextureOp::add:
      case TextureOp::modulate_scaled:
        return quantize(value_of(first.a, f.alpha) * value_of(v_a, f.alpha), f.alpha, watch);
    }
    unreachable();
  };
  const std::int64_t r = color(first.r, v_r, stage.constant[0]);
  const std::int64_t g = color(first.g, v_g, stage.constant[1]);
  const std::int64_t b = color(first.b, v_b, stage.constant[2]);
  const std::int64_t a = alpha();
  const bool killed = a == 0 || !passes_alpha_test(f, a);
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
  return out;
}

template bool texture_second(const TextureSecondStage&, const MipChain*, const FragmentRecord&,
                             const LodRecord&, const TextureRecord&, TextureSecondRecord&, NoObserve);
template bool texture_second(const TextureSecondStage&, const MipChain*, const FragmentRecord&,
                             const LodRecord&, const TextureRecord&, TextureSecondRecord&, Observe);

}  // namespace bitspan::model
