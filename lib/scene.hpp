// SPDX-License-Identifier: Apache-2.0
// Scenes and triangles as the interface has them. Each function checks all that an engine relies on, and
// throws where it does not hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "bitspan/bitspan.h"
#include "scene/scene.hpp"

namespace bitspan::capi {

inline constexpr std::size_t texture_count_limit = 65536;

// Returns the scene that a caller describes, without triangles.
Scene scene_from(const bs_scene_desc* from);
// Returns triangle i of an array of vertices. index: its input index, for messages.
Triangle triangle_from(const bs_vertex* vertices, std::size_t i, std::int32_t texture, const Scene& scene,
                       const View& view, std::int64_t index, const char* function);
void check_texture(const Scene& scene, std::int32_t texture, const char* function);

// The scene that was read, as long as the pointer lives. Throws BS_BAD_HANDLE.
std::shared_ptr<const Scene> scene_of(const bs_scene* scene, const char* function);

}  // namespace bitspan::capi
