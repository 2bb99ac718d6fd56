// SPDX-License-Identifier: Apache-2.0
// Which textures may have a mip chain; docs/numeric-spec.md, "Levels". The texels of a chain are each
// engine's own.
#pragma once

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Throws InputError, naming the first texture whose sides are no powers of two up to 2^max_mip_level, where
// the configuration has mip chains.
void check_mip_textures(const Config& config, const Scene& scene);

}  // namespace bitspan
