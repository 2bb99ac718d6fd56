// SPDX-License-Identifier: Apache-2.0
// Stage `merge`: blends a fragment into the stored colour. [T5]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"

namespace bitspan::golden {

// Takes the colours of fog, the alphas of texture, the codes of depth and the picture's RGBA, `width` pixels
// per row. Appends a record for each fragment, all of them of one triangle. The picture stays as it is.
using MergeStage = std::function<void(
    std::span<const FogRecord>, std::span<const TextureRecord* const>, std::span<const DepthRecord* const>,
    std::span<const std::uint8_t> stored, int width, std::vector<MergeRecord>& out)>;
MergeStage make_merge(Arithmetic arithmetic, const Config& config);

}  // namespace bitspan::golden
