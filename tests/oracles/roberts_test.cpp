// SPDX-License-Identifier: Apache-2.0
// Edges of convex bodies against values worked by hand, against rays, and against cuts found one by one. [H2]
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "golden/edge_rays.hpp"
#include "report/edges.hpp"
#include "scene/geometry.hpp"
#include "tests/oracles/oracle_support.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using golden::EyePoint;
using Parts = std::vector<std::array<double, 2>>;

const Oracle& roberts() { return test::oracle_named("roberts"); }

// A convex body in the eye's space: its triangles turn any way round.
struct Solid {
  std::vector<Vec3> points;
  std::vector<std::array<std::size_t, 3>> faces;
};

Solid box(std::pair<double, double> x, std::pair<double, double> y, std::pair<double, double> z) {
  Solid out;
  for (const double c : {z.first, z.second}) {
    for (const double b : {y.first, y.second}) {
      for (const double a : {x.first, x.second}) out.points.push_back({a, b, c});
    }
  }
  // Bit 0 of an index is of x, bit 1 of y, bit 2 of z.
  for (const std::size_t axis : {1U, 2U, 4U}) {
    const std::size_t u = axis == 1 ? 2 : 1;
    const std::size_t v = axis == 4 ? 2 : 4;
    for (const std::size_t at : {std::size_t{0}, axis}) {
      out.faces.push_back({at, at + u, at + v});
      out.faces.push_back({at + u, at + v, at + u + v});
    }
  }
  return out;
}
Solid flat(Vec3 a, Vec3 b, Vec3 c) { return {{a, b, c}, {{0, 1, 2}}}; }

Vec3 middle_of(const Solid& solid) {
  Vec3 out;
  for (const Vec3& p : solid.points) out = out + p * (1.0 / static_cast<double>(solid.points.size()));
  return out;
}

// All triangles of points that have all others on one side.
Solid hull_of(std::vector<Vec3> points) {
  Solid out{std::move(points), {}};
  const std::size_t n = out.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vec3 normal = cross(out.points[j] - out.points[i], out.points[k] - out.points[i]);
        int sides = 0;
        for (std::size_t m = 0; m < n; ++m) {
          if (m != i && m != j && m != k) sides |= dot(normal, out.points[m] - out.points[i]) > 0 ? 1 : 2;
        }
        if (sides != 3) out.faces.push_back({i, j, k});
      }
    }
  }
  return out;
}
Solid random_hull(Random& draw) {
  const Vec3 middle{draw.uniform(-3, 3), draw.uniform(-2, 2), draw.uniform(4, 12)};
  const Vec3 radius{draw.uniform(0.3, 1.6), draw.uniform(0.3, 1.6), draw.uniform(0.3, 1.6)};
  std::vector<Vec3> points;
  for (std::int64_t i = draw.integer(6, 13); i > 0; --i) {
    const Vec3 p = of_length_1({draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)});
    points.push_back({middle.x + radius.x * p.x, middle.y + radius.y * p.y, middle.z + radius.z * p.z});
  }
  return hull_of(std::move(points));
}

// The triangles of some bodies; without those that are seen from behind, where they are removed (H1).
Scene scene_of(const std::vector<Solid>& solids, bool removes_back_faces = false) {
  Scene scene = test::scene_of({}, 640, 480);
  for (const Solid& solid : solids) {
    for (const auto& face : solid.faces) {
      const Vec3& a = solid.points[face[0]];
      const Vec3 normal = cross(solid.points[face[1]] - a, solid.points[face[2]] - a);
      if (removes_back_faces && dot(normal, a) * dot(normal, a - middle_of(solid)) > 0) continue;
      Triangle& triangle = scene.triangles.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& p = solid.points[face[i]];
        triangle.v[i].x = 320 + scene.focal * p.x / p.z;
        triangle.v[i].y = 240 + scene.focal * p.y / p.z;
        triangle.v[i].s = p.z;
      }
    }
  }
  return scene;
}

SeenEdges seen_in(const Scene& scene) { return seen_edges(roberts(), shipped_config("depth16"), scene); }
VisibilityReport judged(const Scene& scene, int samples = edge_samples) {
  return edge_report(roberts(), scene, seen_in(scene), samples);
}
double count_of(const SeenEdges& seen, std::string_view name) {
  const auto at = std::ranges::find(seen.counts, name, &OracleCount::name);
  return at == seen.counts.end() ? -1 : at->value;
}
constexpr std::string_view new_edges = "new edges where bodies cut each other";
constexpr std::string_view apart = "of them triangles of what is not convex";

