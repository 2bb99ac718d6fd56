// SPDX-License-Identifier: Apache-2.0
// Delaunay triangulations: empty circles, counts, one result whatever the order, and Voronoi's cells.
#include "scene/generate/delaunay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "tests/support/long_run.hpp"

namespace bitspan {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::vector<GridPoint> random_points(std::mt19937& random, int width, int height, std::size_t count) {
  std::vector<GridPoint> out{{0, 0}, {width, 0}, {width, height}, {0, height}};
  std::set<GridPoint> taken(out.begin(), out.end());
  while (out.size() < count) {
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n + 1)); };
    const GridPoint p{below(width), below(height)};
    if (taken.insert(p).second) out.push_back(p);
  }
  return out;
}

// The sign of the determinant of squares, by long multiplication in four words: another way than the
// product's.
int in_circle_sign(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  __int128 sum = 0;
  const std::array<GridPoint, 3> p{a, b, c};
  const auto x = [&](std::size_t k) { return __int128{p[k % 3].x} - d.x; };
  const auto y = [&](std::size_t k) { return __int128{p[k % 3].y} - d.y; };
  const auto z = [&](std::size_t k) { return x(k) * x(k) + y(k) * y(k); };
  // By rows, each of three terms.
  for (std::size_t k = 0; k < 3; ++k) sum += x(k) * (y(k + 1) * z(k + 2) - z(k + 1) * y(k + 2));
  return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

// What is wrong with a triangulation, "" where nothing is. Circles are looked at across each edge, or against
// every point.
std::string faults_of(const Delaunay& d, bool against_all) {
  const Triangles triangles = d.triangles();
  const auto& p = d.points();
  std::size_t points = 0, on_edge = 0;
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    if (!d.has(i)) continue;
    ++points;
    on_edge += d.is_on_edge(i) ? 1 : 0;
  }
  if (points != d.size() || triangles.size() != d.triangle_count()) return "wrong counts";
  if (triangles.size() != 2 * points - on_edge - 2) return "T is not 2 N - b - 2";
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  __int128 area = 0;
  for (const auto& t : triangles) {
    if (side_of(p[t[0]], p[t[1]], p[t[2]]) <= 0) return "a triangle that is turned over";
    area += (std::int64_t{p[t[1]].x} - p[t[0]].x) * (std::int64_t{p[t[2]].y} - p[t[0]].y) -
            (std::int64_t{p[t[1]].y} - p[t[0]].y) * (std::int64_t{p[t[2]].x} - p[t[0]].x);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!edges.try_emplace({t[k], t[(k + 1) % 3]}, t[(k + 2) % 3]).second) return "an edge twice";
    }
  }
  if (area != __int128{2} * (p[2].x - p[0].x) * (p[2].y - p[0].y)) return "not the rectangle's area";
  std::size_t single = 0;
  for (const auto& [edge, apex] : edges) {
    const auto other = edges.find({edge.second, edge.first});
    if (other == edges.end()) {
      ++single;
    } else if (in_circle_sign(p[edge.first], p[edge.second], p[apex], p[other->second]) > 0) {
      return "a circle that is not empty";
    }
  }
  if (single != on_edge) return "not b edges on the border";
  if ((edges.size() + single) / 2 != 3 * points - on_edge - 3) return "R is not 3 N - b - 3";
  for (const auto& t : triangles) {
    for (std::uint32_t q = 0; against_all && q < p.size(); ++q) {
      if (d.has(q) && in_circle_sign(p[t[0]], p[t[1]], p[t[2]], p[q]) > 0) return "a point in a circle";
    }
  }
  return "";
}

