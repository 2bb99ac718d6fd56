// SPDX-License-Identifier: Apache-2.0
// Quadrics of a scene: bodies as triangles, scenes of bodies, and the header of a stream. [V2]
#include "scene/generate/quadric.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <utility>

#include "config/config.hpp"
#include "scene/draw_state.hpp"
#include "scene/mesh.hpp"
#include "scene/project.hpp"
#include "scene/quadric_form.hpp"
#include "scene/shadow.hpp"
#include "scene/tri_stream.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

using Place = std::array<double, 3>;
Place place_of(const Vec3& p) { return {p.x, p.y, p.z}; }

// One body of every shape, cut and whole, upright and leaning.
std::vector<QuadricBody> bodies(bool caps) {
  std::vector<QuadricBody> out;
  const auto add = [&](QuadricShape shape, std::array<double, 3> radii, std::optional<double> from,
                       std::optional<double> to) {
    for (const Vec3& axis : {Vec3{0, 1, 0}, Vec3{1, 2, -3}}) {
      out.push_back({.shape = shape,
                     .radii = radii,
                     .from = from,
                     .to = to,
                     .caps = caps,
                     .centre = {3, -2, 5},
                     .axis = axis,
                     .steps = 12});
    }
  };
  add(QuadricShape::sphere, {2, 2, 2}, {}, {});
  add(QuadricShape::sphere, {2, 2, 2}, -1, 1.5);
  add(QuadricShape::ellipsoid, {1, 2, 3}, {}, 1);
  add(QuadricShape::cylinder, {1, 1, 2}, -1, 3);
  add(QuadricShape::cone, {1, 2, 1}, -2, 0);
  add(QuadricShape::cone, {1, 2, 2}, -1, 2);
  add(QuadricShape::cone, {1, 2, 2}, 1, 2);
  add(QuadricShape::paraboloid, {1, 2, 2}, {}, 2);
  add(QuadricShape::hyperboloid, {1, 2, 2}, -2, 3);
  add(QuadricShape::hyperboloid_two, {1, 1, 2}, -2, 3);
  add(QuadricShape::hyperboloid_two, {1, 1, 2}, 0, 3);
  return out;
}

// Whether a triangle is a flat face across the axis at one of the cuts.
bool is_cap(const MeshTriangle& t, const QuadricBody& body) {
  const Vec3 axis = of_length_1(body.axis);
  for (const MeshCorner& c : t.corner) {
    const double height = dot(axis, c.position - body.centre);
    const bool at_cut = (body.from && std::fabs(height - *body.from) < 1e-9) ||
                        (body.to && std::fabs(height - *body.to) < 1e-9);
    if (!at_cut || std::fabs(std::fabs(dot(axis, c.normal)) - 1) > 1e-9) return false;
  }
  return true;
}

TEST(QuadricMesh, VerticesLieOnTheBodyAndTrianglesInItsShell) {
  for (const QuadricBody& body : bodies(true)) {
    SCOPED_TRACE(std::string(to_string(body.shape)));
    const QuadricMesh mesh = tessellated(body);
    ASSERT_EQ(mesh.quadric.count, mesh.triangles.size());
    EXPECT_LE(mesh.triangles.size(), most_triangles(body));
    std::size_t walls = 0;
    double deepest = 0;
    for (const MeshTriangle& t : mesh.triangles) {
      const Vec3 a = t.corner[0].position - body.centre;
      const Vec3 b = t.corner[1].position - body.centre;
      const Vec3 c = t.corner[2].position - body.centre;
      const Vec3 outward = cross(b - a, c - a);
      if (is_cap(t, body)) {
        EXPECT_GT(dot(outward, t.corner[0].normal), 0);
        EXPECT_LT(value_at(mesh.quadric, (a + b + c) * (1.0 / 3)), 0);
        continue;
      }
      ++walls;
      for (const Vec3& p : {a, b, c}) EXPECT_NEAR(value_at(mesh.quadric, p), 0, 1e-12);
      EXPECT_GT(dot(outward, gradient_at(mesh.quadric, (a + b + c) * (1.0 / 3))), 0);
      for (int i = 0; i <= 8; ++i) {
        for (int j = 0; i + j <= 8; ++j) {
          const Vec3 p = a * (i / 8.0) + b * (j / 8.0) + c * ((8 - i - j) / 8.0);
          const double f = value_at(mesh.quadric, p);
          EXPECT_LE(f, mesh.quadric.high);
          EXPECT_GE(f, mesh.quadric.low);
          deepest = std::min(deepest, f);
        }
      }
    }
    EXPECT_GE(walls, 12U);
    EXPECT_LT(deepest, 0.4 * mesh.quadric.low);  // the shell is no wider than it must be, by much
  }
}

