// SPDX-License-Identifier: Apache-2.0
#include "scene/picture_size.hpp"

#include <charconv>

namespace bitspan {

std::optional<Size> parse_size(std::string_view text) {
  Size size;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, size.width);
  if (first.ec != std::errc{} || first.ptr == end || *first.ptr != 'x') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, size.height);
  if (second.ec != std::errc{} || second.ptr != end) return std::nullopt;
  return size;
}

bool is_legal(const Size& size) {
  return size.width >= 1 && size.height >= 1 && size.width <= picture_size_limit &&
         size.height <= picture_size_limit &&
         static_cast<long>(size.width) * size.height <= picture_area_limit;
}

}  // namespace bitspan
