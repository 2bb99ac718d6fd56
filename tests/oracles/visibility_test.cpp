// SPDX-License-Identifier: Apache-2.0
// The comparison itself, with an oracle by signed areas: what is equal, what is a tie, and what must be red.
#include "report/visibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <filesystem>
#include <functional>

#include "config/modes.hpp"
#include "engine/range.hpp"
#include "report/random_config.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using test::compared;
using test::drawn_by;
using test::triangle_of;
using test::two_that_cut;

const int configurations = is_long_run() ? 1000 : 20;

const Oracle by_areas{.name = "by_areas",
                      .meaning = "a pixel is inside by three signed areas",
                      .visible = [](const OracleInput& input) {
                        return golden::nearest_faces(input, [&](const IdealTriangle& t, golden::Point p) {
                          return golden::covers(t, golden::areas_at(t, p), input.config.fill_rule);
                        });
                      }};

// The engine draws the scene in a state that the comparison is not told of.
Frame drawn_with(const Config& config, Scene scene, std::size_t before, const std::string& key,
                 std::int64_t value) {
  scene.commands.push_back({before, StateChange{false, {{*find_state_register(key), value}}}});
  return drawn_by("model", config, scene);
}

TEST(Visibility, ShippedConfigurationsHoldOnTrianglesThatCut) {
  for (const Config& config : shipped_configs()) {
    const Scene scene = two_that_cut();
    for (const char* engine : {"golden", "model"}) {
      const VisibilityReport report = compared(by_areas, config, scene, drawn_by(engine, config, scene));
      EXPECT_EQ(report.unexplained, 0U) << config.name << ": " << report.first;
      EXPECT_GT(report.equal, 1000U);
      EXPECT_EQ(report.left_out, 0U);
      EXPECT_EQ(report.background + report.compared(), 64U * 48U);
      EXPECT_TRUE(report.held());
    }
  }
}

TEST(Visibility, RandomScenesHoldInTheShippedConfigurations) {
  std::uint64_t equal = 0;
  for (const Config& config : shipped_configs()) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Scene scene = test::random_opaque_scene(seed);
      const VisibilityReport report = compared(by_areas, config, scene, drawn_by("model", config, scene));
      EXPECT_EQ(report.unexplained, 0U) << config.name << ", seed " << seed << ": " << report.first;
      equal += report.equal;
    }
  }
  EXPECT_GT(equal, 60000U);
}

// Whatever the widths, roundings and units are, as far as a bound is known.
TEST(Visibility, RandomConfigurationsHold) {
  RandomConfigOptions options;
  options.check = [](const Config& config) {
    const PassingDistances passing = passing_distances(config.depth_func);
    if (!has_bounds(config) || has_x_step(config) || !passing.nearer || passing.farther) {
      throw InputError("not compared");
    }
  };
  const std::vector<Config> bases = shipped_configs();
  int taken = 0;
  std::uint64_t ties = 0;
  std::uint64_t equal = 0;
  for (std::uint64_t seed = 1; taken < configurations; ++seed) {
    ASSERT_LT(seed, 20U * static_cast<unsigned>(configurations));
    const Config config = random_config(seed, bases, options);
    const Scene scene = test::random_opaque_scene(seed);
    std::vector<double> bounds;
    if (!visibility_refusal(config, scene).empty()) continue;  // alpha is lost
    try {
      check_scene_range(config, scene);
      bounds = stored_depth_bounds(config, scene);
    } catch (const InputError&) {
      continue;  // the scene does not fit, or a wrapping constant has no bound
    }
    ++taken;
    const Visibility visibility(config, scene, bounds);
    const VisibilityReport report =
        visibility.compare(by_areas, visibility.picture(by_areas), drawn_by("model", config, scene), "model");
    EXPECT_EQ(report.unexplained, 0U) << "configuration " << seed << ": " << report.first;
    ties += report.ties;
    equal += report.equal;
  }
  EXPECT_GT(equal, 1000U * static_cast<unsigned>(configurations));
  EXPECT_GT(ties, 0U);
}

TEST(Visibility, ABiasOfFourCodesOnOneTriangleOfTwoIsFound) {
  for (const char* name : {"depth16", "depth20"}) {
    const Config config = shipped_config(name);
    const Scene scene = two_that_cut();
    for (const std::int64_t bias : {4, -4}) {
      const VisibilityReport report =
          compared(by_areas, config, scene, drawn_with(config, scene, 1, "depth.bias", bias));
      EXPECT_GT(report.unexplained, 500U) << name;
      EXPECT_FALSE(report.held());
      EXPECT_NE(report.first.find("of triangle 1"), std::string::npos) << report.first;
    }
  }
}

