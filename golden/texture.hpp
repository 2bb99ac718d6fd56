// SPDX-License-Identifier: Apache-2.0
// Stage `texture`: finds a fragment's texel, and makes its colour and alpha. [T3, T4, T5]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments, their texture or null, and the draw state for its chroma and alpha tests; appends a record
// for each.
using TextureStage = std::function<void(std::span<const FragmentRecord* const>, const Texture*,
                                        const DrawState&, std::vector<TextureRecord>& out)>;
TextureStage make_texture(Arithmetic arithmetic, const Config& config);

// The same from the levels of a mip chain that lod has chosen per fragment; null for no texture. [T10, T11]
using MipTextureStage = std::function<void(std::span<const FragmentRecord* const>, std::span<const LodRecord>,
                                           const std::vector<Texture>* levels, const DrawState&,
                                           std::vector<TextureRecord>& out)>;
MipTextureStage make_mip_texture(Arithmetic arithmetic, const Config& config);

}  // namespace bitspan::golden
