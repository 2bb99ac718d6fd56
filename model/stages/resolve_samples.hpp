// SPDX-License-Identifier: Apache-2.0
// resolve_samples: the mean of the samples of each pixel, behind the last triangle (H9).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "config/format.hpp"

namespace bitspan::model {

// samples: RGBA, rows of width * k samples, height * k of them. Returns RGBA of width * height pixels.
// format: of codes of 8 bits.
std::vector<std::uint8_t> resolve_samples(std::span<const std::uint8_t> samples, int width, int height, int k,
                                          const Format& format);

}  // namespace bitspan::model
