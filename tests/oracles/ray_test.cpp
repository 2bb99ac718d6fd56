// SPDX-License-Identifier: Apache-2.0
// Rays against values worked by hand, against another oracle pixel by pixel, and against the engines. [V2]
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "scene/mesh.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using test::Agreement;
using test::At;
using test::compare_pictures;
using test::drawn_by;
using test::picture_of;
using test::scene_of;
using test::spot;
using test::triangle_at;
using test::triangle_of;

golden::InverseDistance fraction(int numerator, int denominator) {
  golden::InverseDistance q;
  q.part = {numerator, 0, 0};
  q.whole = denominator;
  q.value = static_cast<long double>(numerator) / static_cast<long double>(denominator);
  return q;
}

Agreement agreement(const Config& config, const Scene& scene) {
  return test::agreement("ray", config, scene);
}

TEST(Ray, MeetsAPlaneWhereItIs) {
  const Config config = shipped_config("depth16");
  // 1/S is 1/2 at (8, 8), less by 1/64 per pixel to the right, and by 3/128 per pixel downwards.
  const Scene scene = scene_of({triangle_of({8, 8, 2}, {24, 8, 4}, {8, 24, 8})});
  const std::vector<Visible> picture = picture_of("ray", config, scene);
  const Visible& seen = picture[10 * 64 + 12];  // its centre is at (12.5, 10.5)
  EXPECT_EQ(seen.triangle, 0);
  EXPECT_TRUE(seen.q == fraction(95, 256));
  EXPECT_NEAR(static_cast<double>(seen.q.value), 95.0 / 256, 1e-15);
  EXPECT_EQ(triangle_at(picture, scene, 7, 10), -1);
  EXPECT_EQ(triangle_at(picture, scene, 30, 30), -1);
}

TEST(Ray, SeesTheNearestOfThree) {
  const Config config = shipped_config("depth16");
  const auto at = [](double s) { return triangle_of({4, 4, s}, {60, 4, s}, {4, 44, s}); };
  const Scene scene = scene_of({at(20), at(10), at(30)});
  const Visible seen = picture_of("ray", config, scene)[10 * 64 + 12];
  EXPECT_EQ(seen.triangle, 1);
  EXPECT_TRUE(seen.q == fraction(1, 10));
}

TEST(Ray, ASceneWithoutAreaShowsNothing) {
  const Config config = shipped_config("depth16");
  for (const Scene& scene : {scene_of({}), scene_of({triangle_of({4, 4, 10}, {40, 4, 20}, {22, 4, 10})}),
                             scene_of({triangle_of({4, 4, 10}, {4, 4, 20}, {40, 30, 10})})}) {
    for (const Visible& seen : picture_of("ray", config, scene)) EXPECT_EQ(seen.triangle, -1);
  }
}

// A square whose sides and diagonal go through centres. It owns its upper and its left side, and the diagonal
// is the left side of triangle 1.
TEST(Ray, TheFillRuleDecidesOnSides) {
  Config config = shipped_config("depth16");
  const Scene scene = scene_of({triangle_of({4.5, 4.5, 10}, {12.5, 12.5, 10}, {4.5, 12.5, 10}),
                                triangle_of({4.5, 4.5, 10}, {12.5, 4.5, 10}, {12.5, 12.5, 10})},
                               20, 20);
  const std::vector<Visible> picture = picture_of("ray", config, scene);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool inside = x >= 4 && x < 12 && y >= 4 && y < 12;
      EXPECT_EQ(triangle_at(picture, scene, x, y), !inside ? -1 : x >= y ? 1 : 0) << x << ", " << y;
    }
  }
  config.fill_rule = FillRule::inclusive;
  const std::vector<Visible> all = picture_of("ray", config, scene);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool inside = x >= 4 && x <= 12 && y >= 4 && y <= 12;
      EXPECT_EQ(triangle_at(all, scene, x, y), !inside ? -1 : x > y ? 1 : 0) << x << ", " << y;
    }
  }
}

// Eight triangles around a centre, on whose sides many centres lie: each centre has one of them.
TEST(Ray, AFanCoversEachPixelOnce) {
  const Config config = shipped_config("depth16");
  const std::array<std::array<double, 2>, 8> rim{{{20.5, 10.5},
                                                  {18.5, 18.5},
                                                  {10.5, 20.5},
                                                  {2.5, 18.5},
                                                  {0.5, 10.5},
                                                  {2.5, 2.5},
                                                  {10.5, 0.5},
                                                  {18.5, 2.5}}};
  std::array<int, 24 * 24> hits{};
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& a = rim[i];
    const auto& b = rim[(i + 1) % 8];
    const Scene scene = scene_of({triangle_of({10.5, 10.5, 10}, {a[0], a[1], 20}, {b[0], b[1], 30})}, 24, 24);
    const std::vector<Visible> picture = picture_of("ray", config, scene);
    for (std::size_t at = 0; at < picture.size(); ++at) hits[at] += picture[at].triangle == 0 ? 1 : 0;
  }
  for (int y = 4; y <= 16; ++y) {
    for (int x = 4; x <= 16; ++x) EXPECT_EQ(hits[static_cast<std::size_t>(y * 24 + x)], 1) << x << ", " << y;
  }
}

