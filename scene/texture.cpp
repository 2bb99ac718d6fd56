// SPDX-License-Identifier: Apache-2.0
#include "scene/texture.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "config/config.hpp"
#include "scene/image_file.hpp"

namespace bitspan {
namespace {

// A picture of the largest size takes less in every format: as text of 16-bit colours 4.8 GB.
constexpr std::uintmax_t largest_file = std::uintmax_t{5} << 30;

}  // namespace

Texture decode_texture(std::span<const std::uint8_t> file, const std::string& origin) {
  return decode_image(file, origin);
}

Texture read_texture(const std::string& path) {
  const std::string expected = std::string(image_formats) + " file";
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    throw InputError(path + ": cannot read the texture: is a folder; expected a " + expected);
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot read the texture: " + std::strerror(errno) + "; expected a " +
                     expected);
  }
  std::vector<std::uint8_t> bytes;
  std::vector<char> chunk(image_head_bytes);
  while (file.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), file.gcount() > 0) {
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + file.gcount());
    // A device or a large file of another format is not read whole.
    if (chunk.size() == image_head_bytes) {
      check_image_format(bytes, path);
      const std::uintmax_t size = std::filesystem::file_size(path, code);
      if (!code && size > largest_file) {
        throw InputError(path + ": cannot read the texture: it has " + std::to_string(size) +
                         " bytes; expected at most " + std::to_string(largest_file));
      }
      if (!code) bytes.reserve(size);
      chunk.resize(std::size_t{1} << 20);
    }
  }
  if (file.bad()) throw InputError(path + ": cannot read the texture; expected a " + expected);
  return decode_texture(bytes, path);
}

}  // namespace bitspan
