// SPDX-License-Identifier: Apache-2.0
// Three tests of a point in a triangle against signed areas and against the engines. [B7]
#include <gtest/gtest.h>

#include <string>

#include "tests/oracles/oracle_support.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

const std::vector<std::string> three{"half_planes", "rotations", "simplex"};

// Pixels that one oracle finds covered of a triangle, and the exact test does not, or the other way round.
int differences(const std::string& name, const Config& config, const Scene& scene, int& covered,
                int& on_edge) {
  const auto shape = ideal_triangle(config, scene.triangles[0]);
  if (!shape) return 0;
  const std::vector<OracleFace> faces{{0, *shape}};
  const std::vector<Visible> picture = test::oracle_named(name).visible({config, scene, faces});
  int out = 0;
  for (std::int64_t y = 0; y < scene.height; ++y) {
    for (std::int64_t x = 0; x < scene.width; ++x) {
      const bool inside = ideal_covers(config, *shape, x, y);
      const golden::Areas areas = golden::areas_at(*shape, golden::centre_of(*shape, x, y));
      covered += inside ? 1 : 0;
      on_edge += areas.part[0] == 0 || areas.part[1] == 0 || areas.part[2] == 0 ? 1 : 0;
      out += inside != (picture[static_cast<std::size_t>(y * scene.width + x)].triangle == 0) ? 1 : 0;
    }
  }
  return out;
}

// Vertices on pixels' centres and borders, so that many centres lie on an edge, in both orientations.
TEST(PointInTriangle, EqualsTheCoverageOnEdgesToo) {
  Random draw(3);
  for (const FillRule rule : {FillRule::top_left, FillRule::inclusive}) {
    Config config = shipped_config("depth16");
    config.fill_rule = rule;
    int covered = 0;
    int on_edge = 0;
    for (int round = 0; round < 1500; ++round) {
      const auto corner = [&] {
        return test::At{static_cast<double>(draw.integer(-2, 26)) / 2,
                        static_cast<double>(draw.integer(-2, 26)) / 2, 10};
      };
      const Scene scene = test::scene_of({test::triangle_of(corner(), corner(), corner())}, 12, 12);
      for (const std::string& name : three) {
        ASSERT_EQ(differences(name, config, scene, covered, on_edge), 0) << name << ", round " << round;
      }
    }
    EXPECT_GT(covered, 50000);
    EXPECT_GT(on_edge, 10000);
  }
}

TEST(PointInTriangle, AgreesWithTheEngines) {
  for (const Config& config : shipped_configs()) {
    for (std::uint64_t seed = 20; seed < 24; ++seed) {
      const Scene scene = test::random_opaque_scene(seed);
      const Frame frame = test::drawn_by("model", config, scene);
      for (const std::string& name : three) {
        const VisibilityReport report = test::compared(test::oracle_named(name), config, scene, frame);
        EXPECT_EQ(report.unexplained, 0U) << name << ", " << config.name << ": " << report.first;
        EXPECT_GT(report.equal, 1000U);
      }
    }
  }
}

}  // namespace
}  // namespace bitspan
