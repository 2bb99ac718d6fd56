// PNG pictures, 8 bits a channel.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace bitspan {

// `pixels` holds height rows from the top, width * channels bytes each; channels: 1 grey, 2 grey and alpha, 3
// RGB, 4 RGBA. width, height >= 1. No gamma, no time stamp: the same pixels make the same bytes.
std::vector<std::uint8_t> encode_png(int width, int height, int channels,
                                     std::span<const std::uint8_t> pixels);

// Writes a whole file or none; InputError where it cannot be written.
void write_png(const std::string& path, int width, int height, int channels,
               std::span<const std::uint8_t> pixels);

}  // namespace bitspan
