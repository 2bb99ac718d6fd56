// SPDX-License-Identifier: Apache-2.0
// Ray tracing: a ray goes from the eye through a pixel's centre, and the triangle that it meets first is
// seen. Exact volumes in the eye's space decide whether and where it meets one. [V2]
//
// The eye is at 0. S runs forward, x to the right and y down, in such units that a vertex which is seen at
// golden::Point (x, y), from the middle of the picture, lies at (S x, S y, S).
#define BOOST_ALLOW_DEPRECATED_HEADERS  // else the compiler notes that Boost's tree includes one

#include <algorithm>
#include <array>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/geometries/segment.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "config/modes.hpp"
#include "golden/exact.hpp"
#include "golden/oracle.hpp"

namespace bitspan {

namespace {

using golden::abs;
using golden::Approx;
using golden::DistanceGrid;
using golden::Integer;
using golden::rounded;
using golden::sign_of;

template <class N>
struct Vector {
  N x, y, z;
};
template <class N>
Vector<N> operator-(const Vector<N>& a, const Vector<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
N dot(const Vector<N>& a, const Vector<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class N>
Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class N>
struct Ray {
  Vector<N> from, along;  // its points: from + t along, t > 0
};
template <class N>
using Corners = std::array<Vector<N>, 3>;

// Where the line of a ray meets the plane of a triangle.
template <class N>
struct Meeting {
  // Per corner, of the plane through the ray's start and the side opposite to it.
  std::array<Vector<N>, 3> normal;
  // normal * along: six times the volume over that side. The point is the mean of the corners with these
  // weights.
  std::array<N, 3> volume;
  N whole;   // their sum; 0 where line and plane are parallel
  N height;  // t = height / whole
};

template <class N>
Meeting<N> meet(const Ray<N>& ray, const Corners<N>& corners) {
  const Vector<N> a = corners[0] - ray.from;
  const Vector<N> b = corners[1] - ray.from;
  const Vector<N> c = corners[2] - ray.from;
  Meeting<N> out{{cross(b, c), cross(c, a), cross(a, b)}, {}, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) out.volume[i] = dot(out.normal[i], ray.along);
  out.whole = out.volume[0] + out.volume[1] + out.volume[2];
  out.height = dot(a, out.normal[0]);
  return out;
}

// Whether the ray goes through the triangle; none where an error leaves it open. Where it goes through a
// side, the fill rule decides. By top_left the ray is turned to the right by next to nothing, and where it
// then still goes through the side, down.
template <class N>
std::optional<bool> goes_through(const Meeting<N>& m, FillRule rule) {
  bool positive = false;
  bool negative = false;
  bool open = false;
  const auto count = [&](std::optional<int> sign) {
    positive = positive || sign == 1;
    negative = negative || sign == -1;
    open = open || !sign;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    std::optional<int> side = sign_of(m.volume[i]);
    if (!owns_every_edge(rule)) {
      if (side == 0) side = sign_of(m.normal[i].x);
      if (side == 0) side = sign_of(m.normal[i].y);
    }
    count(side);
  }
  if (positive && negative) return false;
  const std::optional<int> whole = sign_of(m.whole);
  const std::optional<int> height = sign_of(m.height);
  if (open || !whole || !height) return std::nullopt;
  return *whole * *height > 0;
}

// The sign of t of a less t of b, both positive; none where an error leaves it open.
template <class N>
std::optional<int> compared(const Meeting<N>& a, const Meeting<N>& b) {
  return sign_of(abs(a.height) * abs(b.whole) - abs(b.height) * abs(a.whole));
}

// The triangles that a ray may meet, by a tree of boxes around them.
class RayScene {
 public:
  explicit RayScene(const OracleInput& input) : input_(input), grid_(input.faces) {
    std::array<double, 3> largest{};
    for (const OracleFace& face : input.faces) {
      Corners<Approx>& corners = approximate_.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const double s = grid_.scaled(face.shape.v[i].s);
        const auto [x, y] = place_of(golden::point_of(face.shape.v[i]), face.shape.subpixel_bits);
        const Approx distance = rounded(s, 0);
        corners[i] = {distance * exactly(x), distance * exactly(y), distance};
        largest[0] = std::max(largest[0], std::abs(corners[i].x.value));
        largest[1] = std::max(largest[1], std::abs(corners[i].y.value));
        largest[2] = std::max(largest[2], corners[i].z.value);
      }
    }
    // The walk through the tree rounds, by 2^-50 of such coordinates. The boxes are larger than their
    // triangles by far more than that, so that no triangle is missed.
    std::vector<Entry> entries;
    for (std::size_t f = 0; f < approximate_.size(); ++f) {
      const Corners<Approx>& c = approximate_[f];
      const auto [x_low, x_high] = std::minmax({c[0].x.value, c[1].x.value, c[2].x.value});
      const auto [y_low, y_high] = std::minmax({c[0].y.value, c[1].y.value, c[2].y.value});
      const auto [z_low, z_high] = std::minmax({c[0].z.value, c[1].z.value, c[2].z.value});
      const auto more = [&](std::size_t axis) { return 0x1p-30 * largest[axis]; };
      entries.emplace_back(Box{{x_low - more(0), y_low - more(1), z_low - more(2)},
                               {x_high + more(0), y_high + more(1), z_high + more(2)}},
                           static_cast<std::uint32_t>(f));
    }
    boxes_ = Tree(entries);
  }

  // What is seen through the centre of pixel (x, y).
  Visible seen_at(std::int64_t x, std::int64_t y) {
    if (input_.faces.empty()) return {};
    const auto [right, down] =
        place_of(golden::centre_of(input_.faces[0].shape, x, y), input_.faces[0].shape.subpixel_bits);
    const Ray<Approx> about{{}, {exactly(right), exactly(down), exactly(1)}};
    const Ray<Integer> ray{{}, {right, down, 1}};
    candidates_.clear();
    const auto reach = [](std::int64_t towards) { return 2 * static_cast<double>(towards); };
    boxes_.query(boost::geometry::index::intersects(Segment{{0, 0, 0}, {reach(right), reach(down), 2}}),
                 std::back_inserter(candidates_));
    std::optional<std::size_t> nearest;
    Meeting<Approx> there;
    for (const auto& [box, face] : candidates_) {
      const Meeting<Approx> here = meet(about, approximate_[face]);
      if (!hits(ray, here, face)) continue;
      if (nearest && !is_nearer(ray, here, face, there, *nearest)) continue;
      nearest = face;
      there = here;
    }
    if (!nearest) return {};
    return visible_of(ray, *nearest);
  }

 private:
  using Place = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
  using Box = boost::geometry::model::box<Place>;
  using Segment = boost::geometry::model::segment<Place>;
  using Entry = std::pair<Box, std::uint32_t>;
  using Tree = boost::geometry::index::rtree<Entry, boost::geometry::index::quadratic<8>>;

  static Approx exactly(std::int64_t a) { return {static_cast<double>(a), 0}; }  // of at most 53 bits

  // From the middle of the picture.
  golden::Point place_of(golden::Point p, int subpixel_bits) const {
    return {p.x - (std::int64_t{input_.scene.width} << subpixel_bits),
            p.y - (std::int64_t{input_.scene.height} << subpixel_bits)};
  }

  Corners<Integer> corners_of(std::size_t face) const {
    Corners<Integer> out;
    const IdealTriangle& shape = input_.faces[face].shape;
    for (std::size_t i = 0; i < 3; ++i) {
      const Integer s = grid_.whole(shape.v[i].s);
      const auto [x, y] = place_of(golden::point_of(shape.v[i]), shape.subpixel_bits);
      out[i] = {s * x, s * y, s};
    }
    return out;
  }

  bool hits(const Ray<Integer>& ray, const Meeting<Approx>& here, std::size_t face) const {
    const FillRule rule = input_.config.fill_rule;
    const std::optional<bool> about = goes_through(here, rule);
    return about ? *about : *goes_through(meet(ray, corners_of(face)), rule);
  }

  // Of equal distances the one of the least index is nearer.
  bool is_nearer(const Ray<Integer>& ray, const Meeting<Approx>& here, std::size_t face,
                 const Meeting<Approx>& there, std::size_t other) const {
    std::optional<int> order = compared(here, there);
    if (!order) order = compared(meet(ray, corners_of(face)), meet(ray, corners_of(other)));
    return *order < 0 || (*order == 0 && face < other);
  }

  // A corner's weight in the picture is its weight in space times its S, and all three weights have the
  // product of the three S in common. So the weight is volume / (the product of the S of the two other
  // corners).
  Visible visible_of(const Ray<Integer>& ray, std::size_t face) const {
    const OracleFace& seen = input_.faces[face];
    const Corners<Integer> corners = corners_of(face);
    const Meeting<Integer> m = meet(ray, corners);
    golden::Areas areas;
    for (std::size_t i = 0; i < 3; ++i) {
      const Integer common = corners[(i + 1) % 3].z * corners[(i + 2) % 3].z;
      areas.part[i] = static_cast<golden::Wide>(Integer(m.volume[i] / common));
      areas.whole += areas.part[i];
    }
    return {seen.index, golden::inverse_distance(seen.shape, areas)};
  }

  const OracleInput& input_;
  DistanceGrid grid_;
  std::vector<Corners<Approx>> approximate_;  // per face, S scaled
  Tree boxes_;
  std::vector<Entry> candidates_;
};

std::vector<Visible> by_rays(const OracleInput& input) {
  RayScene scene(input);
  std::vector<Visible> out;
  out.reserve(static_cast<std::size_t>(input.scene.width) * static_cast<std::size_t>(input.scene.height));
  for (std::int64_t y = 0; y < input.scene.height; ++y) {
    for (std::int64_t x = 0; x < input.scene.width; ++x) out.push_back(scene.seen_at(x, y));
  }
  return out;
}

const RegisterOracle ray{
    {.name = "ray",
     .meaning = "the first triangle, and the first quadric, that a ray from the eye meets; shadows by rays "
                "from the light",
     .has_shadows = true,
     .has_quadrics = true,
     .visible = by_rays}};

}  // namespace

}  // namespace bitspan

extern "C" void ray_oracle() {}
