// SPDX-License-Identifier: Apache-2.0
// The tests of a draw state, a pixel at a time, where lanes do not have them: stencil, scissor, stipple.
#pragma once

#include <cstddef>
#include <cstdint>

#include "config/modes.hpp"
#include "engine/engine.hpp"
#include "model/pipeline.hpp"

namespace bitspan::model {

// Whether a comparison of depth codes alone decides about a pixel.
inline bool depth_decides_alone(const Pipeline& pipeline) {
  return !pipeline.stencil.test && !pipeline.masks_pixels && !has_dz(pipeline.depth.formats.code);
}

struct PixelTests {
  const Pipeline& pipeline;
  bool back = false;  // of a back face
  Frame& frame;
  Counters& counters;

  // Scissor and stipple. Counts masked.
  bool is_drawn(std::int64_t x, std::int64_t y) const {
    if (!pipeline.masks_pixels || model::is_drawn(pipeline.state, x, y)) return true;
    ++counters.masked;
    return false;
  }
  // Depth and stencil of a code, which writes the stencil. Counts stencil_failed, depth_passed.
  bool passes(std::uint32_t z, std::size_t pixel) const;
};

}  // namespace bitspan::model
