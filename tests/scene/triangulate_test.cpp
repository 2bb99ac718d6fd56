// SPDX-License-Identifier: Apache-2.0
#include "scene/triangulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace bitspan {
namespace {

using Parts = std::vector<std::array<std::uint32_t, 3>>;
using Grid = std::array<std::int64_t, 2>;  // a point with whole coordinates

Parts cut(const std::vector<Vec3>& polygon) {
  Parts parts;
  triangulate(polygon, parts);
  return parts;
}

std::vector<Vec3> in_plane(const std::vector<Grid>& points) {
  std::vector<Vec3> out;
  for (const auto& [x, y] : points) out.push_back({static_cast<double>(x), static_cast<double>(y), 0});
  return out;
}

std::int64_t twice_area(const Grid& a, const Grid& b, const Grid& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
std::int64_t twice_area(const std::vector<Grid>& points) {
  std::int64_t area = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) area += twice_area(points[0], points[i], points[i + 1]);
  return area;
}

// The sum of the triangles' areas is the polygon's, and with `is_simple` none is turned: so each point of the
// polygon is in one triangle. Returns how many triangles have an area.
std::size_t check(const std::vector<Grid>& points, const Parts& parts, bool is_simple) {
  EXPECT_EQ(parts.size(), points.size() - 2);
  const std::int64_t whole = twice_area(points);
  std::int64_t sum = 0;
  std::size_t with_area = 0;
  for (const auto& [a, b, c] : parts) {
    if (std::max({a, b, c}) >= points.size()) {
      ADD_FAILURE() << "no such corner";
      return 0;
    }
    const std::int64_t area = twice_area(points[a], points[b], points[c]);
    EXPECT_TRUE(!is_simple || (whole > 0 ? area : -area) >= 0) << a << ' ' << b << ' ' << c;
    sum += area;
    with_area += area != 0 ? 1 : 0;
  }
  EXPECT_EQ(sum, whole);
  return with_area;
}

// No corner lies inside a side of a triangle, where a crack would open beside the triangles of that corner.
void check_sides(const std::vector<Grid>& points, const Parts& parts) {
  for (const auto& part : parts) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Grid &a = points[part[k]], &b = points[part[(k + 1) % 3]];
      for (const Grid& p : points) {
        const std::int64_t along = (p[0] - a[0]) * (b[0] - p[0]) + (p[1] - a[1]) * (b[1] - p[1]);
        EXPECT_FALSE(twice_area(a, b, p) == 0 && along > 0) << p[0] << ' ' << p[1];
      }
    }
  }
}

// Directions around the origin, counterclockwise, without two of the same angle, at least one per octant.
std::vector<Grid> directions(std::mt19937_64& random) {
  std::vector<Grid> out;
  for (std::int64_t x = -8; x <= 8; ++x) {
    for (std::int64_t y = -8; y <= 8; ++y) {
      const bool is_axis = x * y == 0 || x == y || x == -y;
      const bool is_kept = is_axis ? std::max(std::abs(x), std::abs(y)) == 7 : random() % 4 == 0;
      if (is_kept && x * x + y * y >= 25) out.push_back({x, y});
    }
  }
  const auto angle = [](const Grid& g) {
    return std::atan2(static_cast<double>(g[1]), static_cast<double>(g[0]));
  };
  std::ranges::sort(out, {}, angle);
  const auto same = [](const Grid& a, const Grid& b) {
    return a[0] * b[1] == a[1] * b[0] && a[0] * b[0] + a[1] * b[1] > 0;
  };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
  return out;
}

std::vector<Grid> star(std::mt19937_64& random, const std::vector<Grid>& directions, std::int64_t low,
                       std::int64_t high) {
  std::vector<Grid> out;
  for (const Grid& d : directions) {
    const std::int64_t k = low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low));
    out.push_back({d[0] * k, d[1] * k});
  }
  return out;
}