bool is_at(const EyePoint& p, const Vec3& q) {
  return length(p - EyePoint{q.x, q.y, q.z}) < 1e-12L * length(p);
}
// The visible parts of the edge between two points, in shares from a; none where there is no such edge.
std::optional<Parts> parts_between(const SeenEdges& seen, const Vec3& a, const Vec3& b) {
  for (const SeenEdge& edge : seen.edges) {
    if (is_at(edge.end[0], a) && is_at(edge.end[1], b)) return edge.visible;
    if (!is_at(edge.end[0], b) || !is_at(edge.end[1], a)) continue;
    Parts turned;
    for (auto part = edge.visible.rbegin(); part != edge.visible.rend(); ++part) {
      turned.push_back({1 - (*part)[1], 1 - (*part)[0]});
    }
    return turned;
  }
  return std::nullopt;
}
void expect_parts(const std::optional<Parts>& parts, const Parts& expected) {
  ASSERT_TRUE(parts.has_value());
  ASSERT_EQ(parts->size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR((*parts)[i][0], expected[i][0], 1e-11);
    EXPECT_NEAR((*parts)[i][1], expected[i][1], 1e-11);
  }
}

// Three of its faces are seen. The diagonals of its squares are no edges, whichever way triangles turn.
TEST(Roberts, ACubeHidesItsOwnBackEdges) {
  const SeenEdges seen = seen_in(scene_of({box({1, 2}, {1, 2}, {4, 5})}));
  EXPECT_EQ(seen.edges.size(), 12U);
  EXPECT_EQ(count_of(seen, "bodies"), 1);
  EXPECT_EQ(count_of(seen, apart), 0);
  // The corner that is the farthest from the eye is that of the three hidden edges.
  const Vec3 far{2, 2, 5};
  for (const Vec3& hidden : {Vec3{1, 2, 5}, Vec3{2, 1, 5}, Vec3{2, 2, 4}}) {
    expect_parts(parts_between(seen, far, hidden), {});
  }
  EXPECT_EQ(std::ranges::count_if(seen.edges,
                                  [](const SeenEdge& e) {
                                    return e.visible == Parts{{0, 1}};
                                  }),
            9);
}

TEST(Roberts, ACubeInFrontHidesTheMiddleOfAnEdge) {
  // The near face is seen between the slopes -1/2 and 1/2.
  const Solid cube = box({-1, 1}, {-1, 1}, {2, 3});
  const Vec3 a{-10, 0, 10}, b{10, 0, 10}, c{0, 30, 20};
  const SeenEdges seen = seen_in(scene_of({cube, flat(a, b, c)}));
  expect_parts(parts_between(seen, a, b), {{0, 0.25}, {0.75, 1}});
  expect_parts(parts_between(seen, b, a), {{0, 0.25}, {0.75, 1}});
  // In front of the cube nothing is hidden, and the cube's edges are hidden by the triangle then.
  const Vec3 d{-1.25, 0, 1.5}, e{1.25, 0, 1.5}, f{0, 3, 1.5};
  const SeenEdges before = seen_in(scene_of({cube, flat(d, e, f)}));
  expect_parts(parts_between(before, d, e), {{0, 1}});
  const auto lower = parts_between(before, {-1, 1, 2}, {1, 1, 2});
  ASSERT_TRUE(lower.has_value());
  // At y / z = 1/2 the triangle is seen over |x / z| < 0.625.
  expect_parts(lower, {});
  const auto side = parts_between(before, {1, -1, 2}, {1, 1, 2});
  // x / z = 1/2 meets the triangle from y = 0 to y / z = 2 (1 - 0.5 / (1.25 / 1.5)) = 0.8: its lower half.
  expect_parts(side, {{0, 0.5}});
}

TEST(Roberts, AnEdgeMayBeWhollyHidden) {
  const Solid behind = box({-0.5, 0.5}, {-0.5, 0.5}, {6, 7});
  const SeenEdges seen = seen_in(scene_of({box({-2, 2}, {-2, 2}, {3, 4}), behind}));
  int hidden = 0;
  for (const SeenEdge& edge : seen.edges) {
    if (edge.end[0].z > 5) hidden += edge.visible.empty() ? 1 : 0;
  }
  EXPECT_EQ(hidden, 12);
  EXPECT_EQ(count_of(seen, "visible, at least in part"), 4);  // the eye sees one face
}

