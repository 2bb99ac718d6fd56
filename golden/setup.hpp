// SPDX-License-Identifier: Apache-2.0
// Stage `setup`: makes quantised, sorted vertices from a triangle, and the edges' increments from those.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes a triangle and its input index; returns none where the snapped triangle has no area. s is in
// s_min..s_max, and all numbers are finite. Appends a record per channel in use, whose steps and gradients
// the stages below fill in.
using SetupStage = std::function<std::optional<SetupRecord>(const Triangle&, std::int64_t,
                                                            std::vector<SetupChannelRecord>& channels)>;
SetupStage make_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

// Writes the edges that have height, in the order 0, 1, 2, and returns their number; modes with horizontal
// rows.
using EdgeSetupStage =
    std::function<int(const SetupRecord&, std::array<EdgeRecord, 3>&, std::span<SetupChannelRecord>)>;
EdgeSetupStage make_edge_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
