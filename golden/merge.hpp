// Stage `merge`: a fragment blended into the stored colour. [T5]
#pragma once

#include <array>
#include <functional>

#include "config/records.hpp"
#include "golden/arithmetic.hpp"

namespace bitspan::golden {

// (fog's colour, texture's alpha, depth's code, the stored colour)
using MergeStage = std::function<MergeRecord(const FogRecord&, const TextureRecord&, const DepthRecord&,
                                             const std::array<std::uint8_t, 3>&)>;
MergeStage make_merge(Arithmetic arithmetic, const Config& config);

}  // namespace bitspan::golden
