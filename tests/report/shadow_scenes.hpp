// SPDX-License-Identifier: Apache-2.0
// Bodies and floors in the viewer's space (y points down), and their pictures.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/registry.hpp"
#include "scene/project.hpp"

namespace bitspan {

inline Frame drawn(const Config& config, const Scene& scene, const char* name) {
  const auto engine = make_engine(name, config);
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  return engine->frame();
}

// What the viewer at 0 sees of the faces, 160x120.
inline Scene seen_scene(const std::vector<Face>& faces) {
  Scene scene;
  scene.width = 160;
  scene.height = 120;
  scene.focal = 150;
  scene.s_min = 2;
  scene.s_max = 60;
  ProjectReport report;
  project(faces, viewer_of(scene), {.cull = false}, scene.triangles, report);
  return scene;
}

// A floor of floor_triangles, and above it a box that stands on nothing.
inline constexpr std::int32_t floor_triangles = 2;
inline std::vector<Face> box_above_floor() {
  std::vector<Face> faces;
  const auto quad = [&](const std::array<Vec3, 4>& p, const std::array<double, 4>& color) {
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
      Face& face = faces.emplace_back();
      face.two_sided = true;
      face.corner[0].position = p[0];
      face.corner[1].position = p[k];
      face.corner[2].position = p[k + 1];
      for (Corner& corner : face.corner) corner.c = color;
    }
  };
  quad({Vec3{-12, 4, 5}, Vec3{12, 4, 5}, Vec3{12, 4, 30}, Vec3{-12, 4, 30}}, {0.9, 0.8, 0.7, 1});
  const auto at = [](int x, int y, int z) { return Vec3{-1 + 2.0 * x, 0.5 + 1.5 * y, 12 + 2.0 * z}; };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto corner = [&](int a, int b) {
        return axis == 0 ? at(side, a, b) : axis == 1 ? at(a, side, b) : at(a, b, side);
      };
      quad({corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}, {0.3, 0.5, 0.9, 1});
    }
  }
  return faces;
}

// How many faces but `own` the segment from the light to a point meets.
inline int faces_between(const std::vector<Face>& faces, const Vec3& light, const Vec3& point,
                         std::int32_t own) {
  int out = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (static_cast<std::int32_t>(f) == own) continue;
    const auto& c = faces[f].corner;
    const Vec3 a = c[0].position - light;
    const Vec3 b = c[1].position - light;
    const Vec3 d = c[2].position - light;
    const Vec3 to = point - light;
    const std::array volume{dot(cross(a, b), to), dot(cross(b, d), to), dot(cross(d, a), to)};
    const bool is_through = std::ranges::all_of(volume, [](double v) { return v > 0; }) ||
                            std::ranges::all_of(volume, [](double v) { return v < 0; });
    if (!is_through) continue;
    const Vec3 normal = cross(b - a, d - a);
    out += dot(normal, a) / dot(normal, to) < 1 ? 1 : 0;
  }
  return out;
}

// The point of a face's plane that the viewer at 0 sees at a place of the picture.
inline Vec3 point_at(const View& view, const Face& face, double x, double y) {
  const Vec3 ray{(x - view.width / 2.0) / view.focal, (y - view.height / 2.0) / view.focal, 1};
  const Vec3& a = face.corner[0].position;
  const Vec3 normal = cross(face.corner[1].position - a, face.corner[2].position - a);
  return ray * (dot(normal, a) / dot(normal, ray));
}

// Whether the light is on the side of a face that the viewer at 0 does not see.
inline bool is_lit_from_behind(const Face& face, const Vec3& light) {
  const Vec3& a = face.corner[0].position;
  const Vec3 normal = cross(face.corner[1].position - a, face.corner[2].position - a);
  return dot(normal, light - a) * dot(normal, Vec3{} - a) < 0;
}

// Whether a pixel and its eight neighbours are inside the picture and alike by the test.
template <class Test>
bool is_inner(const Scene& scene, int x, int y, const Test& test) {
  if (x < 1 || y < 1 || x + 1 >= scene.width || y + 1 >= scene.height) return false;
  const auto at = [&](int dx, int dy) { return static_cast<std::size_t>((y + dy) * scene.width + x + dx); };
  for (int i = 0; i < 9; ++i) {
    if (test(at(i % 3 - 1, i / 3 - 1)) != test(at(0, 0))) return false;
  }
  return true;
}

}  // namespace bitspan
