// SPDX-License-Identifier: Apache-2.0
#include "engine/frame.hpp"

#include <cstring>
#include <limits>

namespace bitspan {

void clear_frame(Frame& frame, int width, int height, const std::array<std::uint8_t, 3>& background,
                 std::uint32_t clear_depth, bool winners) {
  frame.width = width;
  frame.height = height;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const std::array<std::uint8_t, 4> rgba{background[0], background[1], background[2], 255};
  frame.color.resize(4 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) std::memcpy(frame.color.data() + 4 * i, rgba.data(), 4);
  frame.depth.assign(pixels, clear_depth);
  const std::size_t kept = winners ? pixels : 0;
  frame.u.assign(kept, std::numeric_limits<double>::quiet_NaN());
  frame.v.assign(kept, std::numeric_limits<double>::quiet_NaN());
  frame.triangle.assign(kept, -1);
}

}  // namespace bitspan
