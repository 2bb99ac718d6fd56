// SPDX-License-Identifier: Apache-2.0
#include "io/npy.hpp"

#include <bit>
#include <stdexcept>
#include <string_view>

#include "io/atomic_file.hpp"

namespace bitspan {
namespace {

static_assert(std::endian::native == std::endian::little, "the arrays are written as they lie in memory");

// Returns the part in front of the data: magic, version, length and description, padded to a multiple of 64
// bytes.
std::string header(std::string_view dtype, std::initializer_list<std::size_t> shape) {
  std::string text = "{'descr': '" + std::string(dtype) + "', 'fortran_order': False, 'shape': (";
  for (const std::size_t extent : shape) text += std::to_string(extent) + ", ";
  if (shape.size() > 1) text.resize(text.size() - 2);
  if (shape.size() == 1) text.pop_back();  // (n,)
  text += "), }";
  constexpr std::size_t prefix_bytes = 10;
  text.append(63 - (prefix_bytes + text.size()) % 64, ' ');
  text += '\n';
  const auto length = static_cast<std::uint16_t>(text.size());
  std::string result = "\x93NUMPY";
  result += '\1';
  result += '\0';
  result += static_cast<char>(length & 255);
  result += static_cast<char>(length >> 8);
  return result + text;
}

template <class T>
void write(const std::string& path, std::string_view dtype, std::initializer_list<std::size_t> shape,
           std::span<const T> values) {
  std::size_t count = 1;
  for (const std::size_t extent : shape) count *= extent;
  if (count != values.size()) throw std::invalid_argument("write_npy: the shape does not match the values");
  AtomicFile file(path);
  file.write(header(dtype, shape));
  file.write(std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  file.commit();
}

}  // namespace

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint8_t> values) {
  write(path, "|u1", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint32_t> values) {
  write(path, "<u4", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int32_t> values) {
  write(path, "<i4", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const double> values) {
  write(path, "<f8", shape, values);
}

}  // namespace bitspan
