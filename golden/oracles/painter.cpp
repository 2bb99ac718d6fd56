// SPDX-License-Identifier: Apache-2.0
// The painter's algorithm by Newell, Newell and Sancha: a polygon is painted when five tests say of all that
// are left that it hides nothing of them. Where polygons hide each other in turn, the plane of one of them
// splits another one. All tests are exact. [B4]
//
// Everything is decided in the picture. There 1/S of a face is a plane, so a point of one face lies behind
// the plane of another one where its own 1/S is the less. The planes of two faces cut each other along a
// line.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "config/modes.hpp"
#include "golden/exact.hpp"
#include "golden/oracle.hpp"

namespace bitspan {

namespace {

using golden::Approx;
using golden::Integer;

// Homogeneous: a point (x / w, y / w), w > 0, in pixels from the centre of pixel (0, 0); or a line
// x' a + y' b + c = 0, which is positive on its inner side.
struct Triple {
  Integer x, y, w;
};
Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.w - a.w * b.y, a.w * b.x - a.x * b.w, a.x * b.y - a.y * b.x};
}
Integer dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.w * b.w; }
Triple negated(const Triple& a) { return {-a.x, -a.y, -a.w}; }

Approx about(long double value) { return golden::rounded(static_cast<double>(value), 0); }

struct Corner {
  Triple at;
  Approx x, y;  // of the point
};
Corner corner_at(Triple at) {
  if (at.w < 0) at = negated(at);
  const auto w = static_cast<long double>(at.w);
  // A quotient of two rounded numbers.
  const auto part = [&](const Integer& n) {
    const auto value = static_cast<double>(static_cast<long double>(n) / w);
    return golden::rounded(value, 0x1p-50 * std::abs(value));
  };
  return {at, part(at.x), part(at.y)};
}

struct Line {
  Triple exact;
  Approx a, b, c;  // in some positive unit
};
Line negated(const Line& line) {
  const auto of = [](Approx v) { return Approx{-v.value, v.error}; };
  return {negated(line.exact), of(line.a), of(line.b), of(line.c)};
}
int side_of(const Line& line, const Corner& corner) {
  const std::optional<int> sign = golden::sign_of(line.a * corner.x + line.b * corner.y + line.c);
  return sign ? *sign : dot(line.exact, corner.at).sign();
}

// 1/S of a face, exactly and about.
struct Plane {
  golden::InversePlane exact;
  Approx a, b, c;
};
// The line along which p and q are equal; p is nearer on its inner side.
Line cut_of(const Plane& p, const Plane& q) {
  const auto part = [&](const Integer& of_p, const Integer& of_q) {
    return Integer(of_p * q.exact.d - of_q * p.exact.d);
  };
  return {{part(p.exact.a, q.exact.a), part(p.exact.b, q.exact.b), part(p.exact.c, q.exact.c)},
          p.a - q.a,
          p.b - q.b,
          p.c - q.c};
}
// 1 where p is nearer at a point than q, 0 where both are as far.
int compared(const Plane& p, const Plane& q, const Corner& at) {
  const std::optional<int> sign = golden::sign_of((p.a - q.a) * at.x + (p.b - q.b) * at.y + (p.c - q.c));
  if (sign) return *sign;
  const auto n = [&](const Plane& of) { return dot({of.exact.a, of.exact.b, of.exact.c}, at.at); };
  return Integer(n(p) * q.exact.d - n(q) * p.exact.d).sign();
}

// A range that holds all of something's values.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(Approx value) {
    low = std::min(low, value.value - value.error);
    high = std::max(high, value.value + value.error);
  }
};

// A convex part of a face. Side i goes from corner i to the next one.
struct Polygon {
  std::size_t face = 0;
  std::vector<Corner> corners;
  std::vector<Line> sides;
  std::vector<Line> cuts;  // those of its sides that are no side of the face
  Range x, y, q;           // of its corners
};

struct Painter {
  explicit Painter(const OracleInput& of)
      : input(of), grid(of.faces), is_closed(owns_every_edge(of.config.fill_rule)) {
    out.resize(static_cast<std::size_t>(of.scene.width) * static_cast<std::size_t>(of.scene.height));
    for (std::size_t f = 0; f < of.faces.size(); ++f) {
      const IdealTriangle& t = of.faces[f].shape;
      const golden::InversePlane plane = golden::inverse_plane(t, grid);
      const auto d = static_cast<long double>(plane.d);
      const auto part = [&](const Integer& n) {
        return about(grid.inverse(static_cast<long double>(n) / d));
      };
      planes.push_back({plane, part(plane.a), part(plane.b), part(plane.c)});
      add(whole(f));
    }
  }

