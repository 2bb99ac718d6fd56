// SPDX-License-Identifier: Apache-2.0
// Stage `light`: the brightness of a surface, and a fragment's colour times it. [L1, L2, L4, L5, L6]
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

// Takes fragments that are drawn, the texture's record of each, the distance of each where there are any, and
// the first of the channels in use of each; by_map: the textures' texels are normals. Appends a record for
// each.
using LightStage =
    std::function<void(std::span<const FragmentRecord* const>, std::span<const TextureRecord* const>,
                       std::span<const DistanceRecord* const>, std::span<const FragmentChannelRecord* const>,
                       const DrawState& state, std::vector<LightRecord>& out)>;
// The scene has a light, and the configuration takes it.
LightStage make_light(Arithmetic arithmetic, const Config& config, const Constants& constants,
                      const Scene& scene);

// The channel light at a vertex. Throws InputError where the configuration does not take the scene's light.
VertexLight make_vertex_light(const Config& config, int s_exponent, const Scene& scene);

}  // namespace bitspan::golden
