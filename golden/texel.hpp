// SPDX-License-Identifier: Apache-2.0
// What the bits of a texel stand for, by the formulas of docs/numeric-spec.md, "texel formats", in numbers.
#pragma once

#include <array>
#include <cstdint>

#include "scene/scene.hpp"

namespace bitspan::golden {

using TexelCodes = std::array<std::uint8_t, 4>;  // red, green, blue, alpha

// The texel (i, j) of a texture, which has it.
TexelCodes fetch_texel(const Texture& texture, std::int64_t i, std::int64_t j);

// The word of texel (i, j) of a texture of the format `depth`.
std::uint64_t depth_word(const Texture& texture, std::int64_t i, std::int64_t j);

// E_n(c) for the 2^n values of n bits.
double expanded(std::uint64_t c, double values);

}  // namespace bitspan::golden