  Polygon whole(std::size_t f) const {
    const IdealTriangle& t = input.faces[f].shape;
    Polygon polygon;
    polygon.face = f;
    const std::int64_t pixel = std::int64_t{1} << t.subpixel_bits;
    for (const IdealTriangle::Corner& corner : t.v) {
      const golden::Point p = golden::point_of(corner);
      const double scale = std::ldexp(0.5, -t.subpixel_bits);  // exact, as are coordinates of 40 bits
      polygon.corners.push_back({{p.x - pixel, p.y - pixel, 2 * pixel},
                                 {static_cast<double>(p.x - pixel) * scale, 0},
                                 {static_cast<double>(p.y - pixel) * scale, 0}});
    }
    for (std::size_t i = 0; i < 3; ++i) {
      Triple line = cross(polygon.corners[i].at, polygon.corners[(i + 1) % 3].at);
      if (dot(line, polygon.corners[(i + 2) % 3].at) < 0) line = negated(line);
      const auto part = [](const Integer& n) { return about(static_cast<long double>(n)); };
      polygon.sides.push_back({line, part(line.x), part(line.y), part(line.w)});
    }
    return polygon;
  }

  void add(Polygon polygon) {
    const Plane& plane = planes[polygon.face];
    for (const Corner& corner : polygon.corners) {
      polygon.x.add(corner.x);
      polygon.y.add(corner.y);
      polygon.q.add(plane.a * corner.x + plane.b * corner.y + plane.c);
    }
    left.emplace(polygon.q.low, polygons.size());
    polygons.push_back(std::move(polygon));
  }

  // Whether no part of p is in front of r where both are seen, so that p may be painted first. The ranges of
  // distances, and then the five tests.
  bool may_precede(const Polygon& p, const Polygon& r) const {
    if (p.q.high <= r.q.low) return true;
    const auto apart = [&](const Range& a, const Range& b) {
      return is_closed ? a.high < b.low || b.high < a.low : a.high <= b.low || b.high <= a.low;
    };
    if (apart(p.x, r.x) || apart(p.y, r.y)) return true;
    const Plane& of_p = planes[p.face];
    const Plane& of_r = planes[r.face];
    const auto is_behind = [&](const Corner& at) { return compared(of_p, of_r, at) <= 0; };
    if (std::ranges::all_of(p.corners, is_behind)) return true;
    if (std::ranges::all_of(r.corners, is_behind)) return true;
    const auto parts = [](const Polygon& a, const Polygon& b, int limit) {
      return std::ranges::any_of(a.sides, [&](const Line& side) {
        return std::ranges::all_of(b.corners, [&](const Corner& at) { return side_of(side, at) <= limit; });
      });
    };
    if (!parts(p, r, 0) && !parts(r, p, 0)) return false;
    if (!is_closed || parts(p, r, -1) || parts(r, p, -1)) return true;
    // They touch, and pixels on their sides show both: what they have in common ends at corners.
    const auto in_common_behind = [&](const Polygon& a, const Polygon& b) {
      return std::ranges::all_of(a.corners, [&](const Corner& at) {
        return std::ranges::any_of(b.sides, [&](const Line& side) { return side_of(side, at) < 0; }) ||
               is_behind(at);
      });
    };
    return in_common_behind(p, r) && in_common_behind(r, p);
  }

  // The part of a polygon on the inner side of a line that goes through it.
  static Polygon inside(const Polygon& polygon, const Line& line, const std::vector<int>& side, int inner) {
    Polygon part;
    part.face = polygon.face;
    part.cuts = polygon.cuts;
    part.cuts.push_back(line);
    const std::size_t n = polygon.corners.size();
    for (std::size_t i = 0; i < n; ++i) {
      const int here = inner * side[i];
      const int next = inner * side[(i + 1) % n];
      const Line& edge = polygon.sides[i];
      if (here >= 0) {
        part.corners.push_back(polygon.corners[i]);
        part.sides.push_back(here == 0 && next < 0 ? line : edge);
      }
      if (here * next < 0) {
        part.corners.push_back(corner_at(cross(edge.exact, line.exact)));
        part.sides.push_back(here > 0 ? line : edge);
      }
    }
    return part;
  }

