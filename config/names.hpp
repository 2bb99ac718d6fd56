// SPDX-License-Identifier: Apache-2.0
// The names of the enumerators, as the TOML file spells them; shared by reader, writer and messages.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace bitspan {

// In the order of the enumerators; empty for a type that has none.
template <class E>
inline constexpr std::array<std::string_view, 0> enum_names{};

// The parts of "a, b, c".
constexpr std::size_t count_of_names(std::string_view list) {
  return 1 + static_cast<std::size_t>(std::ranges::count(list, ','));
}
template <std::size_t n>
constexpr std::array<std::string_view, n> split_names(std::string_view list) {
  std::array<std::string_view, n> out;
  for (std::string_view& name : out) {
    name = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), name.size() + 2));
  }
  return out;
}

// An enumeration whose enumerators have their own names: BITSPAN_ENUM(FogMode, none, linear, table)
#define BITSPAN_ENUM(E, ...)                   \
  enum class E : std::uint8_t { __VA_ARGS__ }; \
  template <>                                  \
  inline constexpr auto enum_names<E> = split_names<count_of_names(#__VA_ARGS__)>(#__VA_ARGS__)

// "?" for a value that is no enumerator.
template <class E>
constexpr std::string_view enum_name(E value) {
  const auto i = static_cast<std::size_t>(value);
  return i < enum_names<E>.size() ? enum_names<E>[i] : "?";
}
template <class E>
requires(!enum_names<E>.empty()) constexpr std::string_view to_string(E value) { return enum_name(value); }

}  // namespace bitspan