// Each side of a closed body belongs to two triangles, which walk it both ways. An open one has a rim.
TEST(QuadricMesh, AClosedBodyHasNoCrack) {
  for (const bool caps : {true, false}) {
    for (const QuadricBody& body : bodies(caps)) {
      SCOPED_TRACE(std::string(to_string(body.shape)));
      const QuadricMesh mesh = tessellated(body);
      std::map<std::pair<Place, Place>, int> sides;
      double volume = 0;
      for (const MeshTriangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
          ++sides[{place_of(t.corner[i].position), place_of(t.corner[(i + 1) % 3].position)}];
        }
        volume += dot(t.corner[0].position - body.centre,
                      cross(t.corner[1].position - body.centre, t.corner[2].position - body.centre)) /
                  6;
      }
      std::size_t alone = 0;
      for (const auto& [ends, count] : sides) {
        EXPECT_EQ(count, 1);
        alone += sides.contains({ends.second, ends.first}) ? 0 : 1;
      }
      EXPECT_EQ(mesh.quadric.two_sided, alone > 0);
      if (caps) {
        EXPECT_EQ(alone, 0U);
      } else if (body.shape == QuadricShape::ellipsoid) {
        EXPECT_EQ(alone, 12U);
      }
      if (body.shape == QuadricShape::sphere && !body.from) {
        const double whole = 4.0 / 3 * std::numbers::pi * 8;
        EXPECT_LT(volume, whole);
        EXPECT_GT(volume, 0.88 * whole);
      }
    }
  }
}

TEST(QuadricMesh, CornersHaveTheBodysNormals) {
  for (const QuadricBody& body : bodies(false)) {
    const QuadricMesh mesh = tessellated(body);
    for (const MeshTriangle& t : mesh.triangles) {
      for (const MeshCorner& c : t.corner) {
        const Vec3 gradient = of_length_1(gradient_at(mesh.quadric, c.position - body.centre));
        EXPECT_NEAR(length(c.normal), 1, 1e-12);
        if (body.shape == QuadricShape::cone && length(c.position - body.centre) < 1e-12) continue;
        EXPECT_GT(dot(c.normal, gradient), 1 - 1e-9);
      }
    }
  }
}

TEST(QuadricMesh, RefusesWhatIsNoBody) {
  const auto fault = [](QuadricBody body) { return body_fault(body); };
  EXPECT_EQ(fault({}), "");
  EXPECT_NE(fault({.radii = {1, 2, 1}}).find("radii: a sphere has one radius"), std::string::npos);
  EXPECT_NE(fault({.radii = {0, 0, 0}}).find("radii: 0 is not legal"), std::string::npos);
  EXPECT_NE(fault({.shape = QuadricShape::cylinder}).find("goes on without end"), std::string::npos);
  EXPECT_NE(fault({.shape = QuadricShape::paraboloid, .from = 1}).find("goes on without end"),
            std::string::npos);
  EXPECT_NE(fault({.from = 1, .to = 1}).find("from: 1 is not below"), std::string::npos);
  EXPECT_NE(fault({.from = 2, .to = 3}).find("nothing of the body"), std::string::npos);
  EXPECT_NE(
      fault({.shape = QuadricShape::hyperboloid_two, .from = -0.5, .to = 0.5}).find("nothing of the body"),
      std::string::npos);
  EXPECT_NE(fault({.axis = {0, 0, 0}}).find("axis:"), std::string::npos);
  EXPECT_NE(fault({.steps = 2}).find("steps: 2"), std::string::npos);
  EXPECT_NE(fault({.rows = 0}).find("rows: 0"), std::string::npos);
  EXPECT_THROW(tessellated({.steps = 2}), InputError);
}

