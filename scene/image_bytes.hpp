// SPDX-License-Identifier: Apache-2.0
// The bytes of an image file, as the readers of its format take them, and how they refuse it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

using ByteSpan = std::span<const std::uint8_t>;

struct ImageBytes {
  ByteSpan data;
  std::string_view format;  // "BMP"
  const std::string& origin;
  std::size_t at = 0;  // what is read next

  // Both throw InputError: for a file that is damaged, and for one of a kind that is not read.
  [[noreturn]] void corrupt(const std::string& what) const;
  [[noreturn]] void refuse(const std::string& what) const;

  std::size_t left() const { return data.size() - at; }
  // Each refuses a file that ends before; numbers are little-endian.
  ByteSpan take(std::size_t count);
  unsigned u8() { return take(1)[0]; }
  unsigned u16();
  std::uint32_t u32();
  void seek(std::size_t position);

  // A texture of width x height texels, all of `fill`. Refuses sizes out of 1..texture_size_limit, and those
  // for which `bytes`, the least that stands behind `at`, is not there, before it takes memory.
  Texture texture(std::int64_t width, std::int64_t height, std::size_t bytes) const;
};

// The texel at row y and column x.
inline std::uint8_t* texel_at(Texture& texture, int x, int y) {
  return &texture.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(texture.width) +
                            static_cast<std::size_t>(x))];
}

inline constexpr Rgba opaque_black{0, 0, 0, 255};
inline void store(std::uint8_t* texel, const Rgba& color) { std::copy_n(color.begin(), 4, texel); }

// Code `value` of 0..maximum as one of 0..255, rounded to nearest.
constexpr std::uint8_t to_code(std::uint64_t value, std::uint64_t maximum) {
  return static_cast<std::uint8_t>((value * 255 + maximum / 2) / maximum);
}

}  // namespace bitspan
