// Stage `setup`: a triangle to its quantised, sorted vertices, and those to its edges' increments.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// (triangle, its input index): none where the snapped triangle has no area. s in s_min..s_max, all finite.
using SetupStage = std::function<std::optional<SetupRecord>(const Triangle&, std::int64_t)>;
SetupStage make_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

// The edges that have height, in the order 0, 1, 2; modes with horizontal rows. Gives their number.
using EdgeSetupStage = std::function<int(const SetupRecord&, std::array<EdgeRecord, 3>&)>;
EdgeSetupStage make_edge_setup(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
