// SPDX-License-Identifier: Apache-2.0
// Stage `setup`, where rows start from the triangle's plane: its numerators at the vertices, and its
// gradients.
#pragma once

#include <functional>
#include <span>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// Takes a triangle that has an area; writes the gradients of its channels.
using SetupPlaneStage =
    std::function<SetupPlaneRecord(const SetupRecord&, std::span<SetupChannelRecord> channels)>;
SetupPlaneStage make_setup_plane(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
