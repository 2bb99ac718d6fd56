// SPDX-License-Identifier: Apache-2.0
// Scenes for oracles, and the comparison of an oracle with the model over one.
#pragma once

#include <string>
#include <vector>

#include "engine/registry.hpp"
#include "report/visibility.hpp"
#include "scene/random.hpp"
#include "study/bounds/bounds.hpp"

namespace bitspan::test {

struct At {
  double x, y, s;
};
inline Triangle triangle_of(At a, At b, At c) {
  Triangle out;
  const std::array<At, 3> at{a, b, c};
  for (std::size_t i = 0; i < 3; ++i) {
    out.v[i].x = at[i].x;
    out.v[i].y = at[i].y;
    out.v[i].s = at[i].s;
  }
  return out;
}

inline Scene scene_of(std::vector<Triangle> triangles, int width = 64, int height = 48) {
  Scene scene;
  scene.name = "oracles";
  scene.width = width;
  scene.height = height;
  scene.s_min = 1;
  scene.s_max = 100;
  scene.triangles = std::move(triangles);
  return scene;
}

// A triangle on the left that is near at its top, and one that is near at its bottom: they cut each other.
inline Scene two_that_cut() {
  return scene_of({triangle_of({4, 4, 10}, {60, 8, 10}, {30, 44, 30}),
                   triangle_of({4, 40, 10}, {60, 44, 10}, {34, 4, 30})});
}

// Opaque triangles without a texture that reach across the picture at all distances.
inline Scene random_opaque_scene(std::uint64_t seed) {
  RandomOptions options;
  options.width = 96;
  options.height = 72;
  options.triangles = 40;
  options.size_max = 120;
  options.depth_ratio_max = 50;
  options.textures = 0;
  options.fog_probability = 0;
  options.translucent_probability = 0;
  return random_scene(seed, options);
}

inline Frame drawn_by(const std::string& engine, const Config& config, const Scene& scene) {
  const auto drawing = make_engine(engine, config);
  drawing->begin(scene);
  draw_scene(*drawing, scene, 0, scene.triangles.size(), nullptr);
  return drawing->frame();
}

// Of an engine's frame with an oracle's picture of a scene.
inline VisibilityReport compared(const Oracle& oracle, const Config& config, const Scene& scene,
                                 const Frame& frame) {
  const Visibility visibility(config, scene, stored_depth_bounds(config, scene));
  return visibility.compare(oracle, visibility.picture(oracle), frame, "engine");
}

inline const Oracle& oracle_named(const std::string& name) { return *parse_oracles(name).front(); }

}  // namespace bitspan::test
