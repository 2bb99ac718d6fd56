// SPDX-License-Identifier: Apache-2.0
// How alike two pictures of one scene are, where they cannot be equal.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace bitspan::bench {

struct Likeness {
  double psnr = 0;     // dB, over red, green, blue
  double drawn = 0;    // share of the pixels that the first picture has something on
  double outside = 0;  // share of the pixels where only one of the two has
};

// Compares two RGBA pictures of the scene's size. All numbers are zero where the sizes differ.
Likeness compare(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b, const Scene& scene);

// Says whether these can be the same scene, drawn by bitspan and by a renderer in floating point: alike to
// the eye, and not empty.
bool alike(const Likeness& likeness);

}  // namespace bitspan::bench
