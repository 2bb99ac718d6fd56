// SPDX-License-Identifier: Apache-2.0
#include "scene/image_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <memory>

#include "config/config.hpp"
#include "scene/texture.hpp"

// Only what meshes come with, and what damaged files do no harm in. Memory starts as zeros, so that a decoder
// that misses a damaged file gives no foreign bytes; one code path, so that a picture decodes alike on every
// processor.
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_GIF
#define STBI_ONLY_PNM
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC std::realloc
#define STBI_FREE std::free
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

namespace bitspan {
namespace {

// What stb_image reads from. Behind the end it reads zeros; `cut` says that it did.
struct Source {
  std::span<const std::uint8_t> data;
  std::size_t position = 0;
  bool cut = false;

  std::size_t left() const { return data.size() - position; }
};

constexpr int refill_bytes = 128;  // what stb_image asks for ahead

int read_bytes(void* user, char* out, int size) {
  auto& source = *static_cast<Source*>(user);
  const auto wanted = static_cast<std::size_t>(size);
  const std::size_t count = std::min(wanted, source.left());
  source.cut = source.cut || count == 0 || (count < wanted && size != refill_bytes);
  std::copy_n(source.data.begin() + static_cast<std::ptrdiff_t>(source.position), count, out);
  source.position += count;
  return static_cast<int>(count);
}

void skip_bytes(void* user, int count) {
  auto& source = *static_cast<Source*>(user);
  if (count < 0) {  // back into what is buffered
    source.position -= std::min(source.position, static_cast<std::size_t>(-static_cast<long>(count)));
    return;
  }
  const auto wanted = static_cast<std::size_t>(count);
  source.cut = source.cut || wanted > source.left();
  source.position += std::min(wanted, source.left());
}

int at_end(void* user) { return static_cast<const Source*>(user)->left() == 0 ? 1 : 0; }

constexpr stbi_io_callbacks callbacks{read_bytes, skip_bytes, at_end};

// The largest number in the header of a binary PNM, 0 where there is none. stb_image does not scale by it.
int pnm_maximum(std::span<const std::uint8_t> file) {
  if (file.size() < 3 || file[0] != 'P' || (file[1] != '5' && file[1] != '6')) return 255;
  std::size_t at = 2;
  int number = 0;
  for (int field = 0; field < 3; ++field) {
    while (at < file.size() && (std::isspace(file[at]) != 0 || file[at] == '#')) {
      if (file[at++] != '#') continue;
      while (at < file.size() && file[at] != '\n' && file[at] != '\r') ++at;
    }
    number = 0;
    for (; at < file.size() && std::isdigit(file[at]) != 0; ++at) {
      number = std::min(number * 10 + (file[at] - '0'), 1 << 20);
    }
  }
  return number;
}

}  // namespace

Texture decode_image(std::span<const std::uint8_t> file, const std::string& origin) {
  const std::string limit = std::to_string(texture_size_limit) + " x " + std::to_string(texture_size_limit);
  const auto refuse = [&](const std::string& what) {
    throw InputError(origin + ": " + what + "; expected a whole " + std::string(image_formats) +
                     " file of at most " + limit + " texels");
  };
  int width = 0, height = 0, channels = 0;
  Source source{file};
  if (stbi_info_from_callbacks(&callbacks, &source, &width, &height, &channels) == 0) {
    refuse("not an image that can be read");
  }
  if (width < 1 || height < 1 || width > texture_size_limit || height > texture_size_limit) {
    refuse("corrupt image: it has " + std::to_string(width) + " x " + std::to_string(height) + " texels");
  }
  // A GIF's codes stand for at most 4,096 texels each, and no format has more texels per byte: a header that
  // promises more is refused before the memory is taken.
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (texels / 4096 > file.size())
    refuse("corrupt image: the file is far too short for its size (truncated)");
  if (pnm_maximum(file) != 255) refuse("a PNM whose largest number is not 255 cannot be read");
  source = {file};
  const std::unique_ptr<stbi_uc, decltype(&std::free)> pixels(
      stbi_load_from_callbacks(&callbacks, &source, &width, &height, &channels, 4), &std::free);
  if (!pixels) refuse(std::string("corrupt image: ") + stbi_failure_reason());
  if (source.cut) refuse("corrupt image: the file ends too early (truncated)");
  Texture out;
  out.name = origin;
  out.width = width;
  out.height = height;
  const std::size_t size = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  out.rgba.assign(pixels.get(), pixels.get() + size);
  return out;
}

}  // namespace bitspan