// The bias again, with stored codes that hide it: then the pixels along the cut alone tell.
TEST(Visibility, ABiasOfTheOrderAloneIsFound) {
  const Config config = shipped_config("depth20");
  // Nearly parallel planes, so that some codes more move the cut by whole pixels.
  const Scene scene = test::scene_of({triangle_of({2, 2, 20}, {62, 2, 20}, {2, 46, 20}),
                                      triangle_of({2, 2, 20.0005}, {62, 2, 19.9995}, {2, 46, 20.0005})});
  EXPECT_EQ(compared(by_areas, config, scene, drawn_by("model", config, scene)).unexplained, 0U);
  Frame frame = drawn_with(config, scene, 1, "depth.bias", 4);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.triangle[i] == 1) frame.depth[i] -= 4;
  }
  const VisibilityReport report = compared(by_areas, config, scene, frame);
  EXPECT_GT(report.unexplained, 0U);
  EXPECT_GT(report.ties, 0U);
  EXPECT_NE(report.first.find("sees triangle 0"), std::string::npos) << report.first;
}

TEST(Visibility, OnePixelOfCoverageIsFound) {
  const Config config = shipped_config("depth16");
  const Scene scene = test::scene_of({triangle_of({4, 4, 10}, {40, 4, 20}, {4, 40, 15})});
  const Frame right = drawn_by("model", config, scene);
  ASSERT_TRUE(compared(by_areas, config, scene, right).held());
  const std::size_t inside = 4 * 64 + 4;
  const std::size_t outside = inside - 1;
  ASSERT_EQ(right.triangle[inside], 0);
  ASSERT_EQ(right.triangle[outside], -1);
  Frame surplus = right;
  surplus.triangle[outside] = 0;
  surplus.depth[outside] = right.depth[inside];
  VisibilityReport report = compared(by_areas, config, scene, surplus);
  EXPECT_EQ(report.unexplained, 1U);
  EXPECT_NE(report.first.find("pixel (3, 4): engine shows triangle 0, which cannot be seen there"),
            std::string::npos)
      << report.first;
  Frame missing = right;
  missing.triangle[inside] = -1;
  missing.depth[inside] = 0;
  report = compared(by_areas, config, scene, missing);
  EXPECT_EQ(report.unexplained, 1U);
  EXPECT_NE(report.first.find("pixel (4, 4): by_areas sees triangle 0"), std::string::npos) << report.first;
  EXPECT_EQ(report.pixels[inside], PixelVerdict::unexplained);
}

TEST(Visibility, AnOracleThatNamesAWrongDepthIsFound) {
  const Config config = shipped_config("depth16");
  const Scene scene = test::scene_of({triangle_of({4, 4, 10}, {40, 4, 20}, {4, 40, 15})});
  const Visibility visibility(config, scene, stored_depth_bounds(config, scene));
  std::vector<Visible> picture = visibility.picture(by_areas);
  picture[4 * 64 + 4].q.s[0] += 1e-15L;  // too little for any code
  const VisibilityReport report =
      visibility.compare(by_areas, picture, drawn_by("model", config, scene), "model");
  EXPECT_EQ(report.unexplained, 1U);
}

// The same triangle twice, and a square's two halves: equal depths, exactly.
TEST(Visibility, EqualDepthsAreTiesInEitherOrder) {
  const Config config = shipped_config("depth16");
  const Triangle one = triangle_of({4, 4, 10}, {40, 4, 20}, {4, 40, 15});
  const Scene scene = test::scene_of({one, one});
  VisibilityReport report = compared(by_areas, config, scene, drawn_by("model", config, scene));
  EXPECT_EQ(report.ties, 0U);
  EXPECT_EQ(report.unexplained, 0U);
  Config last = config;
  last.depth_func = DepthFunc::lequal;
  report = compared(by_areas, last, scene, drawn_by("model", last, scene));
  EXPECT_EQ(report.equal, 0U);
  EXPECT_GT(report.ties, 500U);
  EXPECT_EQ(report.unexplained, 0U);
}

