// SPDX-License-Identifier: Apache-2.0
// Rays against quadrics: against exact numbers, against the engines, and planted faults that turn them red.
// [V2]
#include "golden/quadric.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "report/quadrics.hpp"
#include "scene/generate/quadric.hpp"
#include "scene/light.hpp"
#include "scene/mesh.hpp"
#include "scene/quadric_form.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using golden::Interval;
using golden::QuadricRay;
using Rational = boost::multiprecision::cpp_rational;
using Long = boost::multiprecision::cpp_bin_float_100;
using test::drawn_by;
using test::oracle_named;

// a t^2 + 2 b t + c along a ray, exactly.
struct ExactAlong {
  Rational a, b, c;
  Rational discriminant() const { return b * b - a * c; }
};
ExactAlong exactly_along(const Quadric& q, const QuadricRay& ray) {
  std::array<std::array<Rational, 4>, 4> m;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) m[i][j] = m[j][i] = Rational(q.matrix[at++]);
  }
  const std::array<Rational, 3> d{Rational(ray.x), Rational(ray.y), Rational(ray.z)};
  ExactAlong out{0, 0, m[3][3]};
  for (std::size_t i = 0; i < 3; ++i) {
    out.b += d[i] * m[i][3];
    for (std::size_t j = 0; j < 3; ++j) out.a += d[i] * m[i][j] * d[j];
  }
  return out;
}

int sign(const Rational& x) { return x < 0 ? -1 : x > 0 ? 1 : 0; }

Quadric sphere_at(const Vec3& c, double r) {
  Quadric q;
  q.matrix = {1, 0, 0, -c.x, 1, 0, -c.y, 1, -c.z, dot(c, c) - r * r};
  return q;
}

Quadric random_quadric(Random& draw) {
  Quadric q;
  for (double& x : q.matrix) x = draw.uniform(-2, 2);
  return q;
}
QuadricRay random_ray(Random& draw) {
  return {static_cast<double>(draw.integer(-639, 639)), static_cast<double>(draw.integer(-479, 479)),
          draw.uniform(200, 2000)};
}

TEST(QuadricRays, GoThroughCentresOfPixels) {
  View view;
  view.width = 64;
  view.height = 48;
  view.focal = 50;
  const QuadricRay ray = golden::ray_through(view, 40, 10);
  // The centre is at (40.5, 10.5), so 8.5 and -13.5 pixels from the middle.
  EXPECT_EQ(ray.x / ray.z, 8.5 / 50);
  EXPECT_EQ(ray.y / ray.z, -13.5 / 50);
}

TEST(QuadricRays, DiscriminantHasTheExactSign) {
  Random draw(51);
  const int rounds = is_long_run() ? 1000000 : 4000;
  std::array<int, 3> found{};
  for (int round = 0; round < rounds; ++round) {
    const Quadric q = random_quadric(draw);
    const QuadricRay ray = random_ray(draw);
    const int expected = sign(exactly_along(q, ray).discriminant());
    ASSERT_EQ(golden::discriminant_sign(q, ray), expected) << "round " << round;
    ++found[static_cast<std::size_t>(expected + 1)];
  }
  EXPECT_GT(found[0], rounds / 10);
  EXPECT_GT(found[2], rounds / 10);
}

// Spheres that a ray just touches, and those whose radius is a last bit smaller or larger.
TEST(QuadricRays, ATangentIsToldFromItsNeighbours) {
  Random draw(52);
  std::array<int, 3> found{};
  for (int round = 0; round < 600; ++round) {
    // Along z, at the distance 5 k of a centre at (3 k, 4 k, .).
    const double k = static_cast<double>(draw.integer(1, 1000)) / 64;
    Quadric q = sphere_at({3 * k, 4 * k, static_cast<double>(draw.integer(1, 5000))}, 5 * k);
    const QuadricRay ray{0, 0, static_cast<double>(draw.integer(1, 4000))};
    const double last = q.matrix[9];
    for (const double c : {last, std::nextafter(last, -HUGE_VAL), std::nextafter(last, HUGE_VAL)}) {
      q.matrix[9] = c;
      const int expected = sign(exactly_along(q, ray).discriminant());
      ASSERT_EQ(golden::discriminant_sign(q, ray), expected) << "round " << round;
      ++found[static_cast<std::size_t>(expected + 1)];
    }
  }
  EXPECT_EQ(found[0], 600);
  EXPECT_EQ(found[1], 600);
  EXPECT_EQ(found[2], 600);
}

