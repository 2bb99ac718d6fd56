// SPDX-License-Identifier: Apache-2.0
#include "io/npy.hpp"

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "config/config.hpp"
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
               std::span<const std::int64_t> values) {
  write(path, "<i8", shape, values);
}

void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const double> values) {
  write(path, "<f8", shape, values);
}

IntegerTable read_npy_table(const std::string& path) {
  const auto refuse = [&path](const std::string& what) {
    throw InputError(path + ": " + what + "; expected a NumPy array of int64 with two axes, in C order");
  };
  std::ifstream in(path, std::ios::binary);
  std::error_code ignored;
  if (!in.is_open() || std::filesystem::is_directory(path, ignored)) refuse("cannot read");
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto byte = [&](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[at]));
  };
  if (bytes.size() < 12 || !bytes.starts_with("\x93NUMPY")) refuse("is no NumPy file");
  // Version 1 has a length of 2 bytes, the later ones of 4.
  const bool is_first = byte(6) == 1;
  const std::size_t start = is_first ? 10 : 12;
  const std::size_t length = byte(8) | byte(9) << 8U | (is_first ? 0 : byte(10) << 16U | byte(11) << 24U);
  if (length > bytes.size() - start) refuse("is cut short");
  const std::string head = bytes.substr(start, length);
  IntegerTable out;
  const std::regex shape(R"('shape': *\( *(\d{1,10}) *, *(\d{1,6}) *,? *\))");
  std::smatch extents;
  if (!std::regex_search(head, extents, shape)) refuse("has not two axes");
  if (head.find("'descr': '<i8'") == std::string::npos) refuse("is of another type");
  if (head.find("'fortran_order': False") == std::string::npos) refuse("is not in C order");
  out.rows = std::stoull(extents[1]);
  out.columns = std::stoull(extents[2]);
  const std::size_t rest = bytes.size() - start - length;
  const std::size_t size = out.rows * out.columns;
  if (rest != size * sizeof(std::int64_t)) refuse("is cut short, or too long");
  out.values.resize(size);
  std::memcpy(out.values.data(), bytes.data() + start + length, rest);
  return out;
}

}  // namespace bitspan
