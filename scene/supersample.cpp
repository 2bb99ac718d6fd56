// SPDX-License-Identifier: Apache-2.0
#include "scene/supersample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "config/config.hpp"
#include "scene/picture_size.hpp"
#include "scene/tri_stream.hpp"

namespace bitspan {
namespace {

void enlarge(DrawCommand& command, int k) {
  if (auto* view = std::get_if<ViewChange>(&command.what)) {
    if (view->width) *view->width *= k;
    if (view->height) *view->height *= k;
    if (view->focal) *view->focal *= k;
  }
  auto* change = std::get_if<StateChange>(&command.what);
  if (change == nullptr) return;
  for (StateSetting& setting : change->settings) {
    if (!state_registers()[setting.index].key.starts_with("scissor.")) continue;
    setting.value = std::min<std::int64_t>(setting.value * k, scissor_limit);
  }
}

}  // namespace

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
  // A target that becomes a texture keeps its size.
  std::set<int> kept;
  for (const DrawCommand& command : scene.commands) {
    if (const auto* copy = std::get_if<Copy>(&command.what)) kept.insert(copy->target);
  }
  int target = 0;
  auto command = scene.commands.begin();
  const auto execute_before = [&](std::size_t index) {
    for (; command != scene.commands.end() && command->before <= index; ++command) {
      if (const auto* to = std::get_if<Target>(&command->what)) target = to->k;
      if (!kept.contains(target)) enlarge(*command, k);
    }
  };
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    execute_before(i);
    if (kept.contains(target)) continue;
    for (Vertex& v : scene.triangles[i].v) {
      v.x *= k;
      v.y *= k;
      if (std::fabs(v.x) <= coordinate_limit && std::fabs(v.y) <= coordinate_limit) continue;
      throw InputError(
          fmt::format("{}: triangle {}: a position times {} is beyond {} pixels; expected fewer samples",
                      scene.name, first_index + static_cast<std::int64_t>(i), k, coordinate_limit));
    }
  }
  execute_before(scene.triangles.size());
  return scene;
}

}  // namespace bitspan
