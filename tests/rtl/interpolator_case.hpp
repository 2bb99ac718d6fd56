// SPDX-License-Identifier: Apache-2.0
// Random records of one configuration with what the span interpolator must make of them.
#pragma once

#include <vector>

#include "tb/rtl_stream.hpp"
#include "tests/rtl/random_rtl.hpp"
#include "tests/rtl/reference.hpp"

namespace bitspan {

struct InterpolatorCase {
  std::vector<RtlInputs> inputs;
  std::vector<SpanRecord> spans;
  std::vector<reference::Pixel> pixels;
  // The channels, side by side per span and per pixel.
  std::vector<SpanChannelRecord> span_channels;
  std::vector<FragmentChannelRecord> pixel_channels;
};

// Spans of 1 to `longest` pixels.
InterpolatorCase make_interpolator_case(Random& random, const Config& config, int records, int longest);

}  // namespace bitspan