TEST(Delaunay, ThePredicatesAreExact) {
  EXPECT_EQ(side_of({0, 0}, {3, 0}, {1, 1}), 1);
  EXPECT_EQ(side_of({0, 0}, {3, 3}, {2, 2}), 0);
  EXPECT_TRUE(is_in_circle({0, 0}, {4, 0}, {0, 4}, {3, 3}));
  EXPECT_FALSE(is_in_circle({0, 0}, {4, 0}, {0, 4}, {5, 5}));
  // At the ends of the range, a circle and points that are one off.
  constexpr std::int32_t n = grid_point_limit;
  EXPECT_TRUE(is_in_circle({-n, -n}, {n, -n}, {-n, n}, {n - 1, n}));
  EXPECT_TRUE(is_in_circle({-n, -n + 1}, {n, -n}, {-n, n}, {n, n - 1}));
  EXPECT_FALSE(is_in_circle({-n, -n}, {n - 1, -n}, {-n, n - 1}, {n, n}));
  EXPECT_EQ(side_of({-n, -n}, {n, n}, {n - 1, n}), 1);
}

TEST(Delaunay, OfFourPointsOnACircleOneDiagonalIsChosen) {
  constexpr unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  // Squares and rectangles: whichever three are the triangle, the answers go together.
  for (int k = 0; k < 1000; ++k) {
    const auto any = [&] { return static_cast<std::int32_t>(random() % 201) - 100; };
    const GridPoint o{any(), any()}, u{1 + any() / 2 + 50, any()};
    const GridPoint v{-u.y, u.x};
    const auto at = [&](int a, int b) { return GridPoint{o.x + a * u.x + b * v.x, o.y + a * u.y + b * v.y}; };
    const GridPoint a = at(0, 0), b = at(2, 0), c = at(2, 1), d = at(0, 1);
    EXPECT_EQ(is_in_circle(a, b, c, d), is_in_circle(c, d, a, b));
    EXPECT_EQ(is_in_circle(b, c, d, a), is_in_circle(d, a, b, c));
    EXPECT_NE(is_in_circle(a, b, c, d), is_in_circle(b, c, d, a));
  }
}

TEST(Delaunay, CirclesAreEmpty) {
  constexpr unsigned seed = 1;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int k = 0; k < (is_long_run() ? 2000 : 200); ++k) {
    const int width = 1 + static_cast<int>(random() % 40), height = 1 + static_cast<int>(random() % 40);
    const auto samples = static_cast<std::size_t>((width + 1) * (height + 1));
    // From few points to all samples, where almost all circles have more than three.
    Delaunay d(random_points(random, width, height, std::min<std::size_t>(samples, 4 + random() % 200)));
    d.insert_all();
    ASSERT_EQ(faults_of(d, true), "") << width << " x " << height << ", " << d.size();
  }
}

TEST(Delaunay, TheOrderOfThePointsDoesNotMatter) {
  constexpr unsigned seed = 2;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int k = 0; k < 20; ++k) {
    Delaunay sorted(random_points(random, 20, 15, 250)), shuffled(sorted.points());
    sorted.insert_all();
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 4; i < 250; ++i) order.push_back(i);
    std::ranges::shuffle(order, random);
    for (const std::uint32_t i : order) shuffled.insert(i);
    ASSERT_EQ(sorted.triangles(), shuffled.triangles());
  }
}

TEST(Delaunay, APointTakenOutAndPutBackLeavesNoTrace) {
  constexpr unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  // Far apart: in general position. On a small grid: hardly any point is.
  for (const auto& [side, count] : {std::pair{1 << 20, std::size_t{3000}}, std::pair{60, std::size_t{3000}},
                                    std::pair{15, std::size_t{256}}}) {
    Delaunay d(random_points(random, side, side, count));
    d.insert_all();
    const Triangles before = d.triangles();
    for (int k = 0; k < 1000; ++k) {
      const auto point = static_cast<std::uint32_t>(4 + random() % (count - 4));
      d.remove(point);
      if (k % 100 == 0) {
        ASSERT_EQ(faults_of(d, false), "");
      }
      d.insert(point);
    }
    EXPECT_EQ(d.triangles(), before) << side;
    // All at once, in another order than they come back.
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 4; i < count; ++i) order.push_back(i);
    std::ranges::shuffle(order, random);
    order.resize(std::min<std::size_t>(order.size(), 1000));
    for (const std::uint32_t i : order) d.remove(i);
    EXPECT_EQ(faults_of(d, false), "");
    std::ranges::shuffle(order, random);
    for (const std::uint32_t i : order) d.insert(i);
    EXPECT_EQ(d.triangles(), before) << side;
  }
}

