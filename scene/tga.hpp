// SPDX-License-Identifier: Apache-2.0
// TGA, of Truevision.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file may be a TGA. It has no signature: the first 18 bytes must be a header that decode_tga
// reads.
bool is_tga(ByteSpan file);

// Reads a TGA as read_texture does: docs/formats.md says which. Throws InputError with one line where it is
// truncated, corrupt, of another kind, or larger than the limit.
Texture decode_tga(ByteSpan file, const std::string& origin);

}  // namespace bitspan
