// SPDX-License-Identifier: Apache-2.0
#include "scene/clip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "config/config.hpp"
#include "scene/project.hpp"
#include "scene/random.hpp"

namespace bitspan {
namespace {

const ClipVolume volume{1, 1, 1, 100};

ClipVertex random_vertex(Random& random) {
  ClipVertex p;
  p.s = random.uniform(-20, 130);
  p.x = random.uniform(-160, 160);
  p.y = random.uniform(-160, 160);
  // Attributes that are linear in space, so that any point can be checked.
  p.u = 3 * p.x - p.y + 0.5 * p.s + 7;
  p.v = p.y - 2 * p.s;
  p.c = {p.x / 400 + 0.5, p.y / 400 + 0.5, p.s / 400 + 0.5, 1};
  p.fog = p.y / 500 + 0.5;
  return p;
}

Vec3 at(const ClipVertex& p) { return {p.x, p.y, p.s}; }

double area(const std::vector<ClipVertex>& polygon) {
  Vec3 sum;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum = sum + cross(at(polygon[i - 1]) - at(polygon[0]), at(polygon[i]) - at(polygon[0]));
  }
  return length(sum) / 2;
}

std::uint8_t codes(const std::vector<ClipVertex>& polygon) {
  unsigned any = 0;
  for (const ClipVertex& p : polygon) any |= outcode(p, volume);
  return static_cast<std::uint8_t>(any);
}

TEST(Clip, OutcodesNameThePlanes) {
  const auto code = [](double x, double y, double s) {
    return static_cast<int>(outcode({x, y, s, 0, 0, {}}, volume));
  };
  EXPECT_EQ(code(0, 0, 10), 0);
  EXPECT_EQ(code(-11, 0, 10), clip_left);
  EXPECT_EQ(code(11, 0, 10), clip_right);
  EXPECT_EQ(code(0, -11, 10), clip_top);
  EXPECT_EQ(code(0, 11, 10), clip_bottom);
  EXPECT_EQ(code(0, 0, 0.5), clip_near);
  EXPECT_EQ(code(0, 0, 101), clip_far);
  EXPECT_EQ(code(11, 11, 10), clip_right | clip_bottom);
  EXPECT_EQ(code(10, -10, 10), 0) << "the boundary is inside";
  EXPECT_EQ(code(0, 0, 1), 0);
  EXPECT_EQ(code(0, 0, 100), 0);
  EXPECT_EQ(code(0, 0, -5), clip_left | clip_right | clip_top | clip_bottom | clip_near)
      << "behind the viewer";
}

TEST(Clip, ResultLiesInsideAndKeepsLinearAttributes) {
  Random random(11);
  int cut = 0, kept = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<ClipVertex> polygon{random_vertex(random), random_vertex(random), random_vertex(random)};
    const std::uint8_t planes = codes(polygon);
    clip_polygon(polygon, volume, planes);
    if (polygon.empty()) continue;
    ++kept;
    cut += planes != 0;
    for (const ClipVertex& p : polygon) {
      ASSERT_GE(p.s, volume.s_min);
      ASSERT_LE(p.s, volume.s_max);
      ASSERT_LE(std::fabs(p.x), p.s * (1 + 1e-12));
      ASSERT_LE(std::fabs(p.y), p.s * (1 + 1e-12));
      ASSERT_NEAR(p.u, 3 * p.x - p.y + 0.5 * p.s + 7, 1e-9);
      ASSERT_NEAR(p.v, p.y - 2 * p.s, 1e-9);
      ASSERT_NEAR(p.c[0], p.x / 400 + 0.5, 1e-12);
      ASSERT_EQ(p.c[3], 1);
      ASSERT_NEAR(p.fog, p.y / 500 + 0.5, 1e-12);
    }
    ASSERT_LE(polygon.size(), 9U);
  }
  EXPECT_GT(kept, 3000);
  EXPECT_GT(cut, 3000);
}

// Each plane splits a polygon in two; their areas add up to the whole.
TEST(Clip, NothingIsLostAtAPlane) {
  Random random(12);
  int split = 0;
  for (int i = 0; i < 5000; ++i) {
    std::vector<ClipVertex> inner;
    for (int k = 0; k < 3; ++k) inner.push_back(random_vertex(random));
    std::vector<ClipVertex> outer = inner;
    const double whole = area(inner);
    clip_polygon(inner, {1e9, 1e9, 30, 1e9}, clip_near);
    clip_polygon(outer, {1e9, 1e9, -1e9, 30}, clip_far);
    split += !inner.empty() && !outer.empty();
    ASSERT_NEAR(area(inner) + area(outer), whole, 1e-9 * whole + 1e-9);
  }
  EXPECT_GT(split, 1000);
}

