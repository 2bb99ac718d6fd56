// SPDX-License-Identifier: Apache-2.0
// JPEG, through libjpeg.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a JPEG.
bool is_jpeg(ByteSpan file);

// Reads a JPEG as read_texture does. Throws InputError with one line where it is truncated, corrupt, or
// larger than the limit.
Texture decode_jpeg(ByteSpan file, const std::string& origin);

}  // namespace bitspan
