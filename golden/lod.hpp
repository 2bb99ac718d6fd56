// SPDX-License-Identifier: Apache-2.0
// Stage `lod`: the level of detail of a fragment, and the gradients that setup forms for it. [T10, T11]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

using GradientStage = std::function<GradientRecord(const SetupRecord&)>;
GradientStage make_gradients(Arithmetic arithmetic, const Config& config, const Constants& constants);

// Takes fragments of one triangle, its gradients (which only modes gradient and finite read), the fragments'
// distances (zone_d alone), and how many levels its texture has; appends a record for each.
using LodStage =
    std::function<void(std::span<const FragmentRecord* const>, const GradientRecord&,
                       std::span<const DistanceRecord>, int levels, std::vector<LodRecord>& out)>;
LodStage make_lod(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
