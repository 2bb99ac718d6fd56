// SPDX-License-Identifier: Apache-2.0
// NumPy arrays, file format version 1.0, little-endian, C order.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
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

struct IntegerTable {
  std::size_t rows = 0, columns = 0;
  std::vector<std::int64_t> values;
};
// Reads an array of two axes and dtype <i8 in C order. Throws InputError where the file is anything else, or
// is not whole.
IntegerTable read_npy_table(const std::string& path);

}  // namespace bitspan
