// The engines that a study measures and compares: the one place of study/ that makes them.
#pragma once

#include <memory>
#include <string_view>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// "ideal", "golden", "model" or "rtl". Throws std::invalid_argument for any other name.
std::unique_ptr<Engine> engine_named(std::string_view name, const Config& config);

// The picture that the engine of that name draws of a scene.
Frame drawn(std::string_view engine, const Config& config, const Scene& scene);

}  // namespace bitspan
