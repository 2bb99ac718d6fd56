// SPDX-License-Identifier: Apache-2.0
// The picture of a run, and the only code that clears it and writes pixels of it one by one. Storage, and no
// arithmetic: so golden and the model share it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/records.hpp"

namespace bitspan {

// What a run leaves behind; every plane is height * width, rows from the top.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> color;     // RGBA, A always 255
  std::vector<std::uint32_t> depth;    // the stored code
  std::vector<double> u, v;            // texels, of the fragment written last; NaN where none
  std::vector<std::int32_t> triangle;  // input index of that fragment; -1 where none
};

// Gives the frame its size, the background, the depth buffer's clear code and no triangle. winners: with the
// planes u, v and triangle; else they are empty.
void clear_frame(Frame& frame, int width, int height, const std::array<std::uint8_t, 3>& background,
                 std::uint32_t clear_depth, bool winners = true);

inline std::size_t pixel_of(const Frame& frame, const FragmentRecord& fragment) {
  return static_cast<std::size_t>(fragment.y * frame.width + fragment.x);
}

// The planes of the winner; the frame has them. uv_ulp: the value of 1 in u and v.
inline void write_winner(Frame& frame, std::size_t pixel, std::int64_t u, std::int64_t v,
                         std::int64_t triangle, double uv_ulp) {
  frame.u[pixel] = static_cast<double>(u) * uv_ulp;
  frame.v[pixel] = static_cast<double>(v) * uv_ulp;
  frame.triangle[pixel] = static_cast<std::int32_t>(triangle);
}

// What merge delivered for a fragment. uv_ulp: the value of 1 in the fragment's u and v.
inline void write_fragment(Frame& frame, const FragmentRecord& fragment, const MergeRecord& merged,
                           double uv_ulp) {
  const std::size_t pixel = pixel_of(frame, fragment);
  std::uint8_t* const color = frame.color.data() + 4 * pixel;
  color[0] = static_cast<std::uint8_t>(merged.r);
  color[1] = static_cast<std::uint8_t>(merged.g);
  color[2] = static_cast<std::uint8_t>(merged.b);
  frame.depth[pixel] = static_cast<std::uint32_t>(merged.z);
  if (!frame.u.empty()) write_winner(frame, pixel, fragment.u, fragment.v, fragment.triangle, uv_ulp);
}

}  // namespace bitspan
