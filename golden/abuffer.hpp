// SPDX-License-Identifier: Apache-2.0
// A-buffer: all surfaces of each pixel in a list, blended from back to front. It needs neither the scene's
// order nor passes, and so judges them. [H8]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan::golden {

// A surface that a pixel shows, if nothing hides it: golden's fragment there.
struct Layer {
  std::int32_t triangle = -1;        // input index
  std::int64_t z = 0;                // raw, the depth code, or the word of float_dz
  std::int64_t r = 0, g = 0, b = 0;  // raw, fog.color
  std::int64_t a = 0;                // raw, texture.alpha
  std::uint16_t coverage = 0;  // bit 4 j + i: the triangle covers the middle of part (i, j) of 4 x 4, exactly
};

struct ABuffer {
  int width = 0, height = 0;
  std::vector<std::vector<Layer>> pixels;  // rows from the top; each in the scene's order
};

// Lists the fragments that no texture and no test of alpha kills, whatever lies in front of them. A surface
// that covers parts of a pixel but not its centre is not listed. Throws InputError where the scene has
// commands other than changes of state in front of its first triangle.
ABuffer make_abuffer(const Config& config, const Scene& scene);

// Orders a pixel's layers from far to near by their codes; those of one code as they stand. Returns whether
// two of those that are seen have one code, so that their order is not known.
bool sort_layers(const Config& config, std::vector<Layer>& layers);

// The colour of a pixel whose layers are sorted, each blended over those behind it as merge does.
std::array<std::uint8_t, 3> blended(const Config& config, std::span<const Layer> layers,
                                    const std::array<std::uint8_t, 3>& background);

}  // namespace bitspan::golden