// Vertices on pixels' centres and borders, so that many centres lie on a side or a corner.
TEST(Ray, EqualsTheCoverageOnEdgesToo) {
  Random draw(25);
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    std::uint64_t covered = 0;
    std::uint64_t on_edge = 0;
    for (int round = 0; round < 1500; ++round) {
      const auto corner = [&] {
        return At{static_cast<double>(draw.integer(-2, 26)) / 2,
                  static_cast<double>(draw.integer(-2, 26)) / 2, draw.log_uniform(1, 20)};
      };
      const Scene scene = scene_of({triangle_of(corner(), corner(), corner())}, 12, 12);
      const auto shape = ideal_triangle(config, scene.triangles[0]);
      if (!shape) continue;
      const std::vector<Visible> picture = picture_of("ray", config, scene);
      for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < 12; ++x) {
          const golden::Areas areas = golden::areas_at(*shape, golden::centre_of(*shape, x, y));
          const bool inside = golden::covers(*shape, areas, rule);
          ASSERT_EQ(triangle_at(picture, scene, x, y) == 0, inside) << "round " << round;
          covered += inside ? 1 : 0;
          on_edge += areas.part[0] == 0 || areas.part[1] == 0 || areas.part[2] == 0 ? 1 : 0;
        }
      }
    }
    EXPECT_GT(covered, 18000U);
    EXPECT_GT(on_edge, 4000U);
  }
}

TEST(Ray, SeesWhatHalfPlanesSee) {
  const Config config = shipped_config("depth20");
  const std::uint64_t scenes = is_long_run() ? 1000 : 40;
  Agreement all;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const Agreement one = agreement(config, test::random_opaque_scene(seed));
    EXPECT_EQ(one.differences, 0U) << "random scene, seed " << seed;
    all.seen += one.seen;
    all.background += one.background;
  }
  EXPECT_GT(all.seen, 1500 * scenes);
  EXPECT_GT(all.background, 100 * scenes);
}

// Slivers a sixteenth of a pixel wide, and triangles far outside the picture.
TEST(Ray, SeesWhatHalfPlanesSeeOfSliversAndGiants) {
  const Config config = shipped_config("depth16");
  Random draw(26);
  Agreement all;
  for (int round = 0; round < 30; ++round) {
    std::vector<Triangle> triangles;
    for (int i = 0; i < 20; ++i) {
      const At a{draw.uniform(0, 64), draw.uniform(0, 48), draw.uniform(1, 100)};
      const At b{draw.uniform(0, 64), draw.uniform(0, 48), draw.uniform(1, 100)};
      triangles.push_back(triangle_of(a, b, {b.x + 0.0625, b.y - 0.0625, draw.uniform(1, 100)}));
    }
    const auto outside = [&] {
      return At{draw.uniform(-1000, 1000), draw.uniform(-1000, 1000), draw.uniform(1, 100)};
    };
    for (int i = 0; i < 3; ++i) triangles.push_back(triangle_of(outside(), outside(), outside()));
    const Agreement one = agreement(config, scene_of(triangles));
    EXPECT_EQ(one.differences, 0U) << "round " << round;
    all.seen += one.seen;
  }
  EXPECT_GT(all.seen, 20000U);
}

// From beside the eye to far away, up to more than a double's products hold.
TEST(Ray, DistancesMayDifferBeyondAllMeasure) {
  const Config config = shipped_config("depth16");
  for (const double ratio : {1e3, 1e6, 1e9, 1e40, 1e250}) {
    Random draw(27);
    Agreement all;
    for (int round = 0; round < 6; ++round) {
      const Agreement one = agreement(config, test::scattered_scene(draw, ratio, 12, {-20, 84}, {-20, 68}));
      EXPECT_EQ(one.differences, 0U) << "ratio " << ratio << ", round " << round;
      all.seen += one.seen;
    }
    EXPECT_GT(all.seen, 8000U) << ratio;
  }
}

// Of equal triangles the first is seen, and of triangles that differ by the last bit of one corner the
// nearer.
TEST(Ray, TheLastBitOfADistanceDecides) {
  const Config config = shipped_config("depth16");
  Random draw(28);
  Agreement all;
  std::array<std::uint64_t, 2> seen{};
  for (int round = 0; round < 20; ++round) {
    const auto corner = [&] {
      return At{draw.uniform(0, 64), draw.uniform(0, 48), draw.log_uniform(1, 1000)};
    };
    const Triangle one = triangle_of(corner(), corner(), corner());
    Triangle two = one;
    const double towards = round % 3 == 0 ? two.v[0].s : round % 3 == 1 ? 0 : 1e9;
    two.v[0].s = std::nextafter(two.v[0].s, towards);
    const Scene scene = scene_of({one, two});
    const std::vector<Visible> picture = picture_of("ray", config, scene);
    for (const Visible& at : picture) {
      if (at.triangle < 0) continue;
      ++seen[static_cast<std::size_t>(at.triangle)];
      // A corner may have no weight at a centre on the side opposite to it; no such centre is drawn here.
      EXPECT_EQ(at.triangle, round % 3 == 1 ? 1 : 0) << "round " << round;
    }
    compare_pictures(picture, picture_of("half_planes", config, scene), all);
  }
  EXPECT_EQ(all.differences, 0U);
  EXPECT_GT(seen[0], 1000U);
  EXPECT_GT(seen[1], 500U);
}

