// SPDX-License-Identifier: Apache-2.0
// PNG, through libpng.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a PNG.
bool is_png(ByteSpan file);

// Reads a PNG as read_texture does. Throws InputError with one line where it is truncated, corrupt, or larger
// than the limit.
Texture decode_png(ByteSpan file, const std::string& origin);

}  // namespace bitspan