// f is the same number in the viewer's space, far from 0 as well.
TEST(Quadric, IsTheSameInTheViewersSpace) {
  for (QuadricBody body : bodies(true)) {
    body.centre = {3e6, -2e6, 5e6};
    const QuadricMesh mesh = tessellated(body);
    Viewpoint view;
    look_at(view, body.centre + Vec3{5, 3, -7}, body.centre + Vec3{0.5, 0.25, 0}, {0, 1, 0});
    const Quadric seen = seen_by(mesh.quadric, view);
    for (const Vec3& p : {Vec3{1, 0, 0}, Vec3{0.5, -2, 1}, Vec3{0, 3, 4}, Vec3{0, 0, 0}}) {
      EXPECT_NEAR(value_at(seen, in_view(body.centre + p, view)), value_at(mesh.quadric, p), 1e-7);
      if (!seen.clip) continue;
      const Vec3 q = in_view(body.centre + p, view);
      const LinearForm& g = seen.clip->axis;
      EXPECT_NEAR(g[0] * q.x + g[1] * q.y + g[2] * q.z + g[3], dot(of_length_1(body.axis), p), 1e-7);
    }
  }
}

constexpr const char* two_bodies = R"(steps = 8
[[body]]
shape = "sphere"
radius = 1
centre = [0, 1, 0]
color = [1, 0.5, 0]
[[body]]
shape = "cone"
radii = [1, 2, 1]
from = -2
to = 0
caps = false
centre = [3, 2, 0]
[[mesh]]
file = "one.obj"
at = [0, 0, 5]
scale = 2
)";

class QuadFile : public testing::Test {
 protected:
  QuadFile() { folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); }
  Mesh read(const std::string& text) const { return read_mesh(folder.write("a.quad", text)); }
  std::string refused(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(what.find("a.quad"));
    }
    return "is read";
  }
  TemporaryFolder folder;
};

TEST_F(QuadFile, HasBodiesAndMeshes) {
  const Mesh mesh = read(two_bodies);
  ASSERT_EQ(mesh.quadrics.size(), 2U);
  EXPECT_EQ(mesh.quadrics[0].first, 0U);
  EXPECT_EQ(mesh.quadrics[0].count, 8U * 2 + 8 * 2 * 2);
  EXPECT_EQ(mesh.quadrics[1].first, mesh.quadrics[0].count);
  EXPECT_EQ(mesh.quadrics[1].count, 8U);
  EXPECT_FALSE(mesh.quadrics[0].two_sided);
  EXPECT_TRUE(mesh.quadrics[1].two_sided);
  ASSERT_EQ(mesh.faces.size(), mesh.quadrics[0].count + 8 + 1);
  EXPECT_EQ(mesh.faces[0].corner[0].c[1], 0.5);
  EXPECT_FALSE(mesh.faces[0].two_sided);
  EXPECT_TRUE(mesh.faces[mesh.quadrics[1].first].two_sided);
  const Face& last = mesh.faces.back();
  EXPECT_EQ(last.corner[1].position, (Vec3{2, 0, 5}));
  EXPECT_EQ(last.corner[2].position, (Vec3{0, 2, 5}));
}