TEST(Visibility, TheComplementOfHIsComparedAlike) {
  Config config = shipped_config("depth16");
  config.depth_code = DepthCode::opengl;
  const Scene scene = two_that_cut();
  const VisibilityReport report = compared(by_areas, config, scene, drawn_by("model", config, scene));
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 1000U);
}

// A triangle whose fragments may be killed counts only where it may be in front.
TEST(Visibility, PixelsThatMayBeKilledAreLeftOut) {
  const Config config = shipped_config("depth16");
  Scene scene = test::scene_of(
      {triangle_of({4, 4, 10}, {60, 4, 10}, {4, 40, 10}), triangle_of({4, 4, 20}, {60, 4, 20}, {4, 40, 20})});
  const auto count = [&] { return compared(by_areas, config, scene, drawn_by("model", config, scene)); };
  const std::uint64_t all = count().equal;
  ASSERT_GT(all, 500U);
  scene.triangles[1].v[0].c[3] = 0.5;  // behind
  EXPECT_EQ(count().equal, all);
  EXPECT_EQ(count().left_out, 0U);
  scene.triangles[1].v[0].c[3] = 1;
  scene.triangles[0].v[0].c[3] = 0.5;
  EXPECT_EQ(count().left_out, all);
  EXPECT_EQ(count().compared(), 0U);
  // A texture with a hole does the same, and one without does not.
  scene.triangles[0].v[0].c[3] = 1;
  scene.triangles[0].texture = 0;
  scene.textures.push_back({"checks", 2, 1, {10, 20, 30, 255, 255, 0, 255, 255}});  // magenta is transparent
  EXPECT_EQ(count().left_out, all);
  scene.textures[0].rgba[5] = 1;
  EXPECT_EQ(count().equal, all);
  scene.textures[0].rgba[3] = 254;
  EXPECT_EQ(count().left_out, all);
}

TEST(Visibility, RefusesWhatIsNoMatterOfTheNearestDepth) {
  const Config config = shipped_config("depth16");
  const auto refusal = [&](const std::string& key, std::int64_t value) {
    Scene scene = two_that_cut();
    const StateSetting late{*find_state_register("depth.when"), static_cast<std::int64_t>(DepthWhen::late)};
    scene.commands.push_back({1, StateChange{false, {late, {*find_state_register(key), value}}}});
    return visibility_refusal(config, scene);
  };
  EXPECT_EQ(visibility_refusal(config, two_that_cut()), "");
  EXPECT_EQ(refusal("blend.red", 7), "");
  EXPECT_EQ(refusal("depth.func", static_cast<std::int64_t>(DepthFunc::lequal)), "");
  EXPECT_EQ(refusal("depth.func", static_cast<std::int64_t>(DepthFunc::greater)),
            "depth.func: legal for oracles: less, lequal");
  EXPECT_EQ(refusal("depth.bias", 1), "depth.bias: legal for oracles: 0");
  EXPECT_EQ(refusal("depth.write", 0), "depth.write: legal for oracles: true");
  EXPECT_EQ(refusal("color.write", 0), "color.write: legal for oracles: true");
  EXPECT_EQ(refusal("scissor.left", 3), "scissor, stipple: legal for oracles: the whole picture");
  EXPECT_EQ(refusal("stencil.test", 1), "stencil.test: legal for oracles: false");
  EXPECT_EQ(refusal("alpha.func", static_cast<std::int64_t>(CompareFunc::less)),
            "alpha.func: legal for oracles: always");
  EXPECT_EQ(refusal("chroma.test", static_cast<std::int64_t>(ChromaTest::inside)),
            "chroma.test: legal for oracles: none");
  Config dda = config;
  dda.edge_walk = EdgeWalk::dda;
  EXPECT_NE(visibility_refusal(dda, two_that_cut()).find("raster.edge_walk"), std::string::npos);
  Config affine = config;
  affine.perspective = Perspective::affine;
  expect_refusal([&] { stored_depth_bounds(affine, two_that_cut()); }, "perspective.mode");
}

TEST(Visibility, WritesAMap) {
  const TemporaryFolder folder;
  const Config config = shipped_config("depth16");
  const Scene scene = two_that_cut();
  const VisibilityReport report = compared(by_areas, config, scene, drawn_by("model", config, scene));
  write_visibility_map(folder.path("map.png"), report);
  EXPECT_GT(std::filesystem::file_size(folder.path("map.png")), 500U);
}

