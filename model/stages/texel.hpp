// SPDX-License-Identifier: Apache-2.0
// What the bits of a texel stand for, in integers. docs/numeric-spec.md, "texel formats".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "scene/scene.hpp"

namespace bitspan::model {

using TexelCodes = std::array<std::uint8_t, 4>;  // red, green, blue, alpha

// E_n(c): the n = `bits` bits of c repeated from the top, in 8 bits.
constexpr int repeated(int c, int bits) {
  int out = 0;
  for (int at = 8 - bits; at > -bits; at -= bits) out |= at >= 0 ? c << at : c >> -at;
  return out;
}

// The texel in column i and row j of a block; table: the format's, as in Texture. Not of a procedural format.
TexelCodes decode(TexelFormat format, const std::uint8_t* block, int i, int j,
                  std::span<const std::int16_t> table);

// The texel (i, j) of a texture whose format is procedural.
TexelCodes computed_texel(const Texture& texture, std::int64_t i, std::int64_t j);

// The texel (i, j) of a texture, which has it.
inline TexelCodes texel_of(const Texture& texture, std::int64_t i, std::int64_t j) {
  if (texture.format == TexelFormat::rgba8888) {
    const std::uint8_t* p = texture.rgba.data() + 4 * (j * texture.width + i);
    return {p[0], p[1], p[2], p[3]};
  }
  if (is_procedural(texture.format)) return computed_texel(texture, i, j);
  const TexelLayout layout = texel_layout(texture.format);
  return decode(texture.format, texture.raw.data() + block_at(texture.format, texture.width, i, j),
                static_cast<int>(i % layout.block_width), static_cast<int>(j % layout.block_height),
                texture.table);
}

// The word of texel (i, j) of a texture of the format depth, which has it.
inline std::int64_t depth_word(const Texture& texture, std::int64_t i, std::int64_t j) {
  const std::uint8_t* p = texture.raw.data() + block_at(TexelFormat::depth, texture.width, i, j);
  return p[0] | p[1] << 8 | p[2] << 16 | std::int64_t{p[3]} << 24;
}

}  // namespace bitspan::model
