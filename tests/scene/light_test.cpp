// SPDX-License-Identifier: Apache-2.0
// Normals of meshes, and light by the front end and in streams.
#include "scene/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include "scene/mesh.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

constexpr const char* cube_obj =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

Vec3 face_normal(const Face& f) {
  return of_length_1(
      cross(f.corner[1].position - f.corner[0].position, f.corner[2].position - f.corner[0].position));
}
double apart(const Vec3& a, const Vec3& b) { return length(a - b); }

// A ball of latitudes and longitudes, from outside counterclockwise.
std::vector<Face> ball(int n) {
  std::vector<Face> out;
  const auto at = [n](int i, int j) {
    const double a = std::numbers::pi * i / n, b = 2 * std::numbers::pi * (j % (2 * n)) / (2 * n);
    // The poles are one point each.
    const double ring = i == 0 || i == n ? 0 : std::sin(a);
    return Vec3{ring * std::cos(b), i == 0 ? 1 : i == n ? -1 : std::cos(a), -ring * std::sin(b)};
  };
  const auto face = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    if (a == b || b == c || a == c) return;
    Face& f = out.emplace_back();
    f.corner[0].position = a;
    f.corner[1].position = b;
    f.corner[2].position = c;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      face(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      face(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return out;
}

TEST(Normals, ACubeKeepsItsEdges) {
  const TemporaryFolder folder;
  Mesh mesh = read_mesh(folder.write("cube.obj", cube_obj));
  ASSERT_EQ(mesh.faces.size(), 12U);
  give_normals(mesh.faces);
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) EXPECT_LT(apart(normal_of(corner), face_normal(face)), 1e-15);
  }
  // With a wide crease a corner has the mean of three sides.
  for (Face& face : mesh.faces) {
    for (Corner& corner : face.corner) set_normal(corner, {});
  }
  give_normals(mesh.faces, 100);
  for (const Face& face : mesh.faces) {
    for (const Corner& corner : face.corner) {
      // Sides of two triangles at the corner count twice their share of one.
      EXPECT_GT(dot(normal_of(corner), of_length_1(corner.position)), 0.9);
      EXPECT_NEAR(length(normal_of(corner)), 1, 1e-15);
    }
  }
}

TEST(Normals, ABallIsSmooth) {
  for (const int n : {8, 40}) {  // at 40 the poles are fans of more than 64 faces
    std::vector<Face> faces = ball(n);
    give_normals(faces);
    double worst = 0;
    for (const Face& face : faces) {
      ASSERT_GT(dot(face_normal(face), face.corner[0].position), 0);
      for (const Corner& corner : face.corner)
        worst = std::max(worst, apart(normal_of(corner), corner.position));
    }
    EXPECT_LT(worst, n == 8 ? 0.1 : 0.02);
  }
}

