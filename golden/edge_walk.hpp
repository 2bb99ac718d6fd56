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

// Takes a triangle and its edges that have height; appends the rows to the last argument.
using EdgeWalkStage =
    std::function<void(const SetupRecord&, std::span<const EdgeRecord>, std::vector<RowRecord>&)>;
EdgeWalkStage make_edge_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                             int width, int height);

}  // namespace bitspan::golden
