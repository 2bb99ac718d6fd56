// SPDX-License-Identifier: Apache-2.0
// BMP, the bitmaps of Windows and those of OS/2 with a header of 12 bytes.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a BMP.
bool is_bmp(ByteSpan file);

// Reads a BMP as read_texture does: docs/formats.md says which. Throws InputError with one line where it is
// truncated, corrupt, of another kind, or larger than the limit.
Texture decode_bmp(ByteSpan file, const std::string& origin);

}  // namespace bitspan
