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
             ai88, ap88, ayiq8422, dxt1, dxt3, dxt5, uyvy, yuyv, checker, brick, noise, depth);

// Texels lie in blocks, row by row of blocks from the top left. The last block of a row or column may reach
// beyond the texture.
struct TexelLayout {
  int block_width = 1, block_height = 1;  // texels
  int block_bytes = 4;                    // 0: no memory
  int table_size = 0;                     // of Texture::table
};

inline constexpr int palette_size = 256 * 4;    // red, green, blue, alpha of each code
inline constexpr int yiq_table_size = 16 + 24;  // 16 of Y; red, green, blue of 4 of I; the same of 4 of Q

// Procedural textures [T9]: a texel is computed from its column and row. The table has two colours of red,
// green, blue and alpha, and then:
enum CheckerValue : std::uint8_t { checker_width = 8, checker_height, checker_table_size };
enum BrickValue : std::uint8_t {
  brick_width = 8,
  brick_height,
  brick_mortar,
  brick_shift,
  brick_vary,
  brick_seed,
  brick_table_size
};
enum NoiseValue : std::uint8_t { noise_cell = 8, noise_octaves, noise_seed, noise_table_size };

// Texels are computed; none is in memory.
constexpr bool is_procedural(TexelFormat format) {
  switch (format) {
    case TexelFormat::checker:
    case TexelFormat::brick:
    case TexelFormat::noise:
      return true;
    case TexelFormat::rgba8888:
    case TexelFormat::rgb332:
    case TexelFormat::yiq422:
    case TexelFormat::a8:
    case TexelFormat::i8:
    case TexelFormat::ai44:
    case TexelFormat::p8:
    case TexelFormat::argb8332:
    case TexelFormat::rgb565:
    case TexelFormat::argb1555:
    case TexelFormat::argb4444:
    case TexelFormat::ai88:
    case TexelFormat::ap88:
    case TexelFormat::ayiq8422:
    case TexelFormat::dxt1:
    case TexelFormat::dxt3:
    case TexelFormat::dxt5:
    case TexelFormat::uyvy:
    case TexelFormat::yuyv:
    case TexelFormat::depth:
      return false;
  }
  unreachable();
}

constexpr TexelLayout texel_layout(TexelFormat format) {
  switch (format) {
    case TexelFormat::rgba8888:
    case TexelFormat::depth:
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
    case TexelFormat::checker:
      return {1, 1, 0, checker_table_size};
    case TexelFormat::brick:
      return {1, 1, 0, brick_table_size};
    case TexelFormat::noise:
      return {1, 1, 0, noise_table_size};
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
