// SPDX-License-Identifier: Apache-2.0
// Stage `resolve_samples`: the mean of the samples of each pixel. [H9]
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "config/format.hpp"

namespace bitspan::golden {

// samples: RGBA of a picture of width * k by height * k samples. Returns RGBA of width * height pixels, on
// the format, which holds codes of 8 bits.
std::vector<std::uint8_t> resolve_samples(std::span<const std::uint8_t> samples, int width, int height, int k,
                                          const Format& format);

}  // namespace bitspan::golden
