// SPDX-License-Identifier: Apache-2.0
// Structs of the interface, read and filled by the size that they had where the caller was compiled.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

#include "lib/status.hpp"

namespace bitspan::capi {

// More than any struct will have; a larger size is a member that nobody set.
inline constexpr std::size_t struct_limit = 4096;

// name() is the struct in a message. An array has thousands of structs, and names are made for a fault alone.
template <class Name>
std::size_t size_of(const void* from, std::size_t least, std::size_t alignment, const Name& name) {
  std::size_t size = 0;
  std::memcpy(&size, from, sizeof size);
  if (size < least || size > struct_limit || size % alignment != 0) {
    fail(BS_BAD_INPUT, name() + ".size: " + std::to_string(size) +
                           " is not legal; expected sizeof, at least " + std::to_string(least));
  }
  return size;
}

// Returns the caller's struct over `initial`, which has the defaults. `least`: the bytes that it must have.
template <class T, class Name>
T read_struct(const T* from, T initial, std::size_t least, const Name& name) {
  const std::size_t size = size_of(from, least, alignof(T), name);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(from);
  if (std::any_of(bytes + std::min(size, sizeof(T)), bytes + size, [](unsigned char b) { return b != 0; })) {
    fail(BS_UNSUPPORTED, name() + ": has members behind byte " + std::to_string(sizeof(T)) +
                             " that this library does not know; expected zeros, or a newer library");
  }
  std::memcpy(&initial, from, std::min(size, sizeof(T)));
  return initial;
}

// Element i of an array whose first element says how large each is.
template <class T>
T read_element(const T* array, std::size_t i, const T& initial, std::size_t least, const std::string& what) {
  const auto name_of = [&](std::size_t k) { return what + "[" + std::to_string(k) + "]"; };
  const auto name = [&] { return name_of(i); };
  const std::size_t stride = size_of(array, least, alignof(T), [&] { return name_of(0); });
  const auto* const at =
      reinterpret_cast<const T*>(reinterpret_cast<const unsigned char*>(array) + i * stride);
  std::size_t size = 0;
  std::memcpy(&size, at, sizeof size);
  if (size != stride) {
    fail(BS_BAD_INPUT, name() + ".size: " + std::to_string(size) +
                           " is not that of the first element; expected " + std::to_string(stride));
  }
  return read_struct(at, initial, least, name);
}

// Throws where the caller's struct has no legal size. For functions that must not fail after their work.
template <class T>
void check_struct(const T* to, std::size_t least, const std::string& what) {
  need(to, what.c_str());
  static_cast<void>(size_of(to, least, alignof(T), [&] { return what; }));
}
// Fills the bytes that the caller has, and sets those behind what the library knows to zero.
template <class T>
void write_struct(T* to, T value, std::size_t least, const std::string& what) {
  check_struct(to, least, what);
  std::memcpy(&value.size, to, sizeof value.size);
  auto* const bytes = reinterpret_cast<unsigned char*>(to);
  std::memcpy(bytes, &value, std::min(value.size, sizeof(T)));
  std::fill(bytes + std::min(value.size, sizeof(T)), bytes + value.size, static_cast<unsigned char>(0));
}

// The bytes of a struct up to the end of a member.
#define BITSPAN_THROUGH(T, member) (offsetof(T, member) + sizeof(T::member))

}  // namespace bitspan::capi
