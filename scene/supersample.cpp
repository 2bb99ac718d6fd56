// SPDX-License-Identifier: Apache-2.0
#include "scene/supersample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/config.hpp"
#include "scene/picture_size.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {

Scene supersampled(Scene scene, int k, std::int64_t first_index) {
  const Size size{scene.width * k, scene.height * k};
  if (!is_legal(size)) {
    throw InputError(
        fmt::format("{}: {} x {} samples of {} x {} pixels are too large a picture; expected at most {} each "
                    "way and {} in all",
                    scene.name, k, k, scene.width, scene.height, picture_size_limit, picture_area_limit));
  }
  scene.width = size.width;
  scene.height = size.height;
  scene.focal *= k;
  for (Triangle& triangle : scene.triangles) {
    for (Vertex& v : triangle.v) {
      v.x *= k;
      v.y *= k;
      if (std::fabs(v.x) <= coordinate_limit && std::fabs(v.y) <= coordinate_limit) continue;
      throw InputError(
          fmt::format("{}: triangle {}: a position times {} is beyond {} pixels; expected fewer samples",
                      scene.name, first_index + (&triangle - scene.triangles.data()), k, coordinate_limit));
    }
  }
  for (DrawCommand& command : scene.commands) {
    if (auto* view = std::get_if<ViewChange>(&command.what)) {
      if (view->width) *view->width *= k;
      if (view->height) *view->height *= k;
      if (view->focal) *view->focal *= k;
    }
    auto* change = std::get_if<StateChange>(&command.what);
    if (change == nullptr) continue;
    for (StateSetting& setting : change->settings) {
      if (!state_registers()[setting.index].key.starts_with("scissor.")) continue;
      setting.value = std::min<std::int64_t>(setting.value * k, scissor_limit);
    }
  }
  return scene;
}

}  // namespace bitspan
