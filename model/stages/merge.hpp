// SPDX-License-Identifier: Apache-2.0
// merge: blends a fragment with the stored colour. docs/numeric-spec.md, "merge" (T5).
#pragma once

#include <array>
#include <cstdint>

#include "config/config.hpp"
#include "engine/records.hpp"
#include "model/numeric/integers.hpp"
#include "model/numeric/quantize.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::model {

// A pair of factors with what is made of the products.
struct BlendEquation {
  BlendFactor src = BlendFactor::src_alpha, dst = BlendFactor::one_minus_src_alpha;
  BlendOp op = BlendOp::add;
  bool operator==(const BlendEquation&) const = default;
};
struct Blend {
  BlendEquation color, alpha{BlendFactor::zero, BlendFactor::one, BlendOp::add};
  std::array<std::int64_t, 4> constant{};
  LogicOp logic = LogicOp::none;
  TargetFormat target = TargetFormat::rgba8888;
  Dither dither = Dither::none;
  TargetRound round = TargetRound::down;
  bool operator==(const Blend&) const = default;
};
Blend blend_of(const DrawState& state);

struct MergeStage {
  bool fits_int64 = false;  // the blend fits int64
  Register color_in, alpha, color;
  Blend blend;                 // of the draw state; the rest is the configuration's
  bool is_plain = true;        // its equations are the first state's: a mix by alpha, and alpha stays
  bool is_narrow = false;      // the target holds fewer bits than the codes have
  bool changes_alpha = false;  // there is a record of merge.alpha
  bool operator==(const MergeStage&) const = default;
};
void set_blend(MergeStage& stage, const Blend& blend);
constexpr MergeStage prepare_merge(const Config& config) {
  MergeStage s;
  s.color_in = make_register(config, FormatId::fog_color);
  s.alpha = make_register(config, FormatId::texture_alpha);
  s.color = make_register(config, FormatId::merge_color);
  const Grid code = integer_grid(8);
  const Grid color = signed_grid(config.format(FormatId::fog_color)) - code;
  const Grid share = signed_grid(config.format(FormatId::texture_alpha));
  s.fits_int64 = fits_int64(color * share + code * share);
  return s;
}

// Whether the new colour depends on the stored one. a: of the fragment, raw, texture.alpha.
bool reads_stored_color(const MergeStage& stage, std::int64_t a);

// stored: the pixel's red, green, blue, alpha before, codes 0..255; the record holds what the target holds
// after, and z.
template <class Watch = NoObserve>
void merge(const MergeStage& stage, const DepthRecord& depth, const TextureRecord& texture,
           const FogRecord& fog, const std::array<std::uint8_t, 4>& stored, MergeRecord& out,
           Watch watch = {});
// The new alpha of the pixel; only where stage.changes_alpha.
MergeAlphaRecord merged_alpha(const MergeStage& stage, const TextureRecord& texture, std::uint8_t stored);
// Red, green, blue and alpha of a pixel as the target holds them; codes as merge makes them, alpha as
// merged_alpha does.
std::array<std::uint8_t, 4> held(const MergeStage& stage, std::array<std::uint8_t, 4> codes, std::int64_t x,
                                 std::int64_t y);
// The clear with the codes that the target holds.
Clear held(const MergeStage& stage, Clear clear);

}  // namespace bitspan::model
