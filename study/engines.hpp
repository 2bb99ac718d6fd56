// SPDX-License-Identifier: Apache-2.0
// What a study asks of the engines, which it makes by name.
#pragma once

#include <string_view>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Returns the picture of a scene that the engine of that name draws.
Frame drawn(std::string_view engine, const Config& config, const Scene& scene);

}  // namespace bitspan