// The bar's near face, at z = 4.7, goes through the cube's left side, at x = 2.
TEST(Roberts, BodiesThatCutEachOtherHaveNewEdges) {
  const Solid cube = box({2, 4}, {-1, 1}, {4, 6});
  const Solid bar = box({0.5, 6}, {-0.3, 0.3}, {4.7, 5.3});
  for (const bool removes : {false, true}) {
    const SeenEdges seen = seen_in(scene_of({cube, bar}, removes));
    EXPECT_EQ(count_of(seen, new_edges), 1);
    expect_parts(parts_between(seen, {2, -0.3, 4.7}, {2, 0.3, 4.7}), {{0, 1}});
    // It is hidden from there on until it is seen beside the cube's near face, at x / z = 1.
    expect_parts(parts_between(seen, {0.5, 0.3, 4.7}, {6, 0.3, 4.7}), {{0, 1.5 / 5.5}, {4.2 / 5.5, 1}});
  }
}

// The source looks for pierced points on front, side and top faces. Here the bottom of a slab over the eye is
// pierced.
TEST(Roberts, TheBottomOfABodyIsPiercedToo) {
  const Solid slab = box({-3, 3}, {-1.5, -1}, {4, 9});  // y runs down
  const Solid column = box({-0.5, 0.5}, {-1.2, 2}, {6, 7});
  const SeenEdges seen = seen_in(scene_of({slab, column}));
  EXPECT_EQ(count_of(seen, new_edges), 1);
  expect_parts(parts_between(seen, {-0.5, -1, 6}, {0.5, -1, 6}), {{0, 1}});
}

// At many heights, so that roundings put the lower ends of bodies above a floor or below it.
TEST(Roberts, WhatTouchesHidesNothing) {
  for (const double y : {0.5, 0.6, 0.7, 0.73, 0.81, 0.9, 0.97, 1.1, 1.3}) {
    const Solid floor = box({-4, 4}, {y, 1.5}, {3, 12});
    const Solid lower = box({-1, 1}, {0.3, y}, {5.1, 7});
    const Solid upper = box({-1, 0.5}, {-1, 0.3}, {5.1, 6});
    for (const Scene& scene : {scene_of({floor, lower, upper}), scene_of({upper, lower, floor})}) {
      const SeenEdges seen = seen_in(scene);
      EXPECT_EQ(count_of(seen, new_edges), 0);
      EXPECT_EQ(count_of(seen, "bodies"), 3);
      expect_parts(parts_between(seen, {-1, y, 5.1}, {1, y, 5.1}), {{0, 1}});        // on the floor
      expect_parts(parts_between(seen, {-1, 0.3, 5.1}, {0.5, 0.3, 5.1}), {{0, 1}});  // on the lower one
      expect_parts(parts_between(seen, {-1, 0.3, 5.1}, {1, 0.3, 5.1}), {{0, 1}});
      const VisibilityReport report = edge_report(roberts(), scene, seen);
      EXPECT_EQ(report.unexplained, 0U) << report.first;
      EXPECT_GT(report.ties, 16U);  // on a face of another body
    }
  }
}

// The eye sees a point of the edge of the first two, and some of their faces from the side.
TEST(Roberts, BodiesMayTouchInAnEdge) {
  const Scene scene =
      scene_of({box({-1, 0}, {-1, 0}, {4, 5}), box({0, 1}, {0, 1}, {4, 5}), box({-1, 0}, {0, 1}, {5, 6})});
  const SeenEdges seen = seen_in(scene);
  EXPECT_EQ(count_of(seen, "bodies"), 3);
  EXPECT_EQ(count_of(seen, apart), 0);
  EXPECT_EQ(count_of(seen, new_edges), 0);
  EXPECT_EQ(edge_report(roberts(), scene, seen).unexplained, 0U);
}

// Without faces seen from behind, a floor and a wall on it are connected by one edge.
TEST(Roberts, TheCornerOfARoomIsTwoBodies) {
  const Scene scene = scene_of({box({-2, 2}, {1, 1.5}, {4, 6}), box({-2, 2}, {-1, 1}, {6, 6.5})}, true);
  const SeenEdges seen = seen_in(scene);
  EXPECT_EQ(count_of(seen, "bodies"), 2);
  EXPECT_EQ(count_of(seen, apart), 0);
  expect_parts(parts_between(seen, {-2, 1, 6}, {2, 1, 6}), {{0, 1}});
  const VisibilityReport report = edge_report(roberts(), scene, seen);
  EXPECT_EQ(report.unexplained + report.ties, 0U);
}

