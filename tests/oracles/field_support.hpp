// SPDX-License-Identifier: Apache-2.0
// Height fields for the Y-buffer and the floating horizon.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "golden/section_lines.hpp"
#include "scene/generate/height_field.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan::test {

// Every second sample of the hills of tests/data; in long runs of the sample data of Debian's Matplotlib
// where it is, 344 x 403 elevations. No slope is above 70 degrees, so that both are height fields in the
// vertical direction of a picture up to a pitch of 20.
inline HeightField hills() {
  const std::string real = "/usr/share/matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz";
  const bool is_real = is_long_run() && std::filesystem::exists(real);
  HeightField field = every_nth(read_height_field(is_real ? real : source_path("tests/data/hills.png")), 2);
  const auto [low, high] = std::ranges::minmax(field.heights);
  const double scale = (is_real ? 12 : 10) / (high - low);
  for (double& height : field.heights) height = (height - low) * scale;
  return field;
}

// Every sample a vertex, every square two triangles that look upward.
inline Mesh mesh_of(const HeightField& field) {
  Mesh mesh;
  mesh.name = "field";
  const auto corner = [&](int i, int j) {
    Corner out;
    out.position = {i - (field.columns - 1) / 2.0, field.at(i, j), j - (field.rows - 1) / 2.0};
    return out;
  };
  for (int j = 0; j + 1 < field.rows; ++j) {
    for (int i = 0; i + 1 < field.columns; ++i) {
      mesh.faces.push_back({{corner(i, j), corner(i, j + 1), corner(i + 1, j + 1)}});
      mesh.faces.push_back({{corner(i, j), corner(i + 1, j + 1), corner(i + 1, j)}});
    }
  }
  return mesh;
}

struct FieldView {
  double yaw = 0, pitch = 20;
  int width = 160, height = 120;
  Projection projection = Projection::orthographic;
};
// A configuration in whose parallel projections depth is linear.
inline Config field_config() {
  Config config = shipped_config("depth20");
  config.depth_line = DepthLine::z;
  return config;
}
inline Scene field_scene(const HeightField& field, const FieldView& view) {
  MeshOptions options;
  options.width = view.width;
  options.height = view.height;
  options.unlit = true;
  options.project.cull = false;  // the lower side is seen under the front edge
  options.camera.yaw_degrees = view.yaw;
  options.camera.pitch_degrees = view.pitch;
  options.camera.projection = view.projection;
  ProjectReport report;
  return mesh_scene(mesh_of(field), options, report);
}
// As oracles take it.
inline Scene field_by_distance(const HeightField& field, const FieldView& view) {
  return by_distance(field_config(), field_scene(field, view)).value();
}

// A field in the picture: of the same x and 1/S no two points differ in y. On a grid of half pixels, so that
// many centres lie on sides and corners.
inline Scene random_field(Random& draw, bool on_half_pixels, int width = 24, int height = 24) {
  constexpr int columns = 7;
  constexpr int rows = 6;
  std::vector<At> points;
  for (int k = 0; k < rows; ++k) {
    for (int i = 0; i < columns; ++i) {
      const double step = (width + 8.0) / (columns - 1);
      double x = -4 + step * (i + draw.uniform(-0.2, 0.2));
      double y = k == 0 ? draw.uniform(height / 2.0, height + 4) : draw.uniform(-4, height + 0.5);
      if (on_half_pixels) {
        x = std::round(2 * x) / 2;
        y = std::round(2 * y) / 2;
      }
      points.push_back({x, y, 1 / (0.9 - 0.15 * (k + draw.uniform(-0.2, 0.2)))});
    }
  }
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k + 1 < rows; ++k) {
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const At& a = points[k * columns + i];
      const At& b = points[k * columns + i + 1];
      const At& c = points[(k + 1) * columns + i];
      const At& d = points[(k + 1) * columns + i + 1];
      triangles.push_back(triangle_of(a, b, c));
      triangles.push_back(triangle_of(b, d, c));
    }
  }
  for (std::size_t i = triangles.size(); i > 1; --i) {
    std::swap(triangles[i - 1],
              triangles[static_cast<std::size_t>(draw.integer(0, static_cast<std::int64_t>(i) - 1))]);
  }
  return scene_of(std::move(triangles), width, height);
}

inline std::string refusal_of(const std::string& oracle, const Config& config, const Scene& scene) {
  return find_oracle(oracle)->refuses(config, scene);
}

}  // namespace bitspan::test