  // Splits one of some polygons that hide each other in turn by the plane of another one. There is such a
  // pair: else the planes order them all, as those of a BSP tree do.
  void split_one(std::span<const std::size_t> cycle) {
    for (const std::size_t i : cycle) {
      for (const std::size_t j : cycle) {
        const Plane& own = planes[polygons[i].face];
        const Plane& other = planes[polygons[j].face];
        std::vector<int> side;
        for (const Corner& at : polygons[i].corners) side.push_back(compared(own, other, at));
        if (std::ranges::find(side, 1) == side.end() || std::ranges::find(side, -1) == side.end()) continue;
        const Line line = cut_of(own, other);
        Polygon near = inside(polygons[i], line, side, 1);
        Polygon far = inside(polygons[i], negated(line), side, -1);
        left.erase({polygons[i].q.low, i});
        add(std::move(near));
        add(std::move(far));
        return;
      }
    }
    throw std::logic_error("painter: no plane splits a cycle");
  }

  bool is_inside(const Polygon& polygon, std::int64_t x, std::int64_t y) const {
    const IdealTriangle& t = input.faces[polygon.face].shape;
    if (!golden::covers(t, golden::areas_at(t, golden::centre_of(t, x, y)), input.config.fill_rule)) {
      return false;
    }
    const Corner centre{{x, y, 1}, {static_cast<double>(x), 0}, {static_cast<double>(y), 0}};
    return std::ranges::all_of(polygon.cuts, [&](const Line& cut) {
      int side = side_of(cut, centre);
      if (side != 0 || is_closed) return side >= 0;
      // As on a side of the triangle: one of both parts owns the centre.
      side = cut.exact.x.sign();
      return side > 0 || (side == 0 && cut.exact.y > 0);
    });
  }

  void paint(const Polygon& polygon) {
    const OracleFace& face = input.faces[polygon.face];
    const auto first = [](double low) { return static_cast<std::int64_t>(std::ceil(std::max(low, 0.0))); };
    const auto last = [](double high, int size) {
      return static_cast<std::int64_t>(std::floor(std::min(high, size - 1.0)));
    };
    for (std::int64_t y = first(polygon.y.low); y <= last(polygon.y.high, input.scene.height); ++y) {
      for (std::int64_t x = first(polygon.x.low); x <= last(polygon.x.high, input.scene.width); ++x) {
        if (!is_inside(polygon, x, y)) continue;
        const golden::Areas areas = golden::areas_at(face.shape, golden::centre_of(face.shape, x, y));
        const Visible painted{face.index, golden::inverse_distance(face.shape, areas)};
        Visible& seen = out[static_cast<std::size_t>(y * input.scene.width + x)];
        // Of faces that are exactly as far, the first is seen.
        if (seen.triangle >= 0 && seen.triangle < face.index && seen.q == painted.q) continue;
        seen = painted;
      }
    }
  }

  void paint_all() {
    // A polygon, and where among those that are left the tests of it go on.
    struct Moved {
      std::size_t polygon;
      std::pair<double, std::size_t> next;
    };
    const auto moved = [](std::size_t polygon) {
      return Moved{polygon, {-std::numeric_limits<double>::infinity(), 0}};
    };
    std::vector<Moved> stack;
    while (!left.empty()) {
      if (stack.empty()) stack.push_back(moved(left.begin()->second));
      const std::size_t at = stack.back().polygon;
      const Polygon& p = polygons[at];
      auto r = left.lower_bound(stack.back().next);
      while (r != left.end() && r->first < p.q.high &&
             (r->second == at || may_precede(p, polygons[r->second]))) {
        ++r;
      }
      if (r == left.end() || r->first >= p.q.high) {
        paint(p);
        left.erase({p.q.low, at});
        stack.pop_back();
        continue;
      }
      // All tests fail of r: it changes places with p. What was moved already is split instead.
      stack.back().next = *r;
      const auto again = std::ranges::find(stack, r->second, &Moved::polygon);
      if (again == stack.end()) {
        stack.push_back(moved(r->second));
        continue;
      }
      std::vector<std::size_t> cycle;
      for (auto i = again; i != stack.end(); ++i) cycle.push_back(i->polygon);
      split_one(cycle);
      stack.clear();
    }
  }

  const OracleInput& input;
  golden::DistanceGrid grid;
  bool is_closed;  // pixels on a side belong to the face
  std::vector<Plane> planes;
  std::vector<Polygon> polygons;
  std::set<std::pair<double, std::size_t>> left;  // to paint, the farthest first
  std::vector<Visible> out;
};

std::vector<Visible> paint(const OracleInput& input) {
  Painter painter(input);
  painter.paint_all();
  return painter.out;
}

const RegisterOracle oracle{{.name = "painter",
                             .meaning = "painter's algorithm by five tests, and splitting where all fail",
                             .visible = paint}};

}  // namespace

}  // namespace bitspan

extern "C" void painter_oracle() {}
