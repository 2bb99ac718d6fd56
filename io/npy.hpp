// SPDX-License-Identifier: Apache-2.0
// NumPy arrays. They are written in file format version 1.0, little-endian, in C order.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bitspan {

// Each of these writes an array whole or not at all, of dtype |u1, <u4, <i4, <i8 or <f8. `shape` names the
// extents, slowest first; their product is the number of values. Throws InputError where the file cannot be
// written.
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint8_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint32_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int32_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int64_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const double> values);

// What stands in front of an array's values.
struct NpyHeader {
  std::string type;                // "<i8"
  bool is_fortran = false;         // the first axis varies fastest
  std::vector<std::size_t> shape;  // extents
  std::size_t bytes = 0;           // of the header; the values begin behind it
};
inline constexpr std::size_t npy_header_limit = 1 << 16;  // bytes; NumPy takes less than 200 for plain arrays
// Reads the header of a file of version 1 to 3, of which `file` needs to have the first npy_header_limit
// bytes only. Throws InputError, which begins with `origin` and ends with `expected`, where it is none, is
// cut short, or describes an array of records.
NpyHeader parse_npy_header(std::string_view file, const std::string& origin, std::string_view expected);

struct IntegerTable {
  std::size_t rows = 0, columns = 0;
  std::vector<std::int64_t> values;
};
// Reads an array of two axes and dtype <i8 in C order. Throws InputError where the file is anything else, or
// is not whole.
IntegerTable read_npy_table(const std::string& path);

}  // namespace bitspan
