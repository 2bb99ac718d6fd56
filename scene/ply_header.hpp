// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: which elements its data have, and of which properties.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bitspan {

enum class PlyEncoding : std::uint8_t { ascii, little, big };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr bool is_real(PlyType type) { return type == PlyType::float32 || type == PlyType::float64; }
constexpr bool is_signed(PlyType type) {
  return is_real(type) || type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32;
}
std::size_t size_of(PlyType type);
std::string_view name_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::int8;
  std::optional<PlyType> count;  // of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::size_t line = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> images;  // of comments "TextureFile NAME"
  std::size_t size = 0;             // bytes in front of the data
  std::size_t lines = 0;
};

// Reads the header at the start of a file's contents. Throws InputError where it is none.
PlyHeader read_ply_header(std::string_view bytes, const std::string& path);

}  // namespace bitspan
