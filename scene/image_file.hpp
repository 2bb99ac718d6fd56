// SPDX-License-Identifier: Apache-2.0
// Images of the usual formats but PNG and JPEG, through stb_image.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "scene/scene.hpp"

namespace bitspan {

inline constexpr std::string_view image_formats = "PNG, JPEG, BMP, TGA, GIF or PNM";

// Reads BMP, TGA, the first frame of a GIF, or a binary PNM of 8 bits, known by their contents, into
// 8-bit RGBA as read_texture does. Throws InputError with one line where the file is truncated, corrupt, of
// another format, or larger than the limit.
Texture decode_image(std::span<const std::uint8_t> file, const std::string& origin);

}  // namespace bitspan