TEST(Clip, InsideIsUntouched) {
  std::vector<ClipVertex> polygon{{-5, 0, 10, 1, 2, {}}, {5, 1, 20, 3, 4, {}}, {0, -9, 10, 5, 6, {}}};
  const auto before = polygon;
  EXPECT_EQ(codes(polygon), 0);
  clip_polygon(polygon, volume, 63);
  ASSERT_EQ(polygon.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(at(polygon[i]), at(before[i]));
}

// The edge of two neighbours is walked in opposite directions, and is cut in the same points, bit for bit.
TEST(Clip, NeighboursShareTheirCuts) {
  Random random(13);
  int cuts = 0;
  for (int i = 0; i < 5000; ++i) {
    const ClipVertex a = random_vertex(random), b = random_vertex(random);
    const ClipVertex c = random_vertex(random), d = random_vertex(random);
    const auto cut_points = [&](std::vector<ClipVertex> polygon) {
      clip_polygon(polygon, {1e9, 1e9, 20, 60}, clip_near | clip_far);
      std::vector<Vec3> points;
      for (const ClipVertex& p : polygon) {
        // On the line from a to b?
        const Vec3 n = cross(at(p) - at(a), at(b) - at(a));
        if (length(n) < 1e-8 * length(at(b) - at(a))) points.push_back(at(p));
      }
      std::sort(points.begin(), points.end(), [](const Vec3& p, const Vec3& q) { return p.z < q.z; });
      return points;
    };
    const auto left = cut_points({a, b, c});
    const auto right = cut_points({b, a, d});
    ASSERT_EQ(left, right);
    cuts += left.size() == 2 && (a.s < 20 || b.s < 20 || a.s > 60 || b.s > 60);
  }
  EXPECT_GT(cuts, 1000);
}

Viewpoint view() {
  Viewpoint v;
  v.width = 200;
  v.height = 100;
  v.focal = 150;
  v.s_min = 2;
  v.s_max = 50;
  look_at(v, {0, 0, 0}, {0, 0, -1}, {0, 1, 0});
  return v;
}

std::vector<Triangle> projected(const std::vector<Face>& faces, const ProjectOptions& options,
                                ProjectReport& report) {
  std::vector<Triangle> triangles;
  project(faces, view(), options, triangles, report);
  return triangles;
}

Corner corner(double x, double y, double z) { return {{x, y, z}, x * 3, z, {1, 1, 1, 1}}; }

TEST(Project, PositionsAndDepth) {
  ProjectReport report;
  const auto t =
      projected({{{corner(0, 0, -10), corner(1, 0, -10), corner(0, 1, -20)}, 3, false}}, {}, report);
  ASSERT_EQ(t.size(), 1U);
  EXPECT_EQ(t[0].texture, 3);
  EXPECT_DOUBLE_EQ(t[0].v[0].x, 100);
  EXPECT_DOUBLE_EQ(t[0].v[0].y, 50);
  EXPECT_DOUBLE_EQ(t[0].v[0].s, 10);
  EXPECT_DOUBLE_EQ(t[0].v[1].x, 115) << "+x is right";
  EXPECT_DOUBLE_EQ(t[0].v[1].u, 3);
  EXPECT_DOUBLE_EQ(t[0].v[2].y, 50 - 7.5) << "+y is up";
  EXPECT_DOUBLE_EQ(t[0].v[2].s, 20);
}

TEST(Project, TheFogsFactorIsLinearInSpace) {
  Face face{{corner(0, 0, -1), corner(1, 0, -3), corner(0, 1, -3)}, -1, false};
  face.corner[0].fog = 0;
  face.corner[1].fog = face.corner[2].fog = 1;
  ProjectReport report;
  const auto t = projected({face}, {}, report);  // s_min is 2: half way
  ASSERT_EQ(t.size(), 2U);
  int cut = 0;
  for (const Triangle& triangle : t) {
    for (const Vertex& v : triangle.v) {
      EXPECT_EQ(v.fog, v.s == 2 ? 0.5 : 1);
      cut += v.s == 2;
    }
  }
  EXPECT_EQ(cut, 3);
  for (Corner& c : face.corner) c.fog = -1;
  const auto without = projected({face}, {}, report);
  for (const Vertex& v : without[0].v) EXPECT_EQ(v.fog, -1) << "not given";
}

TEST(Project, CullsBackFacesOnly) {
  const Face front{{corner(0, 0, -10), corner(1, 0, -10), corner(0, 1, -10)}, -1, false};
  const Face back{{corner(0, 0, -10), corner(0, 1, -10), corner(1, 0, -10)}, -1, false};
  Face sheet = back;
  sheet.two_sided = true;
  const Face edge_on{{corner(0, 0, -10), corner(0, 0, -20), corner(0, 1, -10)}, -1, false};
  ProjectReport report;
  EXPECT_EQ(projected({front, back, sheet, edge_on}, {}, report).size(), 2U);
  EXPECT_EQ(report.faces, 4U);
  EXPECT_EQ(report.culled, 2U);
  EXPECT_EQ(report.triangles, 2U);
  ProjectReport all;
  EXPECT_EQ(projected({front, back, sheet, edge_on}, {.cull = false, .clip_sides = true}, all).size(), 3U);
  EXPECT_EQ(all.culled, 0U);
  EXPECT_EQ(all.dropped, 1U) << "edge on: no area on the screen";
  EXPECT_EQ(all.drawn, 3U);
}

// The faces of the convex hull of integer points, as far as they are triangles.
using Point = std::array<std::int64_t, 3>;
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
// Six times the volume over the triangle a, b, c; positive where p is on the side that they run clockwise on.
std::int64_t volume_over(const Point& a, const Point& b, const Point& c, const Point& p) {
  const Point u = minus(b, a), v = minus(c, a), w = minus(p, a);
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
         w[2] * (u[0] * v[1] - u[1] * v[0]);
}
std::vector<std::array<Point, 3>> hull(const std::vector<Point>& points) {
  std::vector<std::array<Point, 3>> out;
  for (const Point& a : points) {
    for (const Point& b : points) {
      for (const Point& c : points) {
        // Each face once: a is its first point. The others lie below, so that it is seen counter-clockwise.
        if (a == b || b == c || a == c || b < a || c < a) continue;
        const bool is_face = std::ranges::all_of(points, [&](const Point& p) {
          return p == a || p == b || p == c || volume_over(a, b, c, p) < 0;
        });
        if (is_face) out.push_back({a, b, c});
      }
    }
  }
  return out;
}

// B5: of a convex body a face is seen from A where the line to a point B inside meets its plane between both.
TEST(Project, CullsTheFacesThatAnInnerPointHides) {
  Random random(17);
  int seen_faces = 0, hidden = 0;
  for (int body = 0; body < 1000; ++body) {
    std::vector<Point> points;
    for (int i = 0; i < 8; ++i) {
      points.push_back({random.integer(-20, 20), random.integer(-20, 20), random.integer(-20, 20)});
    }
    const Point a{random.integer(-60, 60), random.integer(-60, 60), random.integer(24, 60)};
    Point b{};  // eight times the middle
    for (const Point& p : points) {
      for (std::size_t i = 0; i < 3; ++i) b[i] += p[i];
    }
    for (const std::array<Point, 3>& face : hull(points)) {
      // On which sides the two are, in exact volumes; that of the inner one eight times as large.
      const std::int64_t outer = volume_over(face[0], face[1], face[2], a);
      std::array<Point, 3> scaled = face;
      for (Point& p : scaled) p = {8 * p[0], 8 * p[1], 8 * p[2]};
      const std::int64_t inner = volume_over(scaled[0], scaled[1], scaled[2], b);
      ASSERT_LT(inner, 0) << "inside";
      const bool meets_between = outer > 0;  // a plane through A itself, or beside both, is not between
      Viewpoint from;
      from.s_min = 1e-3;
      const auto at = [](const Point& p) {
        return Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
      };
      look_at(from, at(a), {0, 0, 0}, {0, 1, 0});
      Face drawn;
      for (std::size_t i = 0; i < 3; ++i) drawn.corner[i].position = at(face[i]);
      ProjectReport report;
      std::vector<Triangle> triangles;
      project({&drawn, 1}, from, {}, triangles, report);
      ASSERT_EQ(report.culled, meets_between ? 0U : 1U) << "body " << body;
      ++(meets_between ? seen_faces : hidden);
    }
  }
  EXPECT_GT(seen_faces, 3000);
  EXPECT_GT(hidden, 3000);
}

TEST(Project, CountsAndBounds) {
  Random random(14);
  for (const bool clip_sides : {true, false}) {
    std::vector<Face> faces;
    for (int i = 0; i < 4000; ++i) {
      Face face;
      for (Corner& c : face.corner) {
        c = corner(random.uniform(-40, 40), random.uniform(-30, 30), random.uniform(-60, 10));
      }
      faces.push_back(face);
    }
    ProjectReport report;
    const auto triangles = projected(faces, {.cull = false, .clip_sides = clip_sides}, report);
    EXPECT_EQ(report.faces, 4000U);
    EXPECT_EQ(report.triangles, triangles.size());
    EXPECT_GT(report.outside, 20U);
    EXPECT_GT(report.clipped, 1000U);
    const double reach = clip_sides ? 0 : 16384;
    bool beyond = false;
    for (const Triangle& t : triangles) {
      for (const Vertex& v : t.v) {
        ASSERT_GE(v.s, 2);
        ASSERT_LE(v.s, 50);
        ASSERT_LE(std::fabs(v.x - 100), (clip_sides ? 100 : reach) + 1e-6);
        ASSERT_LE(std::fabs(v.y - 50), (clip_sides ? 50 : reach) + 1e-6);
        beyond = beyond || v.x < -1;
      }
    }
    EXPECT_EQ(beyond, !clip_sides);
  }
}

// A big quad of two triangles, cut on all sides: its pieces cover the screen exactly once.
TEST(Project, PiecesOfACutFaceTileTheScreen) {
  const Corner a = corner(-90, -40, -5), b = corner(90, -40, -6), c = corner(80, 45, -40),
               d = corner(-85, 50, -45);
  for (const bool clip_sides : {true, false}) {
    ProjectReport report;
    const auto triangles = projected({{{a, b, c}, -1, false}, {{a, c, d}, -1, false}},
                                     {.cull = false, .clip_sides = clip_sides}, report);
    ASSERT_FALSE(triangles.empty());
    int missing = 0, doubles = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 200; ++x) {
        int hits = 0;
        const double px = x + 0.5 + 1e-4, py = y + 0.5 + 2e-4;  // off every edge
        for (const Triangle& t : triangles) {
          int sides = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const Vertex &p = t.v[k], &q = t.v[(k + 1) % 3];
            sides += (q.x - p.x) * (py - p.y) - (q.y - p.y) * (px - p.x) > 0 ? 1 : -1;
          }
          hits += sides == 3 || sides == -3;
        }
        missing += hits == 0;
        doubles += hits > 1;
      }
    }
    EXPECT_EQ(doubles, 0);
    EXPECT_LT(missing, 200 * 100 / 4) << "most of the screen is covered";
  }
}

