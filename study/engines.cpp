// SPDX-License-Identifier: Apache-2.0
#include "study/engines.hpp"

#include "engine/registry.hpp"

namespace bitspan {

Frame drawn(std::string_view engine, const Config& config, const Scene& scene) {
  const auto made = make_engine(engine, config);
  made->begin(scene);
  draw_scene(*made, scene, 0, scene.triangles.size(), nullptr);
  return made->frame();
}

}  // namespace bitspan
