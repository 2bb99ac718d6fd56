// SPDX-License-Identifier: Apache-2.0
// The size of a picture, and how large it may be.
#pragma once

#include <optional>
#include <string_view>

namespace bitspan {

inline constexpr int picture_size_limit = 32768;      // width or height, pixels
inline constexpr long picture_area_limit = 1L << 26;  // width * height, pixels

struct Size {
  int width = 640;
  int height = 480;
};

// Reads a size such as "640x480", legal or not; returns none where the text is no size.
std::optional<Size> parse_size(std::string_view text);
bool is_legal(const Size& size);

}  // namespace bitspan
