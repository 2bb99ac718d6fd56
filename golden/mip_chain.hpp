// SPDX-License-Identifier: Apache-2.0
// The mip chain of a texture as golden and ideal have it; docs/numeric-spec.md, "Levels". [T10]
#pragma once

#include <vector>

#include "scene/scene.hpp"

namespace bitspan::golden {

// Returns the levels, the texture itself first. The sides are powers of two.
std::vector<Texture> mip_levels(const Texture& texture);

}  // namespace bitspan::golden
