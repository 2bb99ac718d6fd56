// SPDX-License-Identifier: Apache-2.0
// The surface of the truth, without quantisation but of the vertices' positions: the snap, the coverage of
// pixel centres, and 1/S there. `ideal` draws with it, and so do the oracles; docs/numeric-spec.md, "ideal".
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// A triangle after the snap, its vertices in the order of the edge walk (as in SetupRecord).
struct IdealTriangle {
  struct Corner {
    std::int64_t x = 0, y = 0;  // in units of 2^-subpixel_bits pixel
    long double s = 1, u = 0, v = 0;
    std::array<long double, 4> c{};
    Attributes given;  // of given_attributes
    int place = 0;     // among the triangle's, from 0
  };
  std::array<Corner, 3> v;
  int subpixel_bits = 0;
  bool mid_right = false;  // vertex 1 lies right of the edge from vertex 0 to 2
  int texture = -1;
};

// Returns none where the snapped triangle has no area.
std::optional<IdealTriangle> ideal_triangle(const Config& config, const Triangle& triangle);

// Says whether the centre of pixel (x, y) is inside. Exact, by three signed areas; independent of any walk.
bool ideal_covers(const Config& config, const IdealTriangle& triangle, std::int64_t x, std::int64_t y);

namespace golden {

using Wide = __int128;  // areas: coordinates have at most 40 bits with the half pixel

// Points in units of 2^-(subpixel_bits + 1) pixel, in which pixel centres and vertices are both integers.
struct Point {
  std::int64_t x = 0, y = 0;
};
Point centre_of(const IdealTriangle& t, std::int64_t x, std::int64_t y);
Point point_of(const IdealTriangle::Corner& c);

// Twice the signed area.
Wide area_of(Point a, Point b, Point c);

// The signed areas opposite to each vertex; they sum up to the triangle's own.
struct Areas {
  std::array<Wide, 3> part{};
  Wide whole = 0;
};
Areas areas_at(const IdealTriangle& t, Point p);

// Whether the point is inside by the fill rule, which decides on the edges.
bool covers(const IdealTriangle& t, const Areas& areas, FillRule rule);

// The pixels of a picture that a triangle's bounding box touches; none where a last one is before the first.
struct PixelBox {
  std::int64_t x_first = 0, x_last = -1, y_first = 0, y_last = -1;
};
PixelBox pixel_box(const IdealTriangle& t, int width, int height);

// Calls f(areas, x, y) for each pixel of the picture that the triangle covers, row by row.
template <class F>
void for_each_covered(const IdealTriangle& t, FillRule rule, int width, int height, F f) {
  const PixelBox box = pixel_box(t, width, height);
  if (box.x_first > box.x_last || box.y_first > box.y_last) return;
  // The areas are linear in the point, so one pixel to the right adds a constant, exactly.
  const Areas here = areas_at(t, centre_of(t, 0, 0));
  const Areas next = areas_at(t, centre_of(t, 1, 0));
  for (std::int64_t y = box.y_first; y <= box.y_last; ++y) {
    Areas areas = areas_at(t, centre_of(t, box.x_first, y));
    bool entered = false;
    for (std::int64_t x = box.x_first; x <= box.x_last; ++x) {
      if (covers(t, areas, rule)) {
        entered = true;
        f(areas, x, y);
      } else if (entered) {
        break;  // a triangle is convex
      }
      for (std::size_t i = 0; i < 3; ++i) areas.part[i] += next.part[i] - here.part[i];
    }
  }
}

// 1/S at a point inside a triangle: the sum of part[i] / (whole s[i]), exactly.
struct InverseDistance {
  std::array<Wide, 3> part{};
  Wide whole = 1;  // positive, and no part is negative
  std::array<long double, 3> s{1, 1, 1};
  long double value = 0;  // the sum; off by less than 2^-60 of itself
};
InverseDistance inverse_distance(const IdealTriangle& t, const Areas& inside);
// Exact: greater is nearer.
std::strong_ordering operator<=>(const InverseDistance& a, const InverseDistance& b);
inline bool operator==(const InverseDistance& a, const InverseDistance& b) { return std::is_eq(a <=> b); }

// h of 1/S = q, in a range of distances; the scene's. [D1]
long double depth_code(const Config& config, long double s_min, long double s_max, long double q);
long double depth_code(const Config& config, const Scene& scene, long double q);
long double h_max(const Config& config);

}  // namespace golden

// A line [B1] between the pixels of its ends: each pixel that is the nearest one to the true line, inside a
// picture or not, from vertex 0 of the shape to vertex 2, whose shares are the weights.
struct IdealLine {
  struct Pixel {
    std::int64_t x, y;
    golden::Areas weight;
  };
  IdealTriangle shape;
  std::vector<Pixel> pixels;
};
IdealLine ideal_line(const Config& config, const Triangle& line);
}  // namespace bitspan
