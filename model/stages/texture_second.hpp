// SPDX-License-Identifier: Apache-2.0
// texture.second: the second texture unit, and how its texel is combined with what the first unit gives.
// docs/numeric-spec.md, "texture_second" (L7).
#pragma once

#include <array>
#include <cstdint>

#include "model/stages/depth.hpp"
#include "model/stages/lod.hpp"
#include "model/stages/texture.hpp"

namespace bitspan::model {

struct TextureSecondStage {
  const Texture* image = nullptr;  // null: the unit is off
  TextureStage fetch;              // as the first unit's; it has no transparent texels
  bool has_lod = false, mixes_levels = false;
  Exact more_bias;  // than the first unit's
  Register lambda;
  DepthFormats depth;  // of what is compared
  bool compares = false;
  DepthFunc func = DepthFunc::lequal;
  std::int64_t bias = 0;
  bool dark_outside = false;
  TextureOp op = TextureOp::modulate;
  int scale = 0;
  std::array<std::int64_t, 3> constant{};  // codes

  bool is_on() const { return image != nullptr; }
};
TextureSecondStage prepare_texture_second(const Config& config);
// image: texture1's, null where the unit is off.
void set_texture_second(TextureSecondStage& stage, const DrawState& state, const Texture* image);

// The comparison with a projector's depth code, in the place of texels where the unit compares; its code is z
// with the bias.
TexelTest comparison(const TextureSecondStage& stage, std::int64_t z);

// What a fragment finds that lies outside of a projected texture.
constexpr std::array<std::int64_t, 3> codes_outside(const TextureSecondStage& stage) {
  return stage.dark_outside ? stage.constant : std::array<std::int64_t, 3>{255, 255, 255};
}

// This unit's level of detail from the first one's, both raw.
std::int64_t second_lambda(const TextureSecondStage& stage, std::int64_t lambda);
// lod's record with this unit's level of detail, and its level and fraction in a chain of so many levels;
// without mip chains it is not read.
LodRecord second_level(const TextureSecondStage& stage, const LodRecord& lod, int levels);

// A fragment that the first unit did not kill, while the unit is on; chain: of the unit's texture, null
// without mip chains; projected: where its coordinates are a projector's, else null. True where it lives.
template <class Watch = NoObserve>
bool texture_second(const TextureSecondStage& stage, const MipChain* chain, const FragmentRecord& fragment,
                    const LodRecord& lod, const TextureRecord& first, const ProjectRecord* projected,
                    TextureSecondRecord& out, Watch watch = {});

// The first unit's record with the colour, alpha and fate behind the second one: what fog and merge take.
TextureRecord combined(const TextureRecord& first, const TextureSecondRecord& second);

}  // namespace bitspan::model
