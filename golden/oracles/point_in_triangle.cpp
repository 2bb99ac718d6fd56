// SPDX-License-Identifier: Apache-2.0
// Three tests of a point in a triangle, each by the same brute force: at every pixel the nearest triangle
// whose test holds. All are exact, in integers. On an edge the fill rule decides. [B7]
#include <algorithm>
#include <array>

#include "golden/oracle.hpp"

namespace bitspan {

namespace {

using golden::Point;
using golden::Wide;

enum class Place : std::uint8_t { outside, edge, inside };

// Where the point is, by three numbers that are all positive inside, and of which one is 0 on an edge.
Place place_by(const std::array<Wide, 3>& inwards) {
  const Wide least = std::min({inwards[0], inwards[1], inwards[2]});
  return least > 0 ? Place::inside : least == 0 ? Place::edge : Place::outside;
}

Wide cross(Point a, Point b) { return Wide(a.x) * b.y - Wide(a.y) * b.x; }
Point minus(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
std::array<Point, 3> corners_of(const IdealTriangle& t) {
  return {golden::point_of(t.v[0]), golden::point_of(t.v[1]), golden::point_of(t.v[2])};
}

// The equations of the three lines, their normals turned so that the triangle is on the negative side of
// each: the third vertex says which side that is.
Place by_half_planes(const IdealTriangle& t, Point p) {
  const std::array<Point, 3> v = corners_of(t);
  std::array<Wide, 3> inwards{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = v[i];
    const Point b = v[(i + 1) % 3];
    Point normal{b.y - a.y, a.x - b.x};
    const auto line = [&](Point at) { return Wide(normal.x) * (at.x - a.x) + Wide(normal.y) * (at.y - a.y); };
    if (line(v[(i + 2) % 3]) > 0) normal = {-normal.x, -normal.y};
    inwards[i] = -line(p);
  }
  return place_by(inwards);
}

// The plane is moved so that the point is the origin, and then turned so that one vertex after the other
// lies on the axis of x. Each time the y of the two others differ in sign. Turned, and stretched by the
// vertex's distance, the y of w is cross(vertex, w): no sine is needed.
Place by_rotations(const IdealTriangle& t, Point p) {
  const std::array<Point, 3> v = corners_of(t);
  bool on_edge = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point vertex = minus(v[i], p);
    const Wide y1 = cross(vertex, minus(v[(i + 1) % 3], p));
    const Wide y2 = cross(vertex, minus(v[(i + 2) % 3], p));
    if ((y1 > 0 && y2 > 0) || (y1 < 0 && y2 < 0)) return Place::outside;
    on_edge = on_edge || y1 == 0 || y2 == 0;
  }
  if (!on_edge) return Place::inside;
  // On the line of an edge: between its ends where the point lies in the box around them.
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = minus(v[i], p);
    const Point b = minus(v[(i + 1) % 3], p);
    if (cross(a, b) == 0 && Wide(a.x) * b.x <= 0 && Wide(a.y) * b.y <= 0) return Place::edge;
  }
  return Place::outside;
}

// The affine map that takes the triangle to (0, 0), (1, 0), (0, 1) takes the point to (x, y): inside are
// x, y > 0 and x + y < 1. All three are multiplied by the determinant.
Place by_simplex(const IdealTriangle& t, Point p) {
  const std::array<Point, 3> v = corners_of(t);
  const Point along_x = minus(v[1], v[0]);
  const Point along_y = minus(v[2], v[0]);
  const Point from = minus(p, v[0]);
  const Wide determinant = cross(along_x, along_y);
  const Wide sign = determinant > 0 ? 1 : -1;
  const Wide x = sign * cross(from, along_y);
  const Wide y = sign * cross(along_x, from);
  return place_by({x, y, sign * determinant - x - y});
}

template <Place (*test)(const IdealTriangle&, Point)>
std::vector<Visible> nearest_by(const OracleInput& input) {
  const FillRule rule = input.config.fill_rule;
  return golden::nearest_faces(input, [rule](const IdealTriangle& t, Point p) {
    const Place place = test(t, p);
    return place == Place::edge ? golden::covers(t, golden::areas_at(t, p), rule) : place == Place::inside;
  });
}

const RegisterOracle half_planes{{.name = "half_planes",
                                  .meaning = "a pixel is inside by the equations of three lines",
                                  .visible = nearest_by<by_half_planes>}};
const RegisterOracle rotations{{.name = "rotations",
                                .meaning = "a pixel is inside by turning each vertex onto an axis",
                                .visible = nearest_by<by_rotations>}};
const RegisterOracle simplex{{.name = "simplex",
                              .meaning = "a pixel is inside by an affine map to the unit simplex",
                              .visible = nearest_by<by_simplex>}};

}  // namespace

}  // namespace bitspan

extern "C" void point_in_triangle_oracle() {}