// The source sorts bodies by their farthest points, and asks of each edge only bodies that are then nearer.
// The long one reaches farther than the cube, and hides it with its near end.
TEST(Roberts, TheOrderOfTheSourceLosesWhatALongBodyHides) {
  const Solid along = box({-1, 1}, {-1, 1}, {2, 20});
  const Solid cube = box({1.5, 3.5}, {-0.5, 0.5}, {8, 9});
  const Scene scene = scene_of({along, cube});
  const VisibilityReport report = judged(scene);
  EXPECT_EQ(report.unexplained, 0U) << report.first;
  EXPECT_GT(report.equal, 200U);
  // The farthest body comes first. Edges of the cube, the last one, meet no other body.
  SeenEdges by_source = seen_in(scene);
  const SeenEdges alone = seen_in(scene_of({cube}));
  for (SeenEdge& edge : by_source.edges) {
    if (edge.on.front() < static_cast<std::int32_t>(along.faces.size())) continue;
    for (const SeenEdge& same : alone.edges) {
      if (length(edge.end[0] - same.end[0]) + length(edge.end[1] - same.end[1]) == 0) {
        edge.visible = same.visible;
      }
    }
  }
  EXPECT_GT(edge_report(roberts(), scene, by_source).unexplained, 50U);
}

TEST(Roberts, WhatIsNoConvexBodyFallsApart) {
  // An open box, seen from above: the eye sees its inner side.
  Solid open = box({-1, 1}, {1, 2}, {4, 5});
  std::erase_if(open.faces, [&](const auto& face) {
    return std::ranges::all_of(face, [&](std::size_t i) { return open.points[i].y == 1; });
  });
  ASSERT_EQ(open.faces.size(), 10U);
  const Scene scene = scene_of({open});
  const SeenEdges seen = seen_in(scene);
  EXPECT_EQ(count_of(seen, apart), 8);  // the far wall is a body
  EXPECT_EQ(seen.edges.size(), 12U);    // the diagonals are no edges
  EXPECT_EQ(judged(scene).unexplained, 0U);
  // A triangle with two sides, and a fold.
  const Vec3 a{-1, 0, 4}, b{1, 0, 4}, c{0, 1, 4}, d{0.2, 1.5, 4};
  EXPECT_EQ(count_of(seen_in(scene_of({{{a, b, c}, {{0, 1, 2}, {0, 2, 1}}}})), apart), 2);
  EXPECT_EQ(count_of(seen_in(scene_of({{{a, b, c, d}, {{0, 1, 2}, {0, 1, 3}}}})), apart), 2);
}

