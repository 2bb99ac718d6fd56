// Stage `span`: a span to its fragments, one a pixel.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// (spans of a triangle, its plane, the covered flags of their pixels, where their fragments are appended).
// The plane is null and the flags are empty in the modes with horizontal rows.
using SpanStage = std::function<void(std::span<const SpanRecord>, const PlaneRecord*,
                                     std::span<const std::uint8_t>, std::vector<FragmentRecord>&)>;
SpanStage make_span(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
