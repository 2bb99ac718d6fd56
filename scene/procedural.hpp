// SPDX-License-Identifier: Apache-2.0
// What the numbers of a procedural texture mean, and which are legal. What they stand for is each view's own
// to compute: docs/numeric-spec.md, "procedural textures".
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "scene/random.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// A number of Texture::table behind the two colours, and its key in the header of a stream.
struct ProceduralValue {
  std::string_view key;
  int low = 0, high = 0;
};
// In the order of the table; none of a format that is not procedural.
std::span<const ProceduralValue> procedural_values(TexelFormat format);

// What is wrong with the table of a procedural texture: "mortar: 9 is out of range; expected 0..7", or empty.
std::string procedural_fault(const Texture& texture);

// Of that size, with a legal table.
Texture random_procedural(Random& random, TexelFormat format, int width, int height);

}  // namespace bitspan
