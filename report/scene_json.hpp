// SPDX-License-Identifier: Apache-2.0
// A scene with its textures as JSON, for files that must need no other file.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scene/scene.hpp"

namespace bitspan {

// Numbers are the shortest that read back as the same double. The name is left out.
nlohmann::ordered_json scene_json(const Scene& scene);
// Throws InputError or a nlohmann::json::exception; check_scene is the caller's.
Scene scene_of(const nlohmann::ordered_json& json);
// What was wrong with a JSON text, and where; without the text read last, which may be all of it.
std::string fault_of(const nlohmann::json::exception& error);

}  // namespace bitspan