// Half of all rays that stay outside are told at once, and none that does not.
TEST(QuadricRays, AreToldToStayOutside) {
  Random draw(55);
  int above = 0;
  int told = 0;
  for (int round = 0; round < 3000; ++round) {
    Quadric q = sphere_at({draw.uniform(-3, 3), draw.uniform(-3, 3), draw.uniform(5, 9)}, 1);
    q.matrix[0] = draw.uniform(-0.2, 2);
    const QuadricRay ray = random_ray(draw);
    const double level = draw.uniform(0, 2);
    Quadric lowered = q;
    lowered.matrix[9] -= level;
    const ExactAlong f = exactly_along(lowered, ray);
    const bool is_above = f.a > 0 && f.discriminant() < 0;
    if (golden::is_always_above(q, ray, level)) {
      ASSERT_TRUE(is_above) << "round " << round;
      ++told;
    }
    above += is_above ? 1 : 0;
  }
  EXPECT_GT(told, 500);
  EXPECT_GT(told, above / 2);
}

TEST(QuadricRays, RootsAreEnclosed) {
  Random draw(53);
  const int rounds = is_long_run() ? 200000 : 3000;
  int roots = 0;
  int sharp = 0;
  for (int round = 0; round < rounds; ++round) {
    // Every third is nearly touched.
    Quadric q = random_quadric(draw);
    const QuadricRay ray = round % 3 == 0 ? QuadricRay{0, 0, 1} : random_ray(draw);
    if (round % 3 == 0) {
      q = sphere_at({3, 4, draw.uniform(10, 90)}, 5);
      q.matrix[9] -= draw.log_uniform(1e-14, 1);
    }
    const Interval window{1 / ray.z, 100 / ray.z};
    const ExactAlong f = exactly_along(q, ray);
    std::vector<Long> expected;
    if (f.discriminant() >= 0 && f.a != 0) {
      const Long root = sqrt(Long(f.discriminant()));
      for (const int side : {-1, 1}) {
        const Long t = (-Long(f.b) + side * root) / Long(f.a);
        if (t > window.low && t < window.high) expected.push_back(t);
      }
      if (expected.size() == 2 && expected[0] > expected[1]) std::swap(expected[0], expected[1]);
    }
    const auto found = golden::roots_of(q, ray, window);
    ASSERT_EQ(found.size(), expected.size()) << "round " << round;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_LE(found[i].t.low, expected[i]) << "round " << round;
      EXPECT_GE(found[i].t.high, expected[i]) << "round " << round;
      const Long slope = 2 * (Long(f.a) * expected[i] + Long(f.b));
      EXPECT_TRUE(slope == 0 || found[i].enters == (slope < 0)) << "round " << round;
      sharp += found[i].t.high - found[i].t.low < 1e-9 * found[i].t.low ? 1 : 0;
      ++roots;
    }
  }
  EXPECT_GT(roots, rounds / 2);
  EXPECT_GT(sharp, 6 * roots / 10);  // near a tangent an error moves them far
}

// Along a ray, samples that are in the shell are in a crossing, and what is certain goes through all of it.
TEST(QuadricRays, CrossingsHoldAllOfTheShell) {
  Random draw(54);
  int certain = 0;
  int samples = 0;
  for (int round = 0; round < 3000; ++round) {
    golden::QuadricShell shell;
    shell.quadric = random_quadric(draw);
    shell.quadric.two_sided = round % 2 == 0;
    shell.low = -draw.log_uniform(1e-3, 4);
    shell.high = draw.log_uniform(1e-3, 4);
    if (round % 4 < 2) {
      shell.quadric.clip = QuadricClip{{draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1), 0},
                                       draw.uniform(-9, 0),
                                       draw.uniform(0.1, 9)};
      shell.reach = 0.01;
    }
    const QuadricRay ray{draw.uniform(-1, 1), draw.uniform(-1, 1), 1};
    const Interval window{0.5, 20};
    const auto crossings = golden::crossings_of(shell, ray, window);
    const auto f_at = [&](double t) { return golden::along(shell.quadric, ray).at(t).value; };
    const auto height_at = [&](double t) {
      const LinearForm& g = shell.quadric.clip->axis;
      return t * (g[0] * ray.x + g[1] * ray.y + g[2] * ray.z) + g[3];
    };
    for (int i = 0; i < 400; ++i) {
      const double t = draw.uniform(window.low, window.high);
      const double f = f_at(t);
      const auto& clip = shell.quadric.clip;
      if (f < shell.low || f > shell.high) continue;
      if (clip && (height_at(t) < clip->from || height_at(t) > clip->to)) continue;
      ++samples;
      const bool is_held = std::ranges::any_of(
          crossings, [&](const golden::QuadricCrossing& c) { return t >= c.t.low && t <= c.t.high; });
      ASSERT_TRUE(is_held) << "round " << round << ", t " << t;
    }
    for (const golden::QuadricCrossing& c : crossings) {
      if (!c.is_certain) continue;
      ++certain;
      const double first = f_at(c.t.low);
      const double last = f_at(c.t.high);
      EXPECT_TRUE(first >= shell.high && last <= shell.low
                      ? true
                      : shell.quadric.two_sided && first <= shell.low && last >= shell.high)
          << "round " << round;
      if (!shell.quadric.clip) continue;
      for (const double t : {c.t.low, c.t.high}) {
        EXPECT_GE(height_at(t), shell.quadric.clip->from);
        EXPECT_LE(height_at(t), shell.quadric.clip->to);
      }
    }
  }
  EXPECT_GT(certain, 500);
  EXPECT_GT(samples, 10000);
}