// A closed tour through random points, freed of crossings: edges that meet are turned around.
std::vector<Grid> tour(std::mt19937_64& random, std::size_t count, std::int64_t size) {
  std::vector<Grid> p;
  while (p.size() < count) {
    const Grid g{static_cast<std::int64_t>(random()) % size, static_cast<std::int64_t>(random()) % size};
    if (std::ranges::find(p, g) == p.end()) p.push_back(g);
  }
  const auto side = [](const Grid& a, const Grid& b, const Grid& c) {
    const std::int64_t area = twice_area(a, b, c);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
  };
  const auto meet = [&](const Grid& a, const Grid& b, const Grid& c, const Grid& d) {
    const auto on = [&](const Grid& u, const Grid& v, const Grid& w) {
      return side(u, v, w) == 0 && std::min(u[0], v[0]) <= w[0] && w[0] <= std::max(u[0], v[0]) &&
             std::min(u[1], v[1]) <= w[1] && w[1] <= std::max(u[1], v[1]);
    };
    if (on(a, b, c) || on(a, b, d) || on(c, d, a) || on(c, d, b)) return true;
    return side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
  };
  for (int round = 0; round < 1000; ++round) {
    bool is_free = true;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 2; j < count && !(i == 0 && j + 1 == count); ++j) {
        if (!meet(p[i], p[i + 1], p[j], p[(j + 1) % count])) continue;
        std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        is_free = false;
      }
    }
    // Neighbours that run back over each other are no simple polygon, either.
    for (std::size_t i = 0; is_free && i < count; ++i) {
      const Grid &a = p[i], &b = p[(i + 1) % count], &c = p[(i + 2) % count];
      if (side(a, b, c) == 0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0) return {};
    }
    if (is_free) return p;
  }
  return {};
}

