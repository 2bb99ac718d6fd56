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

// Takes spans of a triangle, the channels in use of each, its plane and the covered flags of their pixels;
// appends the fragments, and their channels. The plane is null and the flags are empty in the modes with
// horizontal rows.
using SpanStage = std::function<void(std::span<const SpanRecord>, std::span<const SpanChannelRecord>,
                                     const PlaneRecord*, std::span<const std::uint8_t>,
                                     std::vector<FragmentRecord>&, std::vector<FragmentChannelRecord>&)>;
SpanStage make_span(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
