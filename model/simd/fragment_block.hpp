// SPDX-License-Identifier: Apache-2.0
// Fragments that passed the depth test, side by side: what the span half of the vector form hands to texture,
// fog and merge. All of one texture; from one triangle, or from several where none of them can be killed and
// all are opaque (then the order of writing is all that matters).
#pragma once

#include <cstddef>
#include <cstdint>

#include "config/lines.hpp"
#include "model/simd/columns.hpp"

namespace bitspan::model {

inline constexpr std::size_t block_size = 256;

// T: std::int32_t where every format of these stages fits it (docs/performance.md), else std::int64_t.
// Raw values on the formats of FragmentRecord's fields.
template <class T>
struct FragmentBlock {
  static constexpr std::size_t padded = block_size + column_slack;
  std::size_t size = 0;
  alignas(64) std::int32_t pixel[padded];  // its place in the frame's planes
  alignas(64) std::int32_t z[padded];      // depth code, to be stored with the colour
  alignas(64) T u[padded];
  alignas(64) T v[padded];
  alignas(64) T u2[padded];  // where the second texture unit has coordinates of its own
  alignas(64) T v2[padded];
  alignas(64) T r[padded];
  alignas(64) T g[padded];
  alignas(64) T b[padded];
  alignas(64) T a[padded];
  alignas(64) std::int32_t fog_step[padded];  // top bits of h (fog table)
  alignas(64) std::int64_t h[padded];         // linear fog only
  alignas(64) T fog_factor[padded];           // fog of the vertices only
  alignas(64) std::int32_t triangle[padded];  // input index
  // Channels by their place among those in use, only where the plan takes them: values, and until the block
  // is given away the accumulators of those that the span divides.
  alignas(64) std::int64_t channel[channel_limit][padded];
};

// What the fragments of a block have in common.
struct BlockDraw {
  int texture = -1;         // index into Scene::textures, -1 for none
  bool store_depth = true;  // false where the depth is stored already
  bool back = false;        // of a back face, in blocks of one triangle
};

}  // namespace bitspan::model