TEST(Normals, TheFilesComeFirst) {
  const TemporaryFolder folder;
  const auto normals = [&](const std::string& name, const std::string& text) {
    Mesh mesh = read_mesh(folder.write(name, text));
    give_normals(mesh.faces);
    return mesh.faces.at(0).corner;
  };
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto given = normals("a.obj", triangle + "vn 0 0 5\nvn 3 0 4\nvn 0 0 0\nf 1//1 2//2 3//3\n");
  EXPECT_EQ(normal_of(given[0]), (Vec3{0, 0, 1}));
  EXPECT_LT(apart(normal_of(given[1]), {0.6, 0, 0.8}), 1e-15);
  EXPECT_EQ(normal_of(given[2]), (Vec3{0, 0, 1})) << "of length 0: formed";
  // What is no normal leaves the file readable.
  for (const char* bad : {"vn", "vn x y z", "vn 1 2", "vn nan 0 0", "vn 1e999 0 0"}) {
    const auto formed = normals("b.obj", triangle + bad + "\nf 1//1 2//1 3//1\n");
    EXPECT_EQ(normal_of(formed[1]), (Vec3{0, 0, 1})) << bad;
  }
  const auto ply = normals("c.ply",
                           "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                           "0 0 0 0 3 4\n1 0 0 0 0 -2\n0 1 0 0 0 0\n3 0 1 2\n");
  EXPECT_LT(apart(normal_of(ply[0]), {0, 0.6, 0.8}), 1e-15);
  EXPECT_EQ(normal_of(ply[1]), (Vec3{0, 0, -1}));
  EXPECT_EQ(normal_of(ply[2]), (Vec3{0, 0, 1}));
}

TEST(Normals, TurnToTheViewer) {
  std::vector<Face> faces(2);
  for (Face& face : faces) {
    face.corner[0].position = {0, 0, 0};
    face.corner[1].position = {1, 0, 0};
    face.corner[2].position = {0, 1, 0};
    for (Corner& corner : face.corner) set_normal(corner, {0, 0, 1});
  }
  faces[1].two_sided = true;
  Viewpoint view;
  const auto nz = [&](std::size_t i) { return faces[i].corner[0].nz; };
  view.position = {0, 0, 3};
  turn_to_viewer(faces, view, true);
  EXPECT_EQ(nz(0), 1);
  EXPECT_EQ(nz(1), 1);
  view.position = {0, 0, -3};
  turn_to_viewer(faces, view, false);
  EXPECT_EQ(nz(0), 1);
  EXPECT_EQ(nz(1), -1);
  turn_to_viewer({faces.data(), 1}, view, true);
  EXPECT_EQ(nz(0), -1);
}

// ---------------------------------------------------------------- meshes

Scene seen(const std::string& path, const MeshOptions& options) {
  ProjectReport report;
  return mesh_scene(read_mesh(path), options, report);
}

TEST(MeshLight, AMeshWithoutATextureIsLit) {
  const TemporaryFolder folder;
  const std::string path = folder.write("cube.obj", cube_obj);
  MeshOptions options;
  const Scene lit = seen(path, options);
  options.unlit = true;
  const Scene unlit = seen(path, options);
  ASSERT_EQ(lit.triangles.size(), unlit.triangles.size());
  std::set<double> shades;
  for (std::size_t i = 0; i < lit.triangles.size(); ++i) {
    for (const Vertex& v : unlit.triangles[i].v) EXPECT_EQ(v.c, (std::array<double, 4>{1, 1, 1, 1}));
    for (const Vertex& v : lit.triangles[i].v) {
      EXPECT_GE(v.c[0], 0.25);
      EXPECT_LE(v.c[0], 1);
      EXPECT_EQ(v.c[3], 1);
      EXPECT_EQ(v.nx, 0);  // the front end has done it
      shades.insert(v.c[0]);
    }
  }
  EXPECT_EQ(shades.size(), 3U) << "three sides are seen";
  EXPECT_FALSE(lit.light);
}

TEST(MeshLight, TheUnitHasTheLightInTheViewersSpace) {
  const TemporaryFolder folder;
  const std::string path = folder.write("cube.obj", cube_obj);
  MeshOptions options;
  options.camera.position = Vec3{0, 0, 10};
  options.light = LightOptions{
      .light = {.place = {3, 5, 10}, .ambient = 0.125, .specular = 0.5, .exponent = 7}, .by_unit = true};
  const Scene far = seen(path, options);
  ASSERT_TRUE(far.light);
  EXPECT_EQ(*far.light, (Light{.place = {3, -5, -10}, .ambient = 0.125, .specular = 0.5, .exponent = 7}));
  options.light->light.is_point = true;
  const Scene near = seen(path, options);
  EXPECT_EQ(near.light->place, (std::array<double, 3>{3, -5, 0}));
  EXPECT_TRUE(near.light->is_point);
  for (const Triangle& t : near.triangles) {
    for (const Vertex& v : t.v) {
      EXPECT_EQ(v.c[0], 1);
      EXPECT_NEAR(v.nz, -1, 1e-15) << "only the side toward the viewer is seen";
    }
  }
  // By the front end the same light is in the colours: one side, straight from the viewer.
  options.light = LightOptions{.light = {.place = {0, 0, 10}, .ambient = 0.125}};
  for (const Triangle& t : seen(path, options).triangles) {
    for (const Vertex& v : t.v) EXPECT_NEAR(v.c[1], 1, 1e-12);
  }
  options.light->light.place = {10, 0, 10};
  for (const Triangle& t : seen(path, options).triangles) {
    for (const Vertex& v : t.v) EXPECT_NEAR(v.c[1], 0.125 + 0.875 * std::sqrt(0.5), 1e-12);
  }
  options.light->light.lunar = 3;
  for (const Triangle& t : seen(path, options).triangles) {
    for (const Vertex& v : t.v) EXPECT_NEAR(v.c[1], 0.125 + 0.875 * std::sqrt(0.5) / 4, 1e-12);
  }
  options.light->light.reach = 1;
  EXPECT_TRUE(names(input_error([&] { seen(path, options); }), "light.reach: "));
  options.light->light.reach = 0;
  options.light->light.place = {0, 0, 0};
  EXPECT_TRUE(names(input_error([&] { seen(path, options); }), "light: stands at what the viewer looks at"));
  options.light->light.ambient = 2;
  EXPECT_TRUE(names(input_error([&] { seen(path, options); }), "light.ambient: is not legal"));
}

// ---------------------------------------------------------------- streams

const std::string header =
    R"({"bitspan": 2, "width": 8, "height": 8, "s_min": 1, "s_max": 9, "focal": 5, "background": [0,0,0])";
const std::string corners = R"({"v": [[0,0,1,0,0],[8,0,2,0,0],[0,8,3,0,0]])";

TEST(LightStream, ComesBack) {
  const std::string text =
      header +
      R"(, "light": {"position": [1, -2.5, 3e-7], "ambient": 0.1, "specular": 0.3, "exponent": 9,)"
      R"( "lunar": 0.7, "reach": 4.5, "offset": 0.1}})"
      "\n" +
      corners +
      R"(, "nx": [0,0.25,1], "nz": [-1,-1,0]})"
      "\n" +
      R"({"view": {"light": {"direction": [0, 1e300, 0]}}})"
      "\n" +
      corners + "}\n" +
      R"({"view": {"light": null}})"
      "\n" +
      corners + "}\n";
  const Scene scene = parse_tri(text, "x.tri");
  EXPECT_EQ(scene.light, (Light{.is_point = true,
                                .place = {1, -2.5, 3e-7},
                                .ambient = 0.1,
                                .specular = 0.3,
                                .exponent = 9,
                                .lunar = 0.7,
                                .reach = 4.5,
                                .offset = 0.1}));
  EXPECT_EQ(scene.triangles[0].v[1].nx, 0.25);
  EXPECT_EQ(scene.triangles[0].v[1].ny, 0);
  EXPECT_EQ(scene.triangles[0].v[2].nz, 0);
  ASSERT_EQ(scene.commands.size(), 2U);
  EXPECT_EQ(std::get<ViewChange>(scene.commands[0].what).light, (Light{.place = {0, 1e300, 0}}));
  ASSERT_TRUE(std::get<ViewChange>(scene.commands[1].what).light);
  EXPECT_FALSE(*std::get<ViewChange>(scene.commands[1].what).light);
  for (const bool binary : {false, true}) {
    std::ostringstream out;
    binary ? write_trib(out, scene) : write_tri(out, scene);
    const Scene again = parse_tri(out.str(), binary ? "x.trib" : "x.tri");
    EXPECT_EQ(again.light, scene.light);
    EXPECT_EQ(again.triangles[0].v[1].nx, 0.25);
    EXPECT_EQ(again.triangles[0].v[1].nz, -1);
    EXPECT_EQ(std::get<ViewChange>(again.commands[0].what), std::get<ViewChange>(scene.commands[0].what));
    EXPECT_EQ(std::get<ViewChange>(again.commands[1].what), std::get<ViewChange>(scene.commands[1].what));
  }
}

TEST(LightStream, RefusesWhatIsNoLight) {
  const std::pair<const char*, const char*> cases[] = {
      {"3", "light: 3 is not an object; expected {\"direction\": [x,y,z]} or {\"position\": [x,y,z]}"},
      {"{}", "light: has neither key; expected"},
      {R"({"direction": [0,0,1], "position": [0,0,1]})", "light: has both keys; expected"},
      {R"({"direction": [0,0]})", "light.direction: has 2 elements; expected [x, y, z]"},
      {R"({"direction": [0,0,0]})",
       "light.direction: is not legal; expected three finite numbers, not all 0"},
      {R"({"position": [0,0,"a"]})", "light.position: \"a\" is not a number"},
      {R"({"position": [0,0,1], "ambient": 1.5})",
       "light.ambient: is not legal; expected a number from 0 to 1"},
      {R"({"position": [0,0,1], "ambient": 0.5, "specular": 0.75})", "light.specular: is not legal"},
      {R"({"position": [0,0,1], "exponent": 201})", "light.exponent: 201"},
      {R"({"position": [0,0,1], "exponent": 1.5})", "light.exponent: 1.5"},
      {R"({"position": [0,0,1], "lunar": -0.5})",
       "light.lunar: is not legal; expected a number from 0 to 16"},
      {R"({"position": [0,0,1], "reach": 1, "offset": 65})",
       "light.offset: is not legal; expected a number from 0 to 64"},
      {R"({"position": [0,0,1], "reach": -1})", "light.reach: is not legal; expected a number above 0"},
      {R"({"position": [0,0,1], "reach": 1e-6})", "light.reach: 1e-06 is not legal; expected s_max 2^-16"},
      {R"({"position": [0,0,1], "color": 1})", "light.\"color\": unknown key"}};
  for (const auto& [light, message] : cases) {
    const std::string text = header + ", \"light\": " + light + "}\n";
    const std::string error = input_error([&] { parse_tri(text, "x.tri"); });
    EXPECT_TRUE(names(error, message)) << error;
  }
  std::string first = header;
  first[first.find('2')] = '1';
  EXPECT_TRUE(names(input_error([&] { parse_tri(first + R"(, "light": {"direction": [0,0,1]}})", "x.tri"); }),
                    "light: is not legal in version 1"));
}

}  // namespace
}  // namespace bitspan
