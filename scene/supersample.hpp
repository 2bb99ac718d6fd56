// SPDX-License-Identifier: Apache-2.0
// A scene drawn larger, so that the mean of its samples is a picture with smoother edges [H9].
#pragma once

#include <cstdint>

#include "scene/scene.hpp"

namespace bitspan {

inline constexpr int supersample_limit = 16;

// The same picture with k * k samples per pixel: x, y, width, height, focal and the scissor times k, 1 <= k
// <= supersample_limit. Depths, texture coordinates, fog and all other state stay. Throws InputError where
// the larger picture, or a position in it, is beyond what a stream may have. first_index: of the first
// triangle, for the text.
Scene supersampled(Scene scene, int k, std::int64_t first_index = 0);

}  // namespace bitspan
