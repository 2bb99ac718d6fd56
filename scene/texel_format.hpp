// SPDX-License-Identifier: Apache-2.0
// How the texels of each format lie in memory. What their bits stand for is each view's own to compute:
// docs/numeric-spec.md, "texel formats".
#pragma once

#include <cstddef>
#include <cstdint>

#include "config/modes.hpp"
#include "config/names.hpp"

namespace bitspan {

BITSPAN_ENUM(TexelFormat, rgba8888, rgb332, yiq422, a8, i8, ai44, p8, argb8332, rgb565, argb1555, argb4444,
             ai88, ap88, ayiq8422, dxt1, dxt3, dxt5, uyvy, yuyv);

// Texels lie in blocks, row by row of blocks from the top left. The last block of a row or column may reach
// beyond the texture.
struct TexelLayout {
  int block_width = 1, block_height = 1;  // texels
  int block_bytes = 4;
  int table_size = 0;  // of Texture::table
};

inline constexpr int palette_size = 256 * 4;    // red, green, blue, alpha of each code
inline constexpr int yiq_table_size = 16 + 24;  // 16 of Y; red, green, blue of 4 of I; the same of 4 of Q

constexpr TexelLayout texel_layout(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba8888:
      return {1, 1, 4, 0};
    case TexelFormat::rgb332:
    case TexelFormat::a8:
    case TexelFormat::i8:
    case TexelFormat::ai44:
      return {1, 1, 1, 0};
    case TexelFormat::yiq422:
      return {1, 1, 1, yiq_table_size};
    case TexelFormat::p8:
      return {1, 1, 1, palette_size};
    case TexelFormat::argb8332:
    case TexelFormat::rgb565:
    case TexelFormat::argb1555:
    case TexelFormat::argb4444:
    case TexelFormat::ai88:
      return {1, 1, 2, 0};
    case TexelFormat::ap88:
      return {1, 1, 2, palette_size};
    case TexelFormat::ayiq8422:
      return {1, 1, 2, yiq_table_size};
    case TexelFormat::dxt1:
      return {4, 4, 8, 0};
    case TexelFormat::dxt3:
    case TexelFormat::dxt5:
      return {4, 4, 16, 0};
    case TexelFormat::uyvy:
    case TexelFormat::yuyv:
      return {2, 1, 4, 0};
  }
  unreachable();
}

// Blocks in a row.
constexpr std::size_t blocks_across(const TexelLayout& l, int width) {
  return static_cast<std::size_t>((width + l.block_width - 1) / l.block_width);
}

// Bytes of a whole texture.
constexpr std::size_t raw_size(TexelFormat format, int width, int height) {
  const TexelLayout l = texel_layout(format);
  return blocks_across(l, width) * static_cast<std::size_t>((height + l.block_height - 1) / l.block_height) *
         static_cast<std::size_t>(l.block_bytes);
}

// The first byte of the block that holds texel (i, j).
constexpr std::size_t block_at(TexelFormat format, int width, std::int64_t i, std::int64_t j) {
  const TexelLayout l = texel_layout(format);
  return (static_cast<std::size_t>(j / l.block_height) * blocks_across(l, width) +
          static_cast<std::size_t>(i / l.block_width)) *
         static_cast<std::size_t>(l.block_bytes);
}

}  // namespace bitspan
