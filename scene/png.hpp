// SPDX-License-Identifier: Apache-2.0
// PNG, through libpng.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/image_bytes.hpp"

namespace bitspan {

// Whether a file begins as a PNG.
bool is_png(ByteSpan file);

// Reads a PNG as read_texture does. Throws InputError with one line where it is truncated, corrupt, or larger
// than the limit.
Texture decode_png(ByteSpan file, const std::string& origin);

// Grey levels as the file has them.
struct GreyCodes {
  int width = 0, height = 0;
  std::vector<std::uint16_t> codes;
};
// Reads a PNG of grey levels, of up to 16 bits, without alpha. Throws InputError as decode_png does, and
// where it is of another kind.
GreyCodes decode_grey_png(ByteSpan file, const std::string& origin);

}  // namespace bitspan
