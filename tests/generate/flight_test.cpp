// SPDX-License-Identifier: Apache-2.0
// A flight over rings, drawn by the model: no pixel shows the background through a crack.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "engine/registry.hpp"
#include "scene/generate/terrain.hpp"
#include "scene/mesh.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr int columns = 403, rows = 344;
constexpr std::array<std::uint8_t, 3> background{255, 0, 255};

// Slopes are below 1/2.
HeightField hills() {
  HeightField field{columns, rows, {}};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      field.heights.push_back(std::round(100 * std::sin(0.3 * i) * std::cos(0.2 * j)) +
                              std::round(8 * std::sin(1.1 * i + 0.7 * j)));
    }
  }
  return field;
}
constexpr double vertical = 0.01;

// The viewer of a frame, in samples, and which way it flies: along an ellipse, in the middle of the field.
struct Flight {
  double x, z, along_x, along_z;
};
Flight flight(double part) {
  const double angle = 6.3 * part;
  return {columns / 2.0 + 120 * std::cos(angle), rows / 2.0 + 90 * std::sin(angle), -120 * std::sin(angle),
          90 * std::cos(angle)};
}

RingMesh rings_at(const Flight& at) { return ring_mesh(columns, rows, {at.x, at.z, 8}); }

// Squares beside finer ones without the vertices in the middle of their edges: two triangles each.
RingMesh without_stitches(RingMesh mesh) {
  std::vector<std::array<std::uint32_t, 3>> out;
  for (std::size_t first = 0; first < mesh.triangles.size();) {
    // The triangles of a square that has its middle begin with it.
    const std::uint32_t middle = mesh.triangles[first][0];
    std::size_t end = first;
    while (end < mesh.triangles.size() && mesh.triangles[end][0] == middle) ++end;
    std::vector<std::uint32_t> corners;
    const auto& at = mesh.vertices[middle];
    for (std::size_t k = first; k < end; ++k) {
      const auto& v = mesh.vertices[mesh.triangles[k][1]];
      if (v[0] != at[0] && v[1] != at[1]) corners.push_back(mesh.triangles[k][1]);
    }
    if (end - first > 4 && corners.size() == 4) {
      out.push_back({corners[0], corners[1], corners[2]});
      out.push_back({corners[2], corners[3], corners[0]});
    } else {
      out.insert(out.end(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first),
                 mesh.triangles.begin() + static_cast<std::ptrdiff_t>(end));
    }
    first = end;
  }
  mesh.triangles = std::move(out);
  return mesh;
}

// Draws what a viewer sees of the ground, and returns how many pixels show the background. All lines of sight
// go down more steeply than any face, and meet the field. So each pixel should show a face from above. Back
// faces are not drawn: through a crack there is the background.
std::uint64_t cracks_seen(const HeightField& field, const RingMesh& rings, const Flight& at) {
  const PlacedField placed(field, {.vertical = vertical});
  Mesh mesh;
  mesh.name = "flight";
  for (const auto& triangle : rings.triangles) {
    Face& face = mesh.faces.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& v = rings.vertices[triangle[k]];
      Corner& corner = face.corner[k];
      corner.position = placed.position(v[0], v[1]);
      corner.c = {0, 0.5 + 0.5 * std::sin(0.5 * v[0] + v[1]), 0, 1};
    }
  }
  MeshOptions options;
  options.width = 160;
  options.height = 120;
  options.background = background;
  options.unlit = true;
  const Vec3 eye = placed.position(at.x, at.z) + Vec3{0, 30, 0};
  const double speed = std::hypot(at.along_x, at.along_z);
  options.camera.position = eye;
  options.camera.target = eye + Vec3{at.along_x / speed, -1.5, at.along_z / speed};
  options.camera.fov_degrees = 45;
  options.camera.s_min = 10;
  options.camera.s_max = 100;
  ProjectReport report;
  const Scene scene = mesh_scene(std::move(mesh), options, report);
  const auto engine = make_engine("model", shipped_config("depth20"));
  engine->begin(scene);
  draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
  const Frame& frame = engine->frame();

  std::uint64_t out = 0;
  for (std::size_t pixel = 0; pixel < frame.color.size(); pixel += 4) {
    out += std::equal(background.begin(), background.end(),
                      frame.color.begin() + static_cast<std::ptrdiff_t>(pixel))
               ? 1
               : 0;
  }
  return out;
}

// Cracks of a flight, in all; a line with the count.
template <class Change>
std::uint64_t fly(int frames, const char* what, const Change& change) {
  const HeightField field = hills();
  std::uint64_t all = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Flight at = flight(frame / (frames - 1.0));
    all += cracks_seen(field, change(rings_at(at)), at);
  }
  printf("%d frames of 160x120, %s: %llu pixels of cracks\n", frames, what,
         static_cast<unsigned long long>(all));
  return all;
}

// The long form is all of the flight.
TEST(Flight, NoPixelShowsTheBackgroundThroughACrack) {
  EXPECT_EQ(fly(is_long_run() ? 300 : 12, "rings", [](RingMesh mesh) { return mesh; }), 0U);
}

TEST(Flight, RingsWithoutStitchesShowCracks) { EXPECT_GT(fly(6, "without stitches", without_stitches), 60U); }

}  // namespace
}  // namespace bitspan
