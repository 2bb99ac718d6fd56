// SPDX-License-Identifier: Apache-2.0
// Parallel projections [B6]: orthographic, isometric, oblique. docs/formats.md, "Meshes and the camera".
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "scene/mesh.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

constexpr double tiny = 1e-9;

MeshOptions small(Projection projection) {
  MeshOptions options;
  options.width = 320;
  options.height = 240;
  options.unlit = true;
  options.camera.projection = projection;
  return options;
}

// From (0, 0, 10) toward the origin; `near` and `far`: s_min and s_max.
MeshOptions from_the_front(Projection projection, double focal, std::optional<double> near = {},
                           std::optional<double> far = {}) {
  MeshOptions options = small(projection);
  options.camera.position = Vec3{0, 0, 10};
  options.camera.target = Vec3{0, 0, 0};
  options.camera.focal = focal;
  options.camera.s_min = near;
  options.camera.s_max = far;
  return options;
}

// Three thin faces from the origin: along x, y and z.
Mesh axes() {
  Mesh mesh;
  mesh.name = "axes";
  for (const Vec3& tip : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    Face& face = mesh.faces.emplace_back();
    face.two_sided = true;
    const Vec3 beside = Vec3{tip.y, tip.z, tip.x} * 0.01;
    face.corner[0].position = {0, 0, 0};
    face.corner[1].position = tip;
    face.corner[2].position = tip + beside;
  }
  return mesh;
}

Scene seen(Mesh mesh, const MeshOptions& options) {
  ProjectReport report;
  return mesh_scene(std::move(mesh), options, report);
}

// From the origin to the tip of an axis, in the picture; y upward.
Vec3 axis(const Scene& scene, std::size_t i) {
  const auto& v = scene.triangles.at(i).v;
  return {v[1].x - v[0].x, v[0].y - v[1].y, 0};
}

TEST(Parallel, IsometricAxesAreEquallyShortAnd120DegreesApart) {
  const Scene scene = seen(axes(), small(Projection::isometric));
  ASSERT_EQ(scene.triangles.size(), 3U);
  const Vec3 x = axis(scene, 0), y = axis(scene, 1), z = axis(scene, 2);
  EXPECT_NEAR(length(x), length(y), tiny);
  EXPECT_NEAR(length(x), length(z), tiny);
  for (const auto& [a, b] : {std::pair{x, y}, {y, z}, {z, x}}) {
    EXPECT_NEAR(dot(a, b) / (length(a) * length(b)), -0.5, tiny);
  }
  EXPECT_NEAR(y.x, 0, tiny);
  EXPECT_GT(y.y, 0);
}

TEST(Parallel, ObliqueLinesRecedeToTheUpperRight) {
  MeshOptions options = small(Projection::oblique);
  options.camera.yaw_degrees = 0;
  options.camera.pitch_degrees = 0;
  const auto receding = [&](double length_of_1, double degrees) {
    options.camera.receding = length_of_1;
    options.camera.receding_degrees = degrees;
    const Scene scene = seen(axes(), options);
    const Vec3 x = axis(scene, 0), y = axis(scene, 1), z = axis(scene, 2);
    EXPECT_NEAR(x.y, 0, tiny);
    EXPECT_NEAR(y.x, 0, tiny);
    EXPECT_NEAR(length(x), length(y), tiny) << "the plane is to scale";
    // z leads toward the viewer.
    return z * (-1 / length(x));
  };
  const Vec3 cabinet = receding(0.5, 45);
  EXPECT_NEAR(cabinet.x, 0.5 * std::sqrt(0.5), tiny);
  EXPECT_NEAR(cabinet.y, 0.5 * std::sqrt(0.5), tiny);
  const Vec3 other = receding(1, 150);
  EXPECT_NEAR(other.x, -std::sqrt(0.75), tiny);
  EXPECT_NEAR(other.y, 0.5, tiny);
}

TEST(Parallel, OrthographicIsToScaleAtTheTargetAndDoesNotShrink) {
  const MeshOptions options = from_the_front(Projection::orthographic, 400);
  Mesh mesh;
  for (const double depth : {-3.0, 0.0, 2.0}) {
    Face& face = mesh.faces.emplace_back();
    face.corner[0].position = {0, 0, depth};
    face.corner[1].position = {1.5, 0, depth};
    face.corner[2].position = {0, 1, depth};
  }
  const Scene scene = seen(mesh, options);
  ASSERT_EQ(scene.triangles.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& v = scene.triangles[i].v;
    EXPECT_NEAR(v[1].x, 160 + 1.5 * 400 / 10, tiny);
    EXPECT_NEAR(v[2].y, 120 - 400 / 10.0, tiny);
    EXPECT_EQ(v[0].s, 10);
    const double s = 10 - std::array{-3.0, 0.0, 2.0}[i];
    EXPECT_NEAR(v[0].z, (s - scene.s_min) / (scene.s_max - scene.s_min), tiny);
  }
}

