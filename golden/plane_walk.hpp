// Stage `plane_walk`: a triangle to its rows of constant depth; const_depth_rows only. [N1, N2]
#pragma once

#include <functional>
#include <vector>

#include "config/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

struct PlaneRows {
  PlaneRecord plane;
  std::vector<PlaneRowRecord> rows;
  std::vector<std::uint8_t> covered;  // 1 or 0 for each walked pixel, row after row
};

// Replaces what `out` held.
using PlaneWalkStage = std::function<void(const SetupRecord&, PlaneRows& out)>;
PlaneWalkStage make_plane_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                               int width, int height);

}  // namespace bitspan::golden