Scene scene_of_mesh(const Mesh& mesh, int width = 160, int height = 120,
                    const std::function<void(MeshOptions&)>& change = {}) {
  MeshOptions options;
  options.width = width;
  options.height = height;
  if (change) change(options);
  ProjectReport report;
  return mesh_scene(mesh, options, report);
}
Scene scene_of_file(const std::string& path, int width = 160, int height = 120,
                    const std::function<void(MeshOptions&)>& change = {}) {
  return scene_of_mesh(read_mesh(path), width, height, change);
}
Scene scene_of_text(const std::string& text, int width = 160, int height = 120,
                    const std::function<void(MeshOptions&)>& change = {}) {
  const TemporaryFolder folder;
  return scene_of_file(folder.write("a.quad", text), width, height, change);
}

// What rays say of a frame; `frame` may be of another scene than the one that is judged.
VisibilityReport judged(const Config& config, const Scene& scene, const Frame& frame) {
  const Oracle& ray = oracle_named("ray");
  const Visibility visibility(config, scene, stored_depth_bounds(config, scene));
  return quadric_report(visibility, ray, visibility.picture(ray), frame, "engine");
}
VisibilityReport judged(const Config& config, const Scene& scene) {
  return judged(config, scene, drawn_by("model", config, scene));
}

std::string body(const std::string& lines) { return "[[body]]\n" + lines; }

// Per shape: a whole body, and one that is cut, open, or of two sheets.
std::vector<std::string> shapes() {
  return {
      body("shape = 'sphere'\nradius = 1\n"),
      body("shape = 'sphere'\nradius = 1\nfrom = -0.5\nto = 0.7\n"),
      body("shape = 'sphere'\nradius = 1\nfrom = -0.5\nto = 0.7\ncaps = false\naxis = [0, 1, -2]\n"),
      body("shape = 'ellipsoid'\nradii = [1, 0.4, 0.7]\naxis = [1, 1, 0]\n"),
      body("shape = 'cylinder'\nradii = [1, 1, 0.6]\nfrom = -1\nto = 1\n"),
      body("shape = 'cylinder'\nradii = [1, 1, 0.6]\nfrom = -1\nto = 1\ncaps = false\naxis = [1, 1, 1]\n"),
      body("shape = 'cone'\nradii = [1, 2, 1]\nfrom = -2\nto = 0\n"),
      body("shape = 'cone'\nradii = [1, 2, 1]\nfrom = -1\nto = 2\naxis = [1, 2, 0]\n"),
      body("shape = 'cone'\nradii = [1, 2, 1]\nfrom = -2\nto = -0.5\ncaps = false\naxis = [0, -1, 1]\n"),
      body("shape = 'paraboloid'\nradii = [1, 1, 1]\nto = 2\n"),
      body("shape = 'paraboloid'\nradii = [1, 1, 1]\nto = 2\ncaps = false\n"),
      body("shape = 'hyperboloid'\nradii = [0.5, 0.7, 0.5]\nfrom = -1\nto = 1\n"),
      body("shape = 'hyperboloid'\nradii = [0.5, 0.7, 0.5]\nfrom = -1\nto = 1\ncaps = false\n"),
      body("shape = 'hyperboloid_two'\nradii = [0.5, 0.4, 0.5]\nfrom = -1\nto = 1\n"),
      body("shape = 'hyperboloid_two'\nradii = [0.5, 0.4, 0.5]\nfrom = 0\nto = 1\ncaps = false\n")};
}

