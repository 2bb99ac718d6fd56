// SPDX-License-Identifier: Apache-2.0
// Stage `merge`: blends a fragment into the stored colour. [T5]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "golden/arithmetic.hpp"

namespace bitspan::golden {

// Takes the colours of fog, the alphas of texture, the codes of depth and the RGBA of the picture's rows in
// `grid`. Appends a record for each fragment, all of them of one triangle; alphas: where the draw state may
// change the stored alpha. They hold what the target will hold. The picture stays as it is.
using MergeStage = std::function<void(std::span<const FogRecord>, std::span<const TextureRecord* const>,
                                      std::span<const DepthRecord* const>, const DrawState&,
                                      std::span<const std::uint8_t> stored, PixelGrid grid,
                                      std::vector<MergeRecord>& out, std::vector<MergeAlphaRecord>& alphas)>;
MergeStage make_merge(Arithmetic arithmetic, const Config& config);

// A logic operation on codes 0..255; not `none`.
int logic(LogicOp op, unsigned src, unsigned dst);

}  // namespace bitspan::golden
