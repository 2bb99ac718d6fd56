// NumPy arrays, file format version 1.0, little-endian, C order.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace bitspan {

// dtypes |u1, <u4, <i4, <f8. `shape` names the extents, slowest first; their product is the number of values.
// The file appears whole or not at all; InputError where it cannot be written.
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint8_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::uint32_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const std::int32_t> values);
void write_npy(const std::string& path, std::initializer_list<std::size_t> shape,
               std::span<const double> values);

}  // namespace bitspan
