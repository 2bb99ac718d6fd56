// SPDX-License-Identifier: Apache-2.0
// Stage `edge_walk`: makes rows from a triangle's edges, in the modes with horizontal rows.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// Takes a triangle, its edges that have height, and its channels; appends the rows, and their channels where
// edges carry values.
using EdgeWalkStage =
    std::function<void(const SetupRecord&, std::span<const EdgeRecord>, std::span<const SetupChannelRecord>,
                       std::vector<RowRecord>&, std::vector<RowChannelRecord>&)>;
EdgeWalkStage make_edge_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                             int width, int height);

}  // namespace bitspan::golden