TEST(Triangulate, ConvexPolygonsBecomeFans) {
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), (Parts{{0, 1, 2}}));
  EXPECT_EQ(cut({{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}}), (Parts{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(cut({{0, 0, 5}, {0, 1, 5}, {1, 1, 5}, {1, 0, 5}}), (Parts{{0, 1, 2}, {0, 2, 3}})) << "turned";
  EXPECT_EQ(cut({{2, 0, 0}, {5, 1, 0}, {6, 4, 0}, {3, 6, 0}, {0, 3, 0}}),
            (Parts{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(Triangulate, ConcaveQuadsAreCutAtTheDent) {
  const std::vector<Grid> dart{{0, 0}, {4, 0}, {1, 1}, {0, 4}};  // the dent is corner 2
  for (std::size_t first = 0; first < 4; ++first) {
    for (const bool is_turned : {false, true}) {
      std::vector<Grid> points = dart;
      std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(first), points.end());
      if (is_turned) std::reverse(points.begin(), points.end());
      EXPECT_EQ(check(points, cut(in_plane(points)), true), 2U);
    }
  }
  // A corner on the line of its neighbours is no corner of a triangle without area.
  const std::vector<Grid> flat{{0, 0}, {2, 0}, {4, 0}, {2, 3}};
  EXPECT_EQ(check(flat, cut(in_plane(flat)), true), 2U);
}

// In every plane, and at every size that doubles have.
TEST(Triangulate, RandomSimplePolygons) {
  std::mt19937_64 random(1);
  std::size_t polygons = 0, concave = 0;
  for (int round = 0; round < 1500; ++round) {
    const std::size_t count = 5 + random() % 26;
    std::vector<Grid> points = round % 3 == 0 ? star(random, directions(random), 1, 9)
                                              : tour(random, count, round % 3 == 1 ? 40 : 8);
    if (points.empty()) continue;
    ++polygons;
    std::vector<Vec3> polygon;
    for (const auto& [x, y] : points) {
      const auto a = static_cast<double>(x), b = static_cast<double>(y);
      const double c = round % 2 == 0 ? 0 : 3 * a - b;
      polygon.push_back(round % 5 < 2 ? Vec3{a, b, c} : round % 5 < 4 ? Vec3{c, a, b} : Vec3{b, c, a});
    }
    const Parts parts = cut(polygon);
    check(points, parts, true);
    check_sides(points, parts);
    concave +=
        std::ranges::any_of(Parts(parts), [&](const auto& t) { return t[0] != 0 && t[1] != 0 && t[2] != 0; })
            ? 1
            : 0;
    if (round % 8 == 0) {  // the exact numbers take long there
      for (const int power : {-1000, -600, 600, 1010}) {
        std::vector<Vec3> scaled;
        for (const Vec3& p : polygon) scaled.push_back(p * std::ldexp(1.0, power));
        EXPECT_EQ(cut(scaled), parts) << power;
      }
    }
    ASSERT_FALSE(HasFailure()) << "polygon " << round;
  }
  EXPECT_GT(polygons, 800U);
  EXPECT_GT(concave, 500U);
}

// As exporters write them: along a bridge to the hole, around it, and back along the bridge.
TEST(Triangulate, HolesThatBridgesJoin) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 300; ++round) {
    const std::vector<Grid> around = directions(random);
    const std::vector<Grid> outer = star(random, around, 40, 60), hole = star(random, around, 1, 4);
    const std::size_t n = around.size(), at = random() % n;
    std::vector<Grid> points;
    for (std::size_t i = 0; i <= n; ++i) points.push_back(outer[(at + i) % n]);
    for (std::size_t i = 0; i <= n; ++i) points.push_back(hole[(at + n - i) % n]);
    std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(random() % points.size()),
                points.end());
    ASSERT_EQ(twice_area(points), twice_area(outer) - twice_area(hole));
    check(points, cut(in_plane(points)), true);
    ASSERT_FALSE(HasFailure()) << "polygon " << round;
  }
  // Two holes, whose bridges begin at one corner of the outline; corners on edges, too.
  const std::vector<Grid> two{{0, 0}, {9, 0}, {9, 5}, {0, 5}, {0, 0}, {1, 1}, {1, 3}, {3, 3},
                              {3, 1}, {1, 1}, {0, 0}, {6, 1}, {6, 3}, {8, 3}, {8, 1}, {6, 1}};
  EXPECT_EQ(twice_area(two), 2 * (45 - 8));
  check(two, cut(in_plane(two)), true);
}

TEST(Triangulate, PolygonsThatAreNoneEnd) {
  EXPECT_EQ(cut(std::vector<Vec3>(7, Vec3{1, 2, 3})).size(), 5U);
  const std::vector<Grid> line{{0, 0}, {1, 1}, {5, 5}, {2, 2}, {2, 2}, {7, 7}};
  check(line, cut(in_plane(line)), true);
  const std::vector<Grid> bow{{0, 0}, {4, 4}, {4, 0}, {0, 4}},
      pentagram{{0, 3}, {4, 3}, {1, 0}, {2, 5}, {3, 0}};
  check(bow, cut(in_plane(bow)), false);
  check(pentagram, cut(in_plane(pentagram)), false);
  std::mt19937_64 random(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<Grid> points(4 + random() % 60);
    for (Grid& p : points) {
      p = {static_cast<std::int64_t>(random() % 6), static_cast<std::int64_t>(random() % 6)};
    }
    const Parts parts = cut(in_plane(points));
    check(points, parts, false);
    EXPECT_EQ(cut(in_plane(points)), parts) << "the same again";
    ASSERT_FALSE(HasFailure()) << "polygon " << round;
  }
}

TEST(Triangulate, DecisionsAreExact) {
  // Corner 2 is a dent by the last bit of a double.
  const double h = std::nextafter(0.3, 0);
  const std::vector<Vec3> dent{{0.1, 0.1, 0}, {0.5, 0.5, 0}, {0.3, h, 0}, {0.5, -1, 0}, {0.1, -1, 0}};
  for (std::size_t first = 0; first < dent.size(); ++first) {
    std::vector<Vec3> polygon = dent;
    std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(first), polygon.end());
    std::vector<std::uint32_t> uses(5);
    for (const auto& [a, b, c] : cut(polygon)) {
      for (const std::uint32_t i : {a, b, c}) ++uses[i];
    }
    const std::size_t corner = (2 + dent.size() - first) % dent.size();
    EXPECT_GE(uses[corner], 2U) << "the dent is no ear";
  }
}

// In time far below the square of the corners, where the polygon is a usual one.
TEST(Triangulate, ManyCorners) {
  const auto n = static_cast<std::int64_t>(polygon_corners_max);
  std::vector<Grid> spiral;
  for (const std::int64_t end : {1, -1}) {
    for (std::int64_t k = 0; k < n / 2; ++k) {
      const std::int64_t i = end > 0 ? k : n / 2 - 1 - k;
      const double angle = 1e-3 * static_cast<double>(i),
                   radius = 1000.0 * static_cast<double>(i + (end > 0 ? 9000 : 7000));
      spiral.push_back({std::llround(radius * std::cos(angle)), std::llround(radius * std::sin(angle))});
    }
  }
  check(spiral, cut(in_plane(spiral)), true);
}

}  // namespace
}  // namespace bitspan
