// Stage `edge_walk`: a triangle's edges to its rows; the modes with horizontal rows.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// (triangle, its edges that have height, where its rows are appended)
using EdgeWalkStage =
    std::function<void(const SetupRecord&, std::span<const EdgeRecord>, std::vector<RowRecord>&)>;
EdgeWalkStage make_edge_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                             int width, int height);

}  // namespace bitspan::golden
