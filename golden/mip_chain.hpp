// SPDX-License-Identifier: Apache-2.0
// The mip chain of a texture as golden and ideal have it; docs/numeric-spec.md, "Levels". [T10]
#pragma once

#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Returns the levels, the texture itself first. The sides are powers of two.
std::vector<Texture> mip_levels(const Texture& texture);

// The mip chain of each texture of a scene; none where the configuration has none.
using SceneLevels = std::vector<std::vector<Texture>>;
// Throws InputError where a texture cannot have a chain.
SceneLevels scene_levels(const Config& config, const Scene& scene);

}  // namespace bitspan::golden
