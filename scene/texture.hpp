// SPDX-License-Identifier: Apache-2.0
// Textures from image files.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.hpp"

namespace bitspan {

inline constexpr int texture_size_limit = 16384;  // width or height, texels

// Reads a PNG of any bit depth and colour type, a JPEG, or an image that image_file.hpp names, into 8-bit
// RGBA. Palettes and low depths are expanded, 16 bits are scaled to 8 (rounded to nearest), grey is repeated,
// and alpha is 255 where the file has none; no gamma is applied. Texture::name is `path`. Throws InputError
// with one line where the file is missing, truncated, corrupt, or larger than the limit.
Texture read_texture(const std::string& path);

// Does the same for a file in memory; `origin` stands for the file's name.
Texture decode_texture(std::span<const std::uint8_t> file, const std::string& origin);

}  // namespace bitspan