TEST(Transform, ImpossibleCameras) {
  Viewpoint v;
  EXPECT_THROW(look_at(v, {1, 2, 3}, {1, 2, 3}, {0, 1, 0}), InputError);
  EXPECT_THROW(look_at(v, {0, 0, 0}, {0, 5, 0}, {0, 1, 0}), InputError);
  EXPECT_THROW(look_at(v, {0, 0, 0}, {0, 5, 0}, {0, 0, 0}), InputError);
}

TEST(Transform, AxesAreOrthonormal) {
  Viewpoint v;
  look_at(v, {1, 2, 3}, {-4, 0, 9}, {0.1, 1, 0.3});
  EXPECT_NEAR(length(v.right), 1, 1e-15);
  EXPECT_NEAR(length(v.down), 1, 1e-15);
  EXPECT_NEAR(length(v.forward), 1, 1e-15);
  EXPECT_NEAR(dot(v.right, v.down), 0, 1e-15);
  EXPECT_NEAR(dot(v.right, v.forward), 0, 1e-15);
  EXPECT_NEAR(dot(v.down, v.forward), 0, 1e-15);
  EXPECT_LT(v.down.y, 0);
}

// More faces than a chunk has, against few at a time.
TEST(Project, ManyFacesAreProjectedAsFewAre) {
  std::vector<Face> faces;
  Random random(5);
  for (int i = 0; i < 50000; ++i) {
    const auto any = [&] {
      return corner(random.uniform(-30, 30), random.uniform(-20, 20), random.uniform(-40, 5));
    };
    faces.push_back({{any(), any(), any()}, i % 7, i % 5 == 0});
  }
  const ProjectOptions options{.cull = true, .clip_sides = false};
  ProjectReport many, few;
  const std::vector<Triangle> at_once = projected(faces, options, many);
  std::vector<Triangle> in_parts;
  constexpr std::size_t part = 1000;
  for (std::size_t at = 0; at < faces.size(); at += part) {
    project(std::span(faces).subspan(at, part), view(), options, in_parts, few);
  }
  EXPECT_EQ(many, few);
  EXPECT_GT(many.culled, 10000U);
  EXPECT_GT(many.outside, 100U);
  EXPECT_GT(many.clipped, 1000U);
  const auto values = [](const std::vector<Triangle>& triangles) {
    std::vector<double> out;
    for (const Triangle& t : triangles) {
      for (const Vertex& v : t.v) out.insert(out.end(), {v.x, v.y, v.s, v.u, v.v, v.c[0]});
      out.push_back(t.texture);
    }
    return out;
  };
  EXPECT_EQ(values(at_once), values(in_parts));
}

}  // namespace
}  // namespace bitspan
