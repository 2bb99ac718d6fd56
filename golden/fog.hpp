// SPDX-License-Identifier: Apache-2.0
// Stage `fog`: moves a fragment's colour toward the fog's. [F1, F2, F3, F4]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "golden/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments, the texture stage's record of each, the distance of each where the mode takes it, and the
// first of the channels in use of each where there are any; appends a record for each.
using FogStage =
    std::function<void(std::span<const FragmentRecord* const>, std::span<const TextureRecord* const>,
                       std::span<const DistanceRecord* const>, std::span<const FragmentChannelRecord* const>,
                       std::vector<FogRecord>& out)>;
FogStage make_fog(Arithmetic arithmetic, const Config& config, const Constants& constants,
                  const Scene& scene);

// Returns Q(exp(-d / distance)) as a raw value; both are above 0.
std::int64_t faded(const Quantizer<Quad>& q, Quad d, Quad distance);

// Returns the fog table's raw entries on fog.factor; those of one depth step are adjacent in mode table. The
// scene has fog. [F1, F2]
std::vector<std::int64_t> fog_table(const Config& config, const Constants& constants, const Scene& scene);

}  // namespace bitspan::golden
