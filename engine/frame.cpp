// SPDX-License-Identifier: Apache-2.0
#include "engine/frame.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

namespace bitspan {

void clear_frame(Frame& frame, int width, int height, const std::array<std::uint8_t, 3>& background,
                 std::uint32_t clear_depth, bool winners) {
  frame.width = width;
  frame.height = height;
  frame.first_row = 0;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::array<std::uint8_t, 4> rgba{background[0], background[1], background[2], 255};
  frame.color.resize(4 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) std::memcpy(frame.color.data() + 4 * i, rgba.data(), 4);
  frame.depth.assign(pixels, clear_depth);
  const std::size_t kept = winners ? pixels : 0;
  frame.u.assign(kept, std::numeric_limits<double>::quiet_NaN());
  frame.v.assign(kept, std::numeric_limits<double>::quiet_NaN());
  frame.triangle.assign(kept, -1);
  frame.stencil.clear();
  frame.candidates.clear();
  frame.full_alpha = true;
}

void clear_planes(Frame& frame, const Clear& clear, std::uint32_t farthest) {
  const std::size_t pixels = frame.depth.size();
  if (clear.color) {
    for (std::size_t i = 0; i < pixels; ++i) std::memcpy(frame.color.data() + 4 * i, clear.color->data(), 3);
    // No fragment shows any more.
    std::ranges::fill(frame.u, std::numeric_limits<double>::quiet_NaN());
    std::ranges::fill(frame.v, std::numeric_limits<double>::quiet_NaN());
    std::ranges::fill(frame.triangle, -1);
  }
  if (clear.alpha) {
    for (std::size_t i = 0; i < pixels; ++i) frame.color[4 * i + 3] = *clear.alpha;
    frame.full_alpha = *clear.alpha == 255;
  }
  if (clear.depth) std::ranges::fill(frame.depth, farthest);
  if (clear.stencil) frame.stencil.assign(pixels, *clear.stencil);
}

void need_stencil(Frame& frame) {
  if (frame.stencil.empty()) frame.stencil.resize(frame.depth.size());
}

void need_candidates(Frame& frame) {
  if (frame.candidates.empty()) frame.candidates.resize(frame.depth.size());
}

}  // namespace bitspan