TEST(Quadrics, EveryShapeHolds) {
  std::uint64_t equal = 0;
  std::uint64_t edges = 0;
  for (const char* name : {"depth16", "depth20"}) {
    const Config config = shipped_config(name);
    for (const std::string& text : shapes()) {
      // Every third with the other depth; all of them in the long form.
      if (!is_long_run() && (text.size() % 3 == 0) != (config.depth_bits == 16)) continue;
      for (const double yaw :
           is_long_run() ? std::vector<double>{0, 30, 77, 150, 200, 300} : std::vector<double>{150}) {
        const Scene scene = scene_of_text("steps = 48\n" + text, 96, 72, [&](MeshOptions& o) {
          o.camera.yaw_degrees = yaw;
          o.camera.pitch_degrees = yaw / 4;
        });
        const VisibilityReport report = judged(config, scene);
        EXPECT_EQ(report.unexplained, 0U) << text << report.first;
        EXPECT_GT(report.equal, 300U) << text;
        EXPECT_LT(report.edges, report.equal / 4) << text;
        equal += report.equal;
        edges += report.edges;
      }
    }
  }
  printf("quadrics: %llu pixels equal, %llu at edges\n", static_cast<unsigned long long>(equal),
         static_cast<unsigned long long>(edges));
  EXPECT_LT(edges, equal / 12);
}

// More steps leave fewer pixels open, and triangles nearer to the body.
TEST(Quadrics, MoreStepsComeNearer) {
  const Config config = shipped_config("depth20");
  double last = 1e9;
  std::uint64_t edges = 1000;
  for (const int steps : {16, 32, 64, 128}) {
    const Scene scene =
        scene_of_text("steps = " + std::to_string(steps) + "\n[[body]]\nshape = 'sphere'\nradius = 1\n");
    const VisibilityReport report = judged(config, scene);
    EXPECT_EQ(report.unexplained, 0U) << report.first;
    ASSERT_EQ(report.counts.size(), 2U);
    EXPECT_GT(report.counts[0].value, 0.5) << steps;  // of the shell's width
    EXPECT_LE(report.counts[0].value, 1) << steps;
    EXPECT_LT(report.counts[1].value, 0.5 * last) << steps;  // codes
    EXPECT_LE(report.edges, edges) << steps;
    last = report.counts[1].value;
    edges = report.edges;
  }
}

std::string solids() { return source_path("tests/data/solids.quad"); }

TEST(Quadrics, ManyBodiesHoldFromAllSides) {
  const Config config = shipped_config("depth20");
  const Mesh mesh = read_mesh(solids());
  for (int i = 0; i < (is_long_run() ? 72 : 2); ++i) {
    const Scene scene = scene_of_mesh(mesh, 112, 84, [&](MeshOptions& o) {
      o.camera.yaw_degrees = 5 + 97 * i;
      o.camera.pitch_degrees = 50 - 37 * (i % 3);
    });
    const VisibilityReport report = judged(config, scene);
    EXPECT_EQ(report.unexplained, 0U) << i << ": " << report.first;
    EXPECT_GT(report.equal, 1700U);
    EXPECT_LT(report.edges, report.equal / 8);
  }
}

TEST(Quadrics, HoldBesideSpot) {
  const TemporaryFolder folder;
  folder.write("a.quad",
               "steps = 64\n[[body]]\nshape = 'sphere'\nradius = 0.6\ncentre = [0.5, 0.4, -0.3]\n"
               "[[body]]\nshape = 'cylinder'\nradii = [1.2, 1, 1.2]\nfrom = -0.9\nto = -0.7\n"
               "[[mesh]]\nfile = '" +
                   source_path("tests/data/spot.obj") + "'\n");
  const Scene scene = scene_of_file(folder.path("a.quad"));
  const Config config = shipped_config("depth20");
  const VisibilityReport report = judged(config, scene);
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 4000U);
  // Behind a body Spot's triangles are not seen: swapped depths are found.
  Scene swapped = scene;
  swapped.commands.push_back({0, StateChange{false, {{*find_state_register("depth.func"), 7}}}});
  EXPECT_GT(judged(config, scene, drawn_by("model", config, swapped)).unexplained, 100U);
}