TEST(Visibility, ParsesLists) {
  const auto judges =
      std::ranges::count_if(oracles(), [](const Oracle& oracle) { return !oracle.draws_lines; });
  EXPECT_EQ(parse_oracles("all").size(), static_cast<std::size_t>(judges));
  expect_refusal([] { parse_oracles("ray tracer"); }, "--oracles: 'ray tracer' is no oracle; legal: all");
  expect_refusal([] { parse_oracles(""); }, "--oracles: '' is no oracle");
}

// Against rationals of any size: points of edges that two triangles share, and distances in many octaves.
TEST(Surface, InverseDistancesCompareExactly) {
  using Rational = boost::multiprecision::cpp_rational;
  using Int = boost::multiprecision::cpp_int;
  const auto integer = [](golden::Wide x) {
    return Int(static_cast<std::int64_t>(x >> 40)) * (Int(1) << 40) +
           Int(static_cast<std::int64_t>(x & ((std::int64_t{1} << 40) - 1)));
  };
  const auto rational = [&](const golden::InverseDistance& q) {
    Rational sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum +=
          Rational(integer(q.part[i])) / (Rational(integer(q.whole)) * Rational(static_cast<double>(q.s[i])));
    }
    return sum;
  };
  const Config config = shipped_config("depth16");
  Random draw(7);
  int equal = 0;
  int close = 0;
  for (int round = 0; round < 400; ++round) {
    const auto corner = [&] {
      return test::At{draw.uniform(0, 64), draw.uniform(0, 48), draw.log_uniform(1e-3, 1e6)};
    };
    const test::At a = corner();
    const test::At b = corner();
    const auto first = ideal_triangle(config, triangle_of(a, b, corner()));
    // Its neighbour across the edge from a to b, the whole of it nearer or farther by next to nothing.
    const double factor = round % 3 == 0 ? 1 : 1 + 0x1p-52 * static_cast<double>(round % 3);
    const auto second =
        ideal_triangle(config, triangle_of({a.x, a.y, a.s * factor}, {b.x, b.y, b.s * factor}, corner()));
    if (!first || !second) continue;
    // The middle of that edge, which is no pixel's centre, in the units of points.
    const golden::Point middle{std::lround(a.x * 16) + std::lround(b.x * 16),
                               std::lround(a.y * 16) + std::lround(b.y * 16)};
    const golden::InverseDistance p = golden::inverse_distance(*first, golden::areas_at(*first, middle));
    const golden::InverseDistance q = golden::inverse_distance(*second, golden::areas_at(*second, middle));
    const Rational x = rational(p);
    const Rational y = rational(q);
    EXPECT_EQ(p < q, x < y);
    EXPECT_EQ(p == q, x == y);
    equal += p == q ? 1 : 0;
    close += p != q && std::abs(p.value - q.value) <= 0x1p-50L * p.value ? 1 : 0;
  }
  // Off by less than the approximate values can tell: an ulp of the distance of the corner that counts least.
  int closest = 0;
  for (int round = 0; round < 400; ++round) {
    const auto corner = [&] {
      return test::At{draw.uniform(0, 64), draw.uniform(0, 48), draw.log_uniform(1, 1e4)};
    };
    const auto t = ideal_triangle(config, triangle_of(corner(), corner(), corner()));
    if (!t) continue;
    golden::for_each_covered(
        *t, config.fill_rule, 64, 48, [&](const golden::Areas& areas, std::int64_t x, std::int64_t y) {
          if ((x + y) % 16 != 0) return;
          const golden::InverseDistance p = golden::inverse_distance(*t, areas);
          const auto share = [&](std::size_t i) { return static_cast<long double>(p.part[i]) / p.s[i]; };
          std::size_t least = 0;
          for (std::size_t i = 1; i < 3; ++i) least = share(i) < share(least) ? i : least;
          if (p.part[least] == 0) return;
          IdealTriangle farther = *t;
          farther.v[least].s = std::nextafter(static_cast<double>(p.s[least]), 1e9);
          const golden::InverseDistance q = golden::inverse_distance(farther, areas);
          EXPECT_TRUE(q < p);
          EXPECT_TRUE(p > q);
          closest += std::abs(p.value - q.value) <= 0x1p-59L * p.value ? 1 : 0;
        });
  }
  EXPECT_GT(closest, 20);
  EXPECT_GT(equal, 100);
  EXPECT_GT(close, 200);
}

}  // namespace
}  // namespace bitspan
