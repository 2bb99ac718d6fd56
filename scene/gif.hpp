// SPDX-License-Identifier: Apache-2.0
// GIF, through giflib.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a GIF.
bool is_gif(ByteSpan file);

// Reads the first frame of a GIF as read_texture does: docs/formats.md says which. Throws InputError with one
// line where it is truncated, corrupt, of another kind, or larger than the limit.
Texture decode_gif(ByteSpan file, const std::string& origin);

}  // namespace bitspan