// A face is seen where the line of sight meets its front, whatever lies on the way to the viewer's place.
TEST(Parallel, CullsByTheLineOfSight) {
  for (const Projection projection : {Projection::central, Projection::orthographic, Projection::oblique}) {
    const MeshOptions options = from_the_front(projection, 100, 5, 20);
    Mesh mesh;
    // The right side of a box that stands at the left: its front is toward +x.
    Face& face = mesh.faces.emplace_back();
    face.corner[0].position = {-4, -1, 0};
    face.corner[1].position = {-4, -1, -2};
    face.corner[2].position = {-4, 1, 0};
    const auto drawn = seen(mesh, options).triangles.size();
    std::swap(mesh.faces[0].corner[1], mesh.faces[0].corner[2]);
    const auto turned = seen(mesh, options).triangles.size();
    EXPECT_EQ(drawn, projection == Projection::orthographic ? 0U : 1U) << to_string(projection);
    EXPECT_EQ(turned, 0U) << to_string(projection) << ": one side at most is seen, and edge on none";
  }
}

// What is cut at the borders keeps its attributes linear in the picture.
TEST(Parallel, ClipsLinearly) {
  for (const Projection projection : {Projection::orthographic, Projection::oblique}) {
    const MeshOptions options = from_the_front(projection, 600, 8, 12);
    Mesh mesh;
    Face& face = mesh.faces.emplace_back();
    face.two_sided = true;
    face.corner[0].position = {-9, -4, 5};
    face.corner[1].position = {9, -5, -3};
    face.corner[2].position = {1, 8, -6};
    for (Corner& corner : face.corner) {
      corner.u = 3 * corner.position.x + 5 * corner.position.z;
      corner.v = corner.position.y - corner.position.z;
    }
    const Scene scene = seen(mesh, options);
    ASSERT_GE(scene.triangles.size(), 3U);
    // The plane through three of the vertices holds the others.
    const auto& base = scene.triangles[0].v;
    const double x1 = base[1].x - base[0].x, y1 = base[1].y - base[0].y;
    const double x2 = base[2].x - base[0].x, y2 = base[2].y - base[0].y;
    for (const Triangle& triangle : scene.triangles) {
      for (const Vertex& v : triangle.v) {
        EXPECT_GE(v.x, -tiny);
        EXPECT_LE(v.x, scene.width + tiny);
        const double x = v.x - base[0].x, y = v.y - base[0].y, area = x1 * y2 - x2 * y1;
        const double a = (x * y2 - x2 * y) / area, b = (x1 * y - x * y1) / area;
        const auto mixed = [&](double at_0, double at_1, double at_2) {
          return at_0 + a * (at_1 - at_0) + b * (at_2 - at_0);
        };
        EXPECT_NEAR(v.z, mixed(base[0].z, base[1].z, base[2].z), 1e-7);
        EXPECT_NEAR(v.u, mixed(base[0].u, base[1].u, base[2].u), 1e-6);
        EXPECT_NEAR(v.v, mixed(base[0].v, base[1].v, base[2].v), 1e-6);
      }
    }
  }
}

// Two walls cross. At each pixel the nearer one is seen, by distances that are linear in the picture.
TEST(Parallel, DepthIsLinearInTheDistance) {
  const MeshOptions options = from_the_front(Projection::orthographic, 500, 5, 15);
  Mesh mesh;
  const auto wall = [&](double slope, double shade) {
    const Vec3 p[] = {{-3, -3, -3 * slope}, {3, -3, 3 * slope}, {3, 3, 3 * slope}, {-3, 3, -3 * slope}};
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}}) {
      Face& face = mesh.faces.emplace_back();
      for (int k = 0; k < 3; ++k) {
        Corner& corner = face.corner[static_cast<std::size_t>(k)];
        corner.position = p[std::array{a, b, c}[static_cast<std::size_t>(k)]];
        corner.c = {shade, shade, shade, 1};
      }
    }
  };
  wall(1, 1);
  wall(-0.25, 0.5);
  const Scene scene = seen(mesh, options);
  Config c = shipped_config("depth16");
  c.depth_line = DepthLine::z;
  int compared = 0;
  for (const auto& engine : {make_model(c), make_golden(c)}) {
    engine->begin(scene);
    draw_scene(*engine, scene, 0, scene.triangles.size(), nullptr);
    const Frame& frame = engine->frame();
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(scene.width) + static_cast<std::size_t>(x);
        if (frame.triangle[at] < 0) continue;
        const double across = (x + 0.5 - 160) * 10 / 500;
        const double first = 10 - across, second = 10 + 0.25 * across;
        // Two codes of 65,536 over ten units.
        if (std::abs(first - second) < 2 * 10.0 / 65536 * 2) continue;
        ++compared;
        ASSERT_EQ(frame.color[4 * at] > 200, first < second) << engine->name() << " at " << x << ", " << y;
      }
    }
  }
  EXPECT_GT(compared, 100000);
}

TEST(Parallel, RefusesWhatItCannotDraw) {
  MeshOptions options = small(Projection::isometric);
  options.camera.position = Vec3{0, 0, 10};
  EXPECT_TRUE(
      names(input_error([&] { seen(axes(), options); }), "isometric projection has its own direction"));
  options = small(Projection::oblique);
  for (const double receding : {0.0, -1.0, 4.5, std::nan("")}) {
    options.camera.receding = receding;
    EXPECT_TRUE(names(input_error([&] { seen(axes(), options); }), "receding lines are")) << receding;
  }
}

}  // namespace
}  // namespace bitspan