// What the eye sees does not depend on faces that it does not see.
TEST(Roberts, BackFacesAreNotNeeded) {
  constexpr std::uint64_t seed = 61;
  Random draw(seed);
  std::size_t compared = 0;
  for (int round = 0; round < 20; ++round) {
    std::vector<Solid> solids;
    for (int i = 0; i < 6; ++i) solids.push_back(random_hull(draw));
    const SeenEdges whole = seen_in(scene_of(solids));
    const SeenEdges front = seen_in(scene_of(solids, true));
    EXPECT_EQ(count_of(whole, apart), 0) << "round " << round;
    EXPECT_EQ(count_of(front, apart), 0) << "round " << round;
    EXPECT_EQ(count_of(whole, new_edges), count_of(front, new_edges)) << "round " << round;
    for (const SeenEdge& edge : front.edges) {
      const auto same = std::ranges::find_if(whole.edges, [&](const SeenEdge& e) {
        return std::min(length(e.end[0] - edge.end[0]) + length(e.end[1] - edge.end[1]),
                        length(e.end[0] - edge.end[1]) + length(e.end[1] - edge.end[0])) < 1e-12L;
      });
      ASSERT_NE(same, whole.edges.end()) << "round " << round;
      const auto total = [](const SeenEdge& e) {
        double sum = 0;
        for (const auto& part : e.visible) sum += part[1] - part[0];
        return sum;
      };
      EXPECT_NEAR(total(*same), total(edge), 1e-9) << "round " << round;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1500U);
}

// Of all pairs of triangles of two bodies: where they cut each other and a ray gets there, there is a new
// edge.
TEST(Roberts, NewEdgesAreAllThereAre) {
  constexpr std::uint64_t seed = 62;
  Random draw(seed);
  std::size_t found = 0;
  std::size_t hidden = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<Solid> solids;
    for (int i = 0; i < 6; ++i) solids.push_back(random_hull(draw));
    const Scene scene = scene_of(solids);
    const SeenEdges seen = seen_in(scene);
    const golden::EdgeRays rays(scene, seen.triangles);
    std::vector<std::size_t> body_of;
    for (std::size_t s = 0; s < solids.size(); ++s) body_of.insert(body_of.end(), solids[s].faces.size(), s);
    const auto corner = [&](std::size_t t, std::size_t i) {
      return golden::eye_point(scene.triangles[t].v[i % 3], scene);
    };
    // Where the sides of triangle t pierce triangle u, by the signs of volumes.
    const auto pierced = [&](std::size_t t, std::size_t u, std::vector<EyePoint>& out) {
      const auto volume = [](const EyePoint& a, const EyePoint& b, const EyePoint& c, const EyePoint& d) {
        return dot(cross(b - a, c - a), d - a);
      };
      for (std::size_t i = 0; i < 3; ++i) {
        const EyePoint p = corner(t, i), q = corner(t, i + 1);
        const long double at_p = volume(corner(u, 0), corner(u, 1), corner(u, 2), p);
        const long double at_q = volume(corner(u, 0), corner(u, 1), corner(u, 2), q);
        if ((at_p > 0) == (at_q > 0)) continue;
        int sides = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          sides |= volume(p, q, corner(u, k), corner(u, k + 1)) > 0 ? 1 : 2;
        }
        if (sides != 3) out.push_back(p + (q - p) * (at_p / (at_p - at_q)));
      }
    };
    for (std::size_t t = 0; t < body_of.size(); ++t) {
      for (std::size_t u = t + 1; u < body_of.size(); ++u) {
        if (body_of[t] == body_of[u]) continue;
        std::vector<EyePoint> ends;
        pierced(t, u, ends);
        pierced(u, t, ends);
        if (ends.size() != 2) continue;
        const std::array<std::int32_t, 2> on{static_cast<std::int32_t>(t), static_cast<std::int32_t>(u)};
        for (const double share : {0.1, 0.37, 0.5, 0.81}) {
          const EyePoint p = ends[0] + (ends[1] - ends[0]) * share;
          if (rays.at(p, on) != golden::Sight::seen) {
            ++hidden;
            continue;
          }
          const bool is_drawn = std::ranges::any_of(seen.edges, [&](const SeenEdge& edge) {
            if (!std::ranges::equal(edge.on, on)) return false;
            const EyePoint along = edge.end[1] - edge.end[0];
            const auto at = static_cast<double>(dot(p - edge.end[0], along) / dot(along, along));
            const bool is_visible = std::ranges::any_of(
                edge.visible, [&](const auto& part) { return part[0] - 1e-9 <= at && at <= part[1] + 1e-9; });
            return is_visible && length(edge.end[0] + along * at - p) < 1e-9L * length(p);
          });
          EXPECT_TRUE(is_drawn) << "seed " << seed << ", round " << round << ", triangles " << t << ", " << u;
          ++found;
        }
      }
    }
  }
  EXPECT_GT(found, 300U);
  EXPECT_GT(hidden, 800U);
}

// 10^6 points of edges of bodies in random places, many of which cut each other; 10^4 in the gate.
TEST(Roberts, RaysAgree) {
  const std::uint64_t points = is_long_run() ? 1000000 : 10000;
  const std::uint64_t first_seed = 1001;
  VisibilityReport all;
  std::uint64_t seed = first_seed;
  double cuts = 0;
  for (; all.compared() < points; ++seed) {
    Random draw(seed);
    std::vector<Solid> solids;
    for (std::int64_t i = draw.integer(2, 9); i > 0; --i) solids.push_back(random_hull(draw));
    solids.push_back(box({draw.uniform(-3, 0), draw.uniform(0, 3)}, {1, 2}, {4, draw.uniform(5, 12)}));
    const Scene scene = scene_of(solids, draw.chance(0.5));
    const SeenEdges seen = seen_in(scene);
    EXPECT_EQ(count_of(seen, apart), 0) << "seed " << seed;
    const VisibilityReport report = edge_report(roberts(), scene, seen, 4);
    EXPECT_EQ(report.unexplained, 0U) << "seed " << seed << ": " << report.first;
    all.equal += report.equal;
    all.ties += report.ties;
    all.unexplained += report.unexplained;
    cuts += count_of(seen, new_edges);
  }
  printf(
      "roberts, %llu random scenes, seeds from %llu: %llu points of edges equal, %llu near a crossing, %llu "
      "unexplained, %.0f new edges\n",
      static_cast<unsigned long long>(seed - first_seed), static_cast<unsigned long long>(first_seed),
      static_cast<unsigned long long>(all.equal), static_cast<unsigned long long>(all.ties),
      static_cast<unsigned long long>(all.unexplained), cuts);
  EXPECT_LT(all.ties, all.equal / 1000);
  EXPECT_GT(cuts, 50);
}

