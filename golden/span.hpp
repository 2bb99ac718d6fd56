// SPDX-License-Identifier: Apache-2.0
// Stage `span`: makes fragments from a span, one per pixel.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// What the pixels of spans follow, where that is not a horizontal row: the plane of a triangle, whose flags
// say which pixels are covered, or a line.
struct SpanPath {
  const PlaneRecord* plane = nullptr;
  std::span<const std::uint8_t> covered{};
  const LineWalkRecord* line = nullptr;
};

// Takes spans of a triangle, the channels in use of each, and what they follow; appends the fragments, and
// their channels.
using SpanStage =
    std::function<void(std::span<const SpanRecord>, std::span<const SpanChannelRecord>, SpanPath,
                       std::vector<FragmentRecord>&, std::vector<FragmentChannelRecord>&)>;
SpanStage make_span(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