TEST(Delaunay, ARemovalSaysWhatItMade) {
  std::mt19937 random(8);
  Delaunay d(random_points(random, 30, 20, 300));
  d.insert_all();
  Triangles hole;
  for (std::uint32_t i = 4; i < 300; ++i) {
    const Triangles before = d.triangles();
    d.remove(i, &hole);
    for (auto& t : hole) std::ranges::rotate(t, std::ranges::min_element(t));
    std::ranges::sort(hole);
    Triangles made;
    std::ranges::set_difference(d.triangles(), before, std::back_inserter(made));
    ASSERT_EQ(hole, made) << i;
  }
}

TEST(Delaunay, TakingAllOutLeavesTheRectangle) {
  std::mt19937 random(4);
  Delaunay d(random_points(random, 12, 9, 100));
  const Triangles empty = d.triangles();
  d.insert_all();
  for (std::uint32_t i = 4; i < 100; ++i) d.remove(i);
  EXPECT_EQ(d.triangles(), empty);
  EXPECT_EQ(d.size(), 4U);
}

TEST(Delaunay, FiftyThousandPoints) {
  std::mt19937 random(5);
  // As many as of a height field, on a grid on which a third of the samples are taken.
  Delaunay d(random_points(random, 402, 343, is_long_run() ? 50'000 : 10'000));
  d.insert_all();
  EXPECT_EQ(faults_of(d, false), "");
}

TEST(Delaunay, WhatIsNoRectangleIsRefused) {
  EXPECT_THROW(Delaunay({{0, 0}, {1, 0}, {1, 1}}), std::invalid_argument);
  EXPECT_THROW(Delaunay({{0, 0}, {1, 0}, {1, 1}, {1, 1}}), std::invalid_argument);
  EXPECT_THROW(Delaunay({{0, 0}, {2, 0}, {2, 2}, {0, 2}, {3, 1}}), std::invalid_argument);
  Delaunay d({{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {1, 1}});
  EXPECT_THROW(d.remove(0), std::invalid_argument);
  EXPECT_THROW(d.remove(4), std::invalid_argument);
  d.insert(4);
  EXPECT_THROW(d.insert(4), std::invalid_argument);
  EXPECT_THROW(d.insert(5), std::invalid_argument);
}

TEST(Voronoi, CellsTileTheRectangleAndHoldWhatIsNearest) {
  constexpr unsigned seed = 6;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int k = 0; k < 10; ++k) {
    Delaunay d(random_points(random, 40, 30, 80));
    d.insert_all();
    const auto& p = d.points();
    double area = 0;
    std::vector<std::array<double, 2>> cell;
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
      voronoi_cell(d, i, cell);
      for (std::size_t c = 0; c < cell.size(); ++c) {
        const auto &a = cell[c], &b = cell[(c + 1) % cell.size()];
        area += (a[0] * b[1] - a[1] * b[0]) / 2;
        // A corner is as far from its point as from the nearest one.
        const auto distance = [&](const GridPoint& q) { return std::hypot(q.x - a[0], q.y - a[1]); };
        for (const GridPoint& q : p) EXPECT_GE(distance(q), distance(p[i]) - 1e-9);
      }
      // Exactly: of all samples, those that are no nearer to a neighbour are no nearer to any point.
      d.neighbours(i, around);
      for (int y = 0; y <= 30; ++y) {
        for (int x = 0; x <= 40; ++x) {
          const auto square = [&](const GridPoint& q) {
            return (q.x - x) * (q.x - x) + (q.y - y) * (q.y - y);
          };
          const bool is_in =
              std::ranges::all_of(around, [&](std::uint32_t n) { return square(p[n]) >= square(p[i]); });
          const bool is_nearest =
              std::ranges::all_of(p, [&](const GridPoint& q) { return square(q) >= square(p[i]); });
          ASSERT_EQ(is_in, is_nearest);
        }
      }
    }
    EXPECT_NEAR(area, 1200, 1e-6);
  }
}

}  // namespace
}  // namespace bitspan
