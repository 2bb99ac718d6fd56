// SPDX-License-Identifier: Apache-2.0
// Scenes for oracles, and the comparison of an oracle with the model over one.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "engine/registry.hpp"
#include "report/visibility.hpp"
#include "scene/mesh.hpp"
#include "scene/random.hpp"
#include "study/bounds/bounds.hpp"
#include "tests/support/files.hpp"
#include "tests/support/test_config.hpp"

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

// `count` triangles with corners in [x.first, x.second] by [y.first, y.second], whose distances are up to a
// factor of `ratio` apart.
inline Scene scattered_scene(Random& draw, double ratio, int count, std::pair<double, double> x,
                             std::pair<double, double> y) {
  std::vector<Triangle> triangles;
  const auto corner = [&] {
    return At{draw.uniform(x.first, x.second), draw.uniform(y.first, y.second),
              draw.log_uniform(1 / std::sqrt(ratio), std::sqrt(ratio))};
  };
  for (int i = 0; i < count; ++i) triangles.push_back(triangle_of(corner(), corner(), corner()));
  return scene_of(std::move(triangles));
}

// A triangle on the left that is near at its top, and one that is near at its bottom: they cut each other.
inline Scene two_that_cut() {
  return scene_of({triangle_of({4, 4, 10}, {60, 8, 10}, {30, 44, 30}),
                   triangle_of({4, 40, 10}, {60, 44, 10}, {34, 4, 30})});
}

// Opaque triangles without a texture that reach across the picture at all distances.
inline RandomOptions opaque_options() {
  RandomOptions options;
  options.width = 96;
  options.height = 72;
  options.triangles = 40;
  options.size_max = 120;
  options.depth_ratio_max = 50;
  options.textures = 0;
  options.fog_probability = 0;
  options.translucent_probability = 0;
  return options;
}
inline Scene random_opaque_scene(std::uint64_t seed) { return random_scene(seed, opaque_options()); }

// Three bars: each lies over the next one at one end, and below the last one at the other.
inline Scene three_in_a_cycle() {
  return scene_of({triangle_of({4, 6, 10}, {60, 10, 30}, {4, 14, 10}),
                   triangle_of({60, 6, 10}, {34, 46, 30}, {50, 6, 10}),
                   triangle_of({40, 46, 10}, {6, 4, 30}, {28, 46, 10})});
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

inline const Oracle& oracle_named(const std::string& name) {
  const Oracle* const known = find_oracle(name);
  if (known == nullptr) throw std::invalid_argument("no oracle " + name);
  return *known;
}

inline std::vector<Visible> picture_of(const std::string& oracle, const Config& config, const Scene& scene) {
  const std::vector<OracleFace> faces = golden::faces_of_scene(config, scene);
  return oracle_named(oracle).visible({config, scene, faces});
}

inline std::int32_t triangle_at(const std::vector<Visible>& picture, const Scene& scene, int x, int y) {
  return picture[static_cast<std::size_t>(y * scene.width + x)].triangle;
}

// What two oracles see must be the same triangle, exactly as far.
struct Agreement {
  std::uint64_t seen = 0, background = 0, differences = 0;
};
inline void compare_pictures(const std::vector<Visible>& a, const std::vector<Visible>& b, Agreement& to) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool equal = a[i].triangle == b[i].triangle && (a[i].triangle < 0 || a[i].q == b[i].q);
    to.differences += equal ? 0 : 1;
    (a[i].triangle < 0 ? to.background : to.seen) += 1;
  }
}
// Of an oracle with a brute force by half planes.
inline Agreement agreement(const std::string& oracle, const Config& config, const Scene& scene) {
  Agreement out;
  compare_pictures(picture_of(oracle, config, scene), picture_of("half_planes", config, scene), out);
  return out;
}

inline Scene spot(int width, int height) {
  MeshOptions options;
  options.width = width;
  options.height = height;
  ProjectReport report;
  const std::string folder = source_path("tests/data/");
  return mesh_scene(read_mesh(folder + "spot.obj", folder + "spot.png"), options, report);
}

// The scene with a bias of depth on one triangle, which the comparison is not told of.
inline Scene biased(Scene scene, std::size_t triangle, std::int64_t codes) {
  const std::size_t depth_bias = *find_state_register("depth.bias");
  scene.commands.push_back({triangle, StateChange{false, {{depth_bias, codes}}}});
  scene.commands.push_back({triangle + 1, StateChange{false, {{depth_bias, 0}}}});
  return scene;
}

// An oracle over random streams in the shipped configurations: a line with the counts, and a failure per
// stream with an unexplained pixel.
inline void hold_random_streams(const std::string& oracle, std::uint64_t streams, std::uint64_t first_seed,
                                const RandomOptions& options = opaque_options()) {
  const std::vector<Config> configs = shipped_configs();
  std::uint64_t equal = 0;
  std::uint64_t ties = 0;
  std::uint64_t unexplained = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + streams; ++seed) {
    const Config& config = configs[seed % configs.size()];
    const Scene scene = random_scene(seed, options);
    const VisibilityReport report =
        compared(oracle_named(oracle), config, scene, drawn_by("model", config, scene));
    EXPECT_EQ(report.unexplained, 0U)
        << oracle << ", " << config.name << ", seed " << seed << ": " << report.first;
    equal += report.equal;
    ties += report.ties;
    unexplained += report.unexplained;
  }
  printf("%s, %llu random streams, seeds from %llu: %llu pixels equal, %llu ties, %llu unexplained\n",
         oracle.c_str(), static_cast<unsigned long long>(streams),
         static_cast<unsigned long long>(first_seed), static_cast<unsigned long long>(equal),
         static_cast<unsigned long long>(ties), static_cast<unsigned long long>(unexplained));
  EXPECT_GT(equal, 500 * streams);
}

}  // namespace bitspan::test
