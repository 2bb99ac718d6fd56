// SPDX-License-Identifier: Apache-2.0
// Textures whose texels have a format of their own: how an image becomes one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan {

// Whether the sizes of rgba, raw and table are those of the format, width and height, and the table of a
// procedural texture is legal.
bool is_whole(const Texture& texture);

// Bytes of the texels in the memory of the hardware.
std::size_t byte_count(const Texture& texture);

// Converts 8-bit RGBA into the format; docs/formats.md has the rule. `table` is the palette or the table of
// YIQ. A palette may be empty: it then has the image's own colours. Throws InputError where a table is
// missing or has another size, or the image has more than 256 colours.
Texture converted(const Texture& image, TexelFormat format, std::vector<std::int16_t> table);

}  // namespace bitspan
