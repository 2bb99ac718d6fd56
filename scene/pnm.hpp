// SPDX-License-Identifier: Apache-2.0
// PNM, of Netpbm: bits, greys and colours, as text and as bytes.
#pragma once

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a PNM.
bool is_pnm(ByteSpan file);

// Reads a PNM as read_texture does: docs/formats.md says which. Throws InputError with one line where it is
// truncated, corrupt, of another kind, or larger than the limit.
Texture decode_pnm(ByteSpan file, const std::string& origin);

}  // namespace bitspan