TEST(Ray, AgreesWithTheEngines) {
  std::uint64_t equal = 0;
  for (const Config& config : shipped_configs()) {
    for (std::uint64_t seed = 30; seed < 34; ++seed) {
      const Scene scene = test::random_opaque_scene(seed);
      for (const char* engine : {"golden", "model"}) {
        const VisibilityReport report =
            test::compared(test::oracle_named("ray"), config, scene, drawn_by(engine, config, scene));
        EXPECT_EQ(report.unexplained, 0U) << config.name << ", seed " << seed << ": " << report.first;
        equal += report.equal;
      }
    }
  }
  EXPECT_GT(equal, 25000U);
}

// BITSPAN_LONG asks for 10^4 of them.
TEST(Ray, RandomStreamsHold) { test::hold_random_streams("ray", is_long_run() ? 10000 : 60, 1001); }

TEST(Ray, SeesSpot) {
  const Scene scene = spot(320, 240);
  for (const char* name : {"depth16", "depth20"}) {
    const Config config = shipped_config(name);
    const VisibilityReport report =
        test::compared(test::oracle_named("ray"), config, scene, drawn_by("model", config, scene));
    EXPECT_EQ(report.unexplained, 0U) << name << ": " << report.first;
    EXPECT_GT(report.equal, 12000U);
  }
  EXPECT_EQ(agreement(shipped_config("depth20"), scene).differences, 0U);
}

// A floor that goes on behind the viewer: it is cut where it comes too near, and its distances differ by far.
TEST(Ray, SeesAFloorThatPassesUnderTheEye) {
  Mesh mesh;
  const auto face = [](Vec3 a, Vec3 b, Vec3 c) {
    Face out;
    out.corner[0].position = a;
    out.corner[1].position = b;
    out.corner[2].position = c;
    out.two_sided = true;
    return out;
  };
  mesh.faces = {face({-50, -1, -100}, {50, -1, -100}, {50, -1, 100}),
                face({-50, -1, -100}, {50, -1, 100}, {-50, -1, 100}),
                face({-2, -1, -20}, {2, -1, -20}, {0.5, 3, 0})};
  MeshOptions options;
  options.width = 160;
  options.height = 120;
  options.camera.position = Vec3{0, 0, 0};
  options.camera.target = Vec3{0, -0.2, -1};
  options.camera.s_min = 0.2;
  options.camera.s_max = 150;
  ProjectReport report;
  const Scene scene = mesh_scene(mesh, options, report);
  const Config config = shipped_config("depth20");
  const VisibilityReport seen =
      test::compared(test::oracle_named("ray"), config, scene, drawn_by("model", config, scene));
  EXPECT_EQ(seen.unexplained, 0U) << seen.first;
  EXPECT_GT(seen.equal, 8000U);
  EXPECT_EQ(agreement(config, scene).differences, 0U);
}

// The engine draws the second of two triangles four codes too near or too far.
TEST(Ray, ABiasOfFourCodesOnOneTriangleIsFound) {
  const Config config = shipped_config("depth20");
  for (const std::int64_t bias : {4, -4}) {
    const Scene scene = test::two_that_cut();
    Scene biased = scene;
    biased.commands.push_back({1, StateChange{false, {{*find_state_register("depth.bias"), bias}}}});
    const VisibilityReport report =
        test::compared(test::oracle_named("ray"), config, scene, drawn_by("model", config, biased));
    EXPECT_GT(report.unexplained, 500U) << bias;
    EXPECT_FALSE(report.held());
    EXPECT_NE(report.first.find("of triangle 1"), std::string::npos) << report.first;
  }
}

// One of Spot's triangles alone, the one that most pixels show.
TEST(Ray, ABiasOfFourCodesOnOneOfSpotsTrianglesIsFound) {
  const Config config = shipped_config("depth20");
  const Scene scene = spot(320, 240);
  const Frame right = drawn_by("model", config, scene);
  std::vector<int> pixels(scene.triangles.size());
  for (const std::int32_t triangle : right.triangle) {
    if (triangle >= 0) ++pixels[static_cast<std::size_t>(triangle)];
  }
  const auto largest = static_cast<std::size_t>(std::ranges::max_element(pixels) - pixels.begin());
  const VisibilityReport report = test::compared(test::oracle_named("ray"), config, scene,
                                                 drawn_by("model", config, test::biased(scene, largest, 4)));
  EXPECT_GT(report.unexplained, 10U);
  EXPECT_NE(report.first.find("of triangle " + std::to_string(largest)), std::string::npos) << report.first;
}

}  // namespace
}  // namespace bitspan
