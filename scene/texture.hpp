// PNG textures.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.hpp"

namespace bitspan {

inline constexpr int texture_size_limit = 16384;  // width or height, texels

// Any bit depth and colour type becomes 8-bit RGBA: palettes and low depths expanded, 16 bits scaled to 8
// (rounded to nearest), grey repeated, alpha 255 where the file has none; no gamma is applied. Texture::name
// is `path`. Throws InputError, one line, where the file is missing, truncated, corrupt, or larger than the
// limit.
Texture read_texture(const std::string& path);

// The same of a PNG in memory; `origin` stands for the file's name.
Texture decode_texture(std::span<const std::uint8_t> png, const std::string& origin);

}  // namespace bitspan