// Triangles of a mesh that is not convex, and random triangles that cut each other.
TEST(Roberts, RaysAgreeWhereNothingIsConvex) {
  const VisibilityReport spot = judged(test::spot(160, 120), 4);
  EXPECT_EQ(spot.unexplained, 0U) << spot.first;
  EXPECT_GT(spot.equal, 15000U);
  EXPECT_LT(spot.ties, spot.equal / 100);
  std::uint64_t equal = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const VisibilityReport report = judged(test::random_opaque_scene(seed));
    EXPECT_EQ(report.unexplained, 0U) << "seed " << seed << ": " << report.first;
    equal += report.equal;
  }
  EXPECT_GT(equal, 20000U);
}

TEST(Roberts, APartThatIsTooLongOrMissingIsFound) {
  const Scene scene = scene_of({box({-1, 1}, {-1, 1}, {2, 3}), flat({-10, 0, 10}, {10, 0, 10}, {0, 30, 20})});
  const SeenEdges right = seen_in(scene);
  ASSERT_TRUE(edge_report(roberts(), scene, right).held());
  const auto cut = static_cast<std::size_t>(
      std::ranges::find_if(right.edges, [](const SeenEdge& e) { return e.visible.size() == 2; }) -
      right.edges.begin());
  ASSERT_LT(cut, right.edges.size());
  const auto unexplained = [&](auto change) {
    SeenEdges wrong = right;
    change(wrong.edges[cut].visible);
    const VisibilityReport report = edge_report(roberts(), scene, wrong);
    EXPECT_EQ(report.held(), report.unexplained == 0);
    if (!report.held()) {
      EXPECT_NE(report.first.find("of an edge of triangle "), std::string::npos) << report.first;
    }
    return report.unexplained;
  };
  EXPECT_EQ(unexplained([](Parts&) {}), 0U);
  EXPECT_GT(unexplained([](Parts& parts) { parts[0][1] += 2e-6; }), 0U);
  EXPECT_GT(unexplained([](Parts& parts) { parts[1][0] += 2e-6; }), 0U);
  EXPECT_GT(unexplained([](Parts& parts) { parts.pop_back(); }), 2U);
  EXPECT_GT(unexplained([](Parts& parts) { parts = {{0, 1}}; }), 2U);
}

// Points a little in front of what the oracle ray sees through pixels' centres, and a little behind it.
TEST(EdgeRays, SeeWhatTheOracleRaySees) {
  const Config config = shipped_config("depth16");
  std::size_t seen = 0;
  std::size_t hidden = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Scene scene = test::random_opaque_scene(seed);
    for (Triangle& triangle : scene.triangles) {  // onto the grid of the snap
      for (Vertex& v : triangle.v) {
        v.x = std::round(16 * v.x) / 16;
        v.y = std::round(16 * v.y) / 16;
      }
    }
    const std::vector<Visible> picture = test::picture_of("ray", config, scene);
    std::vector<std::int32_t> all;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) all.push_back(static_cast<std::int32_t>(i));
    const golden::EdgeRays rays(scene, all);
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const Visible& at = picture[static_cast<std::size_t>(y * scene.width + x)];
        const double distance = at.triangle < 0 ? scene.s_max : static_cast<double>(1 / at.q.value);
        const auto sight = [&](double factor) {
          return rays.at(golden::eye_point({x + 0.5, y + 0.5, distance * factor}, scene), {});
        };
        if (sight(1 - 1e-6) == golden::Sight::near) continue;  // beside a side
        EXPECT_EQ(sight(1 - 1e-6), golden::Sight::seen) << "seed " << seed << " at " << x << ", " << y;
        if (at.triangle < 0) continue;
        hidden += sight(1 + 1e-6) == golden::Sight::hidden ? 1 : 0;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 5000U);
  EXPECT_GT(hidden, seen * 99 / 100);
}

}  // namespace
}  // namespace bitspan
