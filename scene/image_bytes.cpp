// SPDX-License-Identifier: Apache-2.0
#include "scene/image_bytes.hpp"

#include "config/config.hpp"
#include "scene/texture.hpp"

namespace bitspan {

void ImageBytes::refuse(const std::string& what) const {
  const std::string limit = std::to_string(texture_size_limit);
  throw InputError(origin + ": " + what + "; expected a whole " + std::string(format) + " file of at most " +
                   limit + " x " + limit + " texels");
}

void ImageBytes::corrupt(const std::string& what) const {
  refuse("corrupt " + std::string(format) + ": " + what);
}

ByteSpan ImageBytes::take(std::size_t count) {
  if (count > left()) corrupt("the file ends too early (truncated)");
  const ByteSpan out = data.subspan(at, count);
  at += count;
  return out;
}

unsigned ImageBytes::u16() {
  const ByteSpan bytes = take(2);
  return bytes[0] | static_cast<unsigned>(bytes[1]) << 8;
}

std::uint32_t ImageBytes::u32() {
  const std::uint32_t low = u16();
  return low | static_cast<std::uint32_t>(u16()) << 16;
}

void ImageBytes::seek(std::size_t position) {
  if (position > data.size()) corrupt("the file ends too early (truncated)");
  at = position;
}

Texture ImageBytes::texture(std::int64_t width, std::int64_t height, std::size_t bytes) const {
  if (width < 1 || height < 1 || width > texture_size_limit || height > texture_size_limit) {
    corrupt("it has " + std::to_string(width) + " x " + std::to_string(height) + " texels");
  }
  if (bytes > left()) corrupt("the file is too short for its size (truncated)");
  Texture out;
  out.name = origin;
  out.width = static_cast<int>(width);
  out.height = static_cast<int>(height);
  out.rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return out;
}

}  // namespace bitspan
