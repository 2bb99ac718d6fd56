// SPDX-License-Identifier: Apache-2.0
// Stage `lod`: the level of detail of a fragment, and the gradients that setup forms for it. [T10, T11]
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::golden {

using GradientStage = std::function<GradientRecord(const SetupRecord&)>;
GradientStage make_gradients(Arithmetic arithmetic, const Config& config, const Constants& constants);

// Takes fragments of one triangle, its gradients (which only modes gradient and finite read), the fragments'
// distances (zone_d alone), how many levels its texture has, and the draw state; appends a record for each.
using LodStage = std::function<void(std::span<const FragmentRecord* const>, const GradientRecord&,
                                    std::span<const DistanceRecord>, int levels, const DrawState&,
                                    std::vector<LodRecord>& out)>;
LodStage make_lod(Arithmetic arithmetic, const Config& config, const Constants& constants);

// A level of detail held to a range.
template <class Real>
Real within(const LevelRange& range, Real lambda) {
  return std::max(std::min(lambda, Real(range.greatest)), Real(range.least));
}

}  // namespace bitspan::golden