// Cut by the picture's sides, by the near plane, and with the viewer inside.
TEST(Quadrics, HoldWhereTheyAreCut) {
  const Config config = shipped_config("depth20");
  const Mesh mesh = read_mesh(solids());
  for (const double distance : {4.0, 2.5, 1.5}) {
    const Scene scene = scene_of_mesh(mesh, 160, 120, [&](MeshOptions& o) {
      o.camera.distance = distance;
      o.camera.s_min = 0.8;
      o.camera.s_max = 20;
    });
    const VisibilityReport report = judged(config, scene);
    EXPECT_EQ(report.unexplained, 0U) << distance << ": " << report.first;
    EXPECT_GT(report.equal, 6000U);
  }
}

// The scene as the engine draws it has another body than the one that rays are told of.
struct Fault {
  const char* name;
  std::string right, wrong;
};
TEST(Quadrics, PlantedFaultsAreFound) {
  const std::string sphere = "shape = 'sphere'\nsteps = 48\n";
  const std::vector<Fault> faults{
      {"radius 3 % larger", sphere + "radius = 1\n", sphere + "radius = 1.03\n"},
      {"radius 3 % smaller", sphere + "radius = 1\n", sphere + "radius = 0.97\n"},
      {"shifted sideways", sphere + "radius = 1\n", sphere + "radius = 1\ncentre = [0.04, 0, 0]\n"},
      {"nearer", sphere + "radius = 1\n", sphere + "radius = 1\ncentre = [0, 0, -0.04]\n"},
      {"a cone that leans", "shape = 'cone'\nradii = [1, 2, 1]\nfrom = -2\nto = 0\nsteps = 64\n",
       "shape = 'cone'\nradii = [1, 2, 1]\nfrom = -2\nto = 0\nsteps = 64\naxis = [0.03, 1, 0]\n"},
      {"a cap that stands too deep", "shape = 'cylinder'\nradius = 1\nfrom = -1\nto = 1\nsteps = 64\n",
       "shape = 'cylinder'\nradius = 1\nfrom = -1\nto = 0.97\nsteps = 64\n"}};
  const Config config = shipped_config("depth20");
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    const auto view = [](MeshOptions& o) {
      o.camera.position = Vec3{2, 3, -4};
      o.camera.target = Vec3{0, 0, 0};
      o.camera.s_min = 1;
      o.camera.s_max = 10;
    };
    const Scene right = scene_of_text(body(fault.right), 160, 120, view);
    Scene wrong = scene_of_text(body(fault.wrong), 160, 120, view);
    EXPECT_EQ(judged(config, right).unexplained, 0U);
    Quadric claimed = right.quadrics.at(0);
    claimed.first = wrong.quadrics.at(0).first;
    claimed.count = wrong.quadrics.at(0).count;
    wrong.quadrics = {claimed};
    const VisibilityReport report = judged(config, wrong);
    EXPECT_GT(report.unexplained, 100U);
    EXPECT_FALSE(report.held());
  }
}

TEST(Quadrics, AHoleAndAHiddenBodyAreFound) {
  const Config config = shipped_config("depth20");
  const Scene scene = scene_of_text(
      body("shape = 'cylinder'\nradius = 2\nfrom = -0.2\nto = 0\n") +
          body("shape = 'sphere'\nradius = 0.8\ncentre = [-0.8, 0.8, 0.2]\n") +
          body("shape = 'sphere'\nradius = 0.5\ncentre = [0.7, 0.5, -0.8]\n") +
          body("shape = 'cone'\nradii = [0.6, 1.5, 0.6]\ncentre = [0.8, 1.5, 0.7]\nfrom = -1.5\nto = 0\n"),
      112, 84);
  const Frame right = drawn_by("model", config, scene);
  ASSERT_EQ(judged(config, scene, right).unexplained, 0U);
  std::vector<int> pixels(scene.triangles.size());
  for (const std::int32_t triangle : right.triangle) {
    if (triangle >= 0) ++pixels[static_cast<std::size_t>(triangle)];
  }
  const auto largest = std::ranges::max_element(pixels) - pixels.begin();
  Scene holed = scene;
  erase_triangles(holed, static_cast<std::size_t>(largest), 1);
  EXPECT_GT(judged(config, holed).unexplained, 5U);
  // A body of which no triangle is drawn, but rays know it.
  Scene hidden = scene;
  const std::size_t sphere = scene.quadrics.at(1).first;
  const std::size_t count = scene.quadrics[1].count;
  erase_triangles(hidden, sphere + 1, count - 1);
  EXPECT_GT(judged(config, hidden).unexplained, 100U);
  // Four codes nearer, beyond the bound of what is stored.
  EXPECT_GT(judged(config, scene,
                   drawn_by("model", config, test::biased(scene, static_cast<std::size_t>(largest), 4)))
                .unexplained,
            5U);
  // The frame of the whole scene against rays that are told of a body in front of it.
  Scene more = scene;
  more.quadrics[1].matrix = scene.quadrics[2].matrix;
  EXPECT_GT(judged(config, more, right).unexplained, 100U);
}

