// SPDX-License-Identifier: Apache-2.0
// JPEG, through libjpeg.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.hpp"

namespace bitspan {

// Whether a file begins as a JPEG.
bool is_jpeg(std::span<const std::uint8_t> file);

// Reads a JPEG as read_texture does. Throws InputError with one line where it is truncated, corrupt, or
// larger than the limit.
Texture decode_jpeg(std::span<const std::uint8_t> file, const std::string& origin);

}  // namespace bitspan
