// SPDX-License-Identifier: Apache-2.0
// PNG pictures with 8 bits per channel.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bitspan {

// `pixels` holds height rows from the top, width * channels bytes per row. channels: 1 grey, 2 grey and
// alpha, 3 RGB, 4 RGBA. width, height >= 1. No gamma and no time stamp are written, so the same pixels make
// the same bytes.
std::vector<std::uint8_t> encode_png(int width, int height, int channels,
                                     std::span<const std::uint8_t> pixels);

// Writes a whole file or none. Throws InputError where it cannot be written.
void write_png(const std::string& path, int width, int height, int channels,
               std::span<const std::uint8_t> pixels);

}  // namespace bitspan
