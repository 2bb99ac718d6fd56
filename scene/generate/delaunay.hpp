// SPDX-License-Identifier: Apache-2.0
// Delaunay triangulations of points with integer coordinates, by insertion and by removal [G2]. Every
// decision is exact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/generate/obj_writer.hpp"

namespace bitspan {

struct GridPoint {
  std::int32_t x = 0, y = 0;
  bool operator==(const GridPoint&) const = default;
  bool operator<(const GridPoint& other) const { return x != other.x ? x < other.x : y < other.y; }
};
inline constexpr std::int32_t grid_point_limit = 1
                                                 << 29;  // of a coordinate, either way: products fit 128 bits

// The sign of (b - a) x (c - a): positive where a, b, c turn from the x axis towards the y axis.
int side_of(const GridPoint& a, const GridPoint& b, const GridPoint& c);
// Whether d lies inside the circle through a, b, c, which side_of calls positive. Of four points on one
// circle the greatest one, by x and then by y, counts as a little outside of the circle through the others.
// So every set of points has one triangulation alone, in whatever order they come.
bool is_in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d);

// A rectangle in triangles. Points are put into it and taken out of it, by their numbers.
class Delaunay {
 public:
  // points[0..3] are the rectangle's corners (x0, y0), (x1, y0), (x1, y1), (x0, y1), which are in at once;
  // all others lie in it or on its edges. No two are equal.
  explicit Delaunay(std::vector<GridPoint> points);

  void insert(std::uint32_t point);  // one that is not in
  // One that is in, and no corner. `hole`, where it is given, is told the triangles that took its place.
  void remove(std::uint32_t point, std::vector<std::array<std::uint32_t, 3>>* hole = nullptr);
  // Inserts all points, in an order in which each is near the one before.
  void insert_all(const WorkProgress& progress = {});

  const std::vector<GridPoint>& points() const { return points_; }
  bool has(std::uint32_t point) const { return triangle_of_[point] >= 0; }
  bool is_on_edge(std::uint32_t point) const;  // of the rectangle
  std::size_t size() const { return size_; }   // points that are in
  std::size_t triangle_count() const { return triangle_count_; }
  // Each begins with its least number and turns as side_of calls positive.
  std::vector<std::array<std::uint32_t, 3>> triangles() const;
  // The neighbours of a point that is in, in the positive direction; of one on an edge from edge to edge.
  void neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const;

 private:
  // Corner k is opposite to neighbour k; -1 is beyond the rectangle. A free one has corner[0] = none.
  struct Triangle {
    std::array<std::uint32_t, 3> corner{};
    std::array<std::int32_t, 3> neighbour{-1, -1, -1};
  };
  // The edge from a to b of a triangle around a point or of a hole, and what lies behind it.
  struct Link {
    std::uint32_t a = 0, b = 0;
    std::int32_t behind = -1;
    std::int32_t triangle = -1;
  };
  struct Suspect {
    std::int32_t triangle;
    std::uint32_t a, b;
  };

  const GridPoint& at(std::uint32_t point) const { return points_[point]; }
  Triangle& tri(std::int32_t t) { return triangles_[static_cast<std::size_t>(t)]; }
  const Triangle& tri(std::int32_t t) const { return triangles_[static_cast<std::size_t>(t)]; }
  std::int32_t new_triangle();
  void free_triangle(std::int32_t t);
  void set(std::int32_t t, std::array<std::uint32_t, 3> corners, std::array<std::int32_t, 3> neighbours);
  void replace_neighbour(std::int32_t t, std::uint32_t a, std::uint32_t b, std::int32_t by);
  void flip(std::int32_t t, int k);
  void suspect(std::int32_t t);
  void settle();
  void star(std::uint32_t point, std::vector<Link>& out) const;
  std::int32_t locate(const GridPoint& p) const;

  std::vector<GridPoint> points_;
  std::vector<std::int32_t> triangle_of_;  // one of those around a point; -1: it is not in
  std::vector<Triangle> triangles_;
  std::vector<std::int32_t> free_;
  std::vector<Suspect> suspects_;
  std::vector<Link> links_, scratch_;
  std::size_t size_ = 0, triangle_count_ = 0;
  std::int32_t last_ = 0;  // where a search begins
};

// The part of the rectangle that is nearer to a point that is in than to any other: Voronoi's cell, a convex
// polygon in the positive direction.
void voronoi_cell(const Delaunay& points, std::uint32_t point, std::vector<std::array<double, 2>>& out);

}  // namespace bitspan
