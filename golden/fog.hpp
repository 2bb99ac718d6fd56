// SPDX-License-Identifier: Apache-2.0
// Stage `fog`: moves a fragment's colour toward the fog's. [F2, F3]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments and the texture stage's record of each; appends a record for each.
using FogStage = std::function<void(std::span<const FragmentRecord* const>,
                                    std::span<const TextureRecord* const>, std::vector<FogRecord>& out)>;
FogStage make_fog(Arithmetic arithmetic, const Config& config, const Constants& constants,
                  const Scene& scene);

// Returns the fog table's raw entries on fog.factor; the entries of one depth step are adjacent. The scene
// has fog. [F2]
std::vector<std::int64_t> fog_table(const Config& config, const Constants& constants, const Scene& scene);

}  // namespace bitspan::golden
