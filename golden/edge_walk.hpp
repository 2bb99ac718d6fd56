// SPDX-License-Identifier: Apache-2.0
// Stage `edge_walk`: makes rows from a triangle's edges, in the modes with horizontal rows.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/bands.hpp"
#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// Takes a triangle, its edges that have height, its channels, and the rows that are drawn; appends these
// rows, and their channels where edges carry values. Returns how many rows above them the edges are walked
// over.
using EdgeWalkStage = std::function<std::int64_t(const SetupRecord&, std::span<const EdgeRecord>,
                                                 std::span<const SetupChannelRecord>, const RowRange&,
                                                 std::vector<RowRecord>&, std::vector<RowChannelRecord>&)>;
EdgeWalkStage make_edge_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                             int width, int height);

}  // namespace bitspan::golden