TEST_F(QuadFile, RefusesWhatIsNotLegal) {
  const std::string good = two_bodies;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::pair<std::string, const char*> cases[] = {
      {"", "a.quad:1: the scene is empty"},
      {"steps = 8\n", "a.quad:1: body: missing"},
      {with("steps = 8", "steps = 2"), "a.quad:1: steps: is 2; legal: an integer, 3..4096"},
      {with("\"sphere\"", "\"ball\""), "a.quad:3: body[1].shape: \"ball\" is no value"},
      {with("radius = 1\n", ""), "a.quad:2: body[1].radius: missing"},
      {with("radius = 1\n", "radius = 1\nradii = [1, 1, 1]\n"), "a.quad:2: body[1].radius: stands beside"},
      {with("radius = 1\n", "radius = -1\n"), "a.quad:2: body[1].radii: -1 is not legal"},
      {with("[0, 1, 0]", "[0, 1]"), "a.quad:5: body[1].centre: has 2 entries"},
      {with("[0, 1, 0]", "[0, \"x\", 0]"), "a.quad:5: body[1].centre: has something else"},
      {with("[1, 0.5, 0]", "[1, 1.5, 0]"), "a.quad:2: body[1].color: 1.5 is not legal"},
      {with("to = 0\n", ""), "a.quad:7: body[2].from, to: a cone goes on"},
      {with("steps = 8", "step = 8"), "a.quad:1: step: unknown key"},
      {with("scale = 2", "scale = 0"), "a.quad:17: mesh[1].scale: is not legal"},
      {with("one.obj", "a.quad"), "a.quad:15: mesh[1].file: is a scene of quadrics"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_EQ(refused(text).substr(0, std::string(expected).size()), expected);
  }
  EXPECT_THROW(read(with("one.obj", "none.obj")), InputError);
}

Scene scene_of(const Mesh& mesh, std::optional<ShadowOptions> shadow = {}) {
  MeshOptions options;
  options.width = 64;
  options.height = 48;
  options.shadow = shadow;
  ProjectReport report;
  return mesh_scene(mesh, options, report);
}

// The triangles of each range lie in the shell of their quadric, as the viewer sees it.
void expect_shells(const Scene& scene) {
  for (const Quadric& q : scene.quadrics) {
    for (std::size_t i = 0; i < q.count; ++i) {
      Vec3 middle;
      for (const Vertex& v : scene.triangles.at(q.first + i).v) middle = middle + position_of(v, scene);
      const double f = value_at(q, middle * (1.0 / 3));
      EXPECT_GE(f, q.low - 1e-9);
      EXPECT_LE(f, q.high + 1e-9);
    }
  }
}

TEST_F(QuadFile, AScenesRangesAreThoseOfItsBodies) {
  const Mesh mesh = read(two_bodies);
  const Scene scene = scene_of(mesh);
  ASSERT_EQ(scene.quadrics.size(), 2U);
  EXPECT_LT(scene.quadrics[0].count, mesh.quadrics[0].count);  // back faces are left out
  EXPECT_EQ(scene.quadrics[1].count, 8U);
  EXPECT_EQ(ranges_fault(scene.quadrics, scene.triangles.size()), "");
  expect_shells(scene);
  // Behind the triangles of a shadow map they are the same ones.
  const Scene shadowed = scene_of(mesh, ShadowOptions{.light = {4, 9, 6}});
  ASSERT_EQ(shadowed.quadrics.size(), 2U);
  EXPECT_GT(shadowed.quadrics[0].first, 0U);
  EXPECT_EQ(shadowed.quadrics[0].count, scene.quadrics[0].count);
  expect_shells(shadowed);
}

TEST_F(QuadFile, ErasedTrianglesLeaveTheRanges) {
  Scene scene = scene_of(read(two_bodies));
  const Quadric first = scene.quadrics[0];
  const std::size_t all = scene.triangles.size();
  erase_triangles(scene, first.count - 2, 5);
  ASSERT_EQ(scene.quadrics.size(), 2U);
  EXPECT_EQ(scene.quadrics[0].count, first.count - 2);
  EXPECT_EQ(scene.quadrics[1].first, first.count - 2);
  EXPECT_EQ(scene.quadrics[1].count, 5U);
  EXPECT_EQ(ranges_fault(scene.quadrics, all - 5), "");
  expect_shells(scene);
  erase_triangles(scene, 0, first.count - 2);
  ASSERT_EQ(scene.quadrics.size(), 1U);
  EXPECT_EQ(scene.quadrics[0].first, 0U);
}

TEST_F(QuadFile, AStreamKeepsThem) {
  const Scene scene = scene_of(read(two_bodies));
  std::ostringstream text;
  std::ostringstream bytes;
  write_tri(text, scene);
  write_trib(bytes, scene);
  EXPECT_EQ(text.str().substr(0, 12), "{\"bitspan\":2");
  EXPECT_EQ(parse_tri(text.str(), "a.tri").quadrics, scene.quadrics);
  EXPECT_EQ(parse_tri(bytes.str(), "a.trib").quadrics, scene.quadrics);
}

TEST(QuadricsOfAStream, AreCheckedWhole) {
  const std::string q = R"({"triangles": [0, 0], "matrix": [1,0,0,0,1,0,-8,1,-4,19], "within": [-1, 0]})";
  const auto stream = [](const std::string& quadrics, int version = 2) {
    return "{\"bitspan\": " + std::to_string(version) +
           ", \"width\": 64, \"height\": 48, \"s_min\": 1, \"s_max\": 9, \"focal\": 50, \"background\": "
           "[0,0,0], "
           "\"quadrics\": " +
           quadrics + "}\n{\"v\": [[4,4,2,0,0],[60,4,2,0,0],[4,40,2,0,0]]}\n";
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = q;
    return "[" + text.replace(text.find(from), from.size(), to) + "]";
  };
  const Scene scene = parse_tri(stream("[" + q + "]"), "a.tri");
  ASSERT_EQ(scene.quadrics.size(), 1U);
  EXPECT_EQ(scene.quadrics[0].count, 1U);
  EXPECT_EQ(scene.quadrics[0].matrix[6], -8);
  EXPECT_EQ(scene.quadrics[0].low, -1);
  EXPECT_FALSE(scene.quadrics[0].two_sided);
  const std::string clip = R"("clip": {"axis": [0,1,0,0], "from": -1, "to": 2, "caps": [true, false]})";
  const Scene cut =
      parse_tri(stream(with("\"within\"", clip + ", \"two_sided\": true, \"within\"")), "a.tri");
  ASSERT_TRUE(cut.quadrics.at(0).clip);
  EXPECT_EQ(cut.quadrics[0].clip->to, 2);
  EXPECT_TRUE(cut.quadrics[0].clip->cap_from);
  EXPECT_FALSE(cut.quadrics[0].clip->cap_to);
  EXPECT_TRUE(cut.quadrics[0].two_sided);
  const std::pair<std::string, const char*> cases[] = {
      {stream("[" + q + "]", 1), "a.tri:1: quadrics: is not legal in version 1"},
      {stream("7"), "a.tri:1: quadrics: 7 is not legal"},
      {stream("[7]"), "a.tri:1: quadrics[0]: 7 is not an object"},
      {stream(with("[0, 0]", "[0, 1]")), "a.tri:1: quadrics[0].triangles: [0, 1] is not legal"},
      {stream(with("[0, 0]", "[1, 0]")), "a.tri:1: quadrics[0].triangles: "},
      {stream(with("[0, 0]", "[0.5, 1]")), "a.tri:1: quadrics[0].triangles: "},
      {stream("[" + q + "," + q + "]"), "a.tri:1: quadrics[1].triangles: [0, 0] is not legal"},
      {stream(with("[1,0,0,0,1,0,-8,1,-4,19]", "[1,2]")), "a.tri:1: quadrics[0].matrix: has 2 elements"},
      {stream(with("[1,0,0,0,1,0,-8,1,-4,19]", "[0,0,0,0,0,0,0,0,0,19]")),
       "a.tri:1: quadrics[0].matrix: is constant"},
      {stream(with("[-1, 0]", "[1, 2]")), "a.tri:1: quadrics[0].within: [1, 2] is not legal"},
      {stream(with("\"within\"", "\"with\"")), "a.tri:1: quadrics[0].\"with\": unknown key"},
      {stream(with("\"within\"", "\"clip\": 3, \"within\"")),
       "a.tri:1: quadrics[0].clip: 3 is not an object"},
      {stream(with("\"within\"", R"("clip": {"axis": [0,1,0,0], "from": 3, "to": 2}, "within")")),
       "a.tri:1: quadrics[0].clip.from: 3 is not below"},
      {stream(with("\"within\"", R"("clip": {"axis": [0,1,0,0], "from": 3}, "within")")),
       "a.tri:1: quadrics[0].clip.to: key is missing"},
  };
  for (const auto& [text, expected] : cases) {
    try {
      parse_tri(text, "a.tri");
      ADD_FAILURE() << "is read: " << expected;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, std::string(expected).size()), expected);
    }
  }
}

}  // namespace
}  // namespace bitspan
