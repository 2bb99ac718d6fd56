// SPDX-License-Identifier: Apache-2.0
// Which reader an image file goes to: its contents decide, never its name.
#pragma once

#include <string>
#include <string_view>

#include "scene/image_bytes.hpp"

namespace bitspan {

inline constexpr std::string_view image_formats = "PNG, JPEG, BMP, TGA, GIF or PNM";
inline constexpr std::size_t image_head_bytes = 64;  // what the choice needs of a file

// Throws InputError with one line, which names the format where it is a known one, if `head`, the file's
// first bytes, are of none that is read.
void check_image_format(ByteSpan head, const std::string& origin);

// Reads any of the formats as read_texture does. Throws InputError with one line where the file is truncated,
// corrupt, of another format, or larger than the limit.
Texture decode_image(ByteSpan file, const std::string& origin);

}  // namespace bitspan