TEST(Quadrics, OfNoTriangleLeaveTheReportEmpty) {
  const Config config = shipped_config("depth16");
  const VisibilityReport report = judged(config, test::two_that_cut());
  EXPECT_EQ(report.unexplained, 0U);
  EXPECT_EQ(report.edges, 0U);
  EXPECT_GT(report.equal, 500U);
  EXPECT_EQ(report.oracle, "ray_quadrics");
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

// Normals that light interpolates beside those of the body where the ray meets it: the angle is at most the
// largest between two corners of the triangle. The brightness differs from Lambert's law of the exact normal
// by no more than that angle and two codes.
TEST(Quadrics, NormalsOfLightAreThoseOfTheBody) {
  Config config = shipped_config("depth20");
  config.light = LightAt::pixel;
  const auto lit = [](MeshOptions& o) {
    o.light = LightOptions{.light = {.place = {0.4, 0.8, -0.6}}, .by_unit = true};
    o.light->light.ambient = 0.1;
    o.light->light.specular = 0;
  };
  std::uint64_t compared = 0;
  double worst_share = 0;
  double worst_code = -255;
  for (const std::string& text :
       {body("shape = 'sphere'\nradius = 1\n"),
        body("shape = 'ellipsoid'\nradii = [1, 0.6, 0.8]\naxis = [1, 1, 0]\n"),
        body("shape = 'paraboloid'\nradii = [1, 1, 1]\nto = 2\naxis = [0, -1, 0]\n")}) {
    const Scene scene = scene_of_text("steps = 48\n" + text, 96, 72, lit);
    ASSERT_TRUE(scene.light);
    const Quadric& q = scene.quadrics.at(0);
    const Frame frame = drawn_by("model", config, scene);
    const Visibility visibility(config, scene, stored_depth_bounds(config, scene));
    const std::vector<Visible> picture = visibility.picture(oracle_named("ray"));
    for (std::size_t at = 0; at < picture.size(); ++at) {
      const Visible& seen = picture[at];
      if (seen.triangle < 0 || frame.triangle[at] != seen.triangle) continue;
      const auto x = static_cast<std::int64_t>(at) % scene.width;
      const auto y = static_cast<std::int64_t>(at) / scene.width;
      const QuadricRay ray = golden::ray_through(scene, x, y);
      const auto hit = golden::first_hit(q, ray, {scene.s_min / ray.z, scene.s_max / ray.z});
      if (!hit) continue;
      const double t = hit->t.low;
      const Vec3 truth = gradient_at(q, Vec3{ray.x, ray.y, ray.z} * t);
      const auto shape = ideal_triangle(config, scene.triangles[static_cast<std::size_t>(seen.triangle)]);
      Vec3 between;
      double most = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 n = normal_of(shape->v[i].given);
        between = between + n * static_cast<double>(static_cast<long double>(seen.q.part[i]));
        most = std::max(most, angle_between(n, normal_of(shape->v[(i + 1) % 3].given)));
      }
      const double angle = angle_between(between, truth);
      worst_share = std::max(worst_share, angle / most);
      const Light& light = *scene.light;
      const Vec3 to_light = of_length_1({light.place[0], light.place[1], light.place[2]});
      const double cosine = std::max(0.0, dot(of_length_1(truth), to_light));
      const double code = 255 * (light.ambient + (1 - light.ambient) * cosine);
      worst_code = std::max(worst_code, std::fabs(code - frame.color[4 * at]) - 255 * angle);
      ++compared;
    }
  }
  printf("normals: %llu pixels, %.3f of the angle between corners at most, %.2f codes beyond it\n",
         static_cast<unsigned long long>(compared), worst_share, worst_code);
  EXPECT_GT(compared, 5000U);
  EXPECT_LE(worst_share, 1);
  EXPECT_LE(worst_code, 2);
}

}  // namespace
}  // namespace bitspan
