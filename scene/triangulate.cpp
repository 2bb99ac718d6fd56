// SPDX-License-Identifier: Apache-2.0
#include "scene/triangulate.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

#include "scene/exact.hpp"

namespace bitspan {
namespace {

struct PlanePoint {
  double x = 0, y = 0;
  bool operator==(const PlanePoint&) const = default;
};

// +1 where a, b, c turn left.
int plane_turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return orientation(a.x, a.y, b.x, b.y, c.x, c.y);
}

// Returns x y 2^2148, which is a whole number.
boost::multiprecision::cpp_int scaled_product(double x, double y) {
  int ex = 0, ey = 0;
  const auto mx = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &ex), 53));
  const auto my = static_cast<std::int64_t>(std::ldexp(std::frexp(y, &ey), 53));
  boost::multiprecision::cpp_int product = mx;
  product *= my;
  // A factor below 2^-1021 has fewer bits, which stand at the bottom of its 53.
  const int shift = ex + ey - 106 + 2148;
  if (shift >= 0) return product << shift;
  return product / (boost::multiprecision::cpp_int(1) << -shift);
}

// Returns the sign of the polygon's area, exactly.
int area_sign(std::span<const PlanePoint> points) {
  double area = 0, magnitude = 0;
  const PlanePoint& o = points[0];
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double left = (points[i].x - o.x) * (points[i + 1].y - o.y);
    const double right = (points[i].y - o.y) * (points[i + 1].x - o.x);
    area += left - right;
    magnitude += std::fabs(left) + std::fabs(right);
  }
  // Per term a few roundings, and one per sum in front of it.
  const double bound = magnitude * 0x1p-52 * (static_cast<double>(points.size()) + 4);
  if (std::fabs(area) > bound && std::fabs(area) > 1e-280) return area > 0 ? 1 : -1;
  boost::multiprecision::cpp_int sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PlanePoint& a = points[i];
    const PlanePoint& b = points[i + 1 < points.size() ? i + 1 : 0];
    sum += scaled_product(a.x, b.y);
    sum -= scaled_product(a.y, b.x);
  }
  return sum.sign();
}

void project(std::span<const Vec3> polygon, int axis, std::vector<PlanePoint>& out) {
  out.clear();
  for (const Vec3& p : polygon) {
    out.push_back(axis == 0 ? PlanePoint{p.y, p.z} : axis == 1 ? PlanePoint{p.z, p.x} : PlanePoint{p.x, p.y});
  }
}

// Returns the polygon as seen along an axis from which it runs counterclockwise, if it has any area.
std::vector<PlanePoint> seen_from_front(std::span<const Vec3> polygon) {
  double size = 0;
  for (const Vec3& p : polygon) size = std::max({size, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  // Near 1, so that no product overflows. What is lost in rounding is but the choice of the axis.
  const double scale = std::ldexp(1.0, std::clamp(-std::ilogb(size > 0 ? size : 1.0), -1020, 1020));
  Vec3 normal;
  const Vec3 o = polygon[0] * scale;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    normal = normal + cross(polygon[i] * scale - o, polygon[i + 1] * scale - o);
  }
  const std::array<double, 3> extent{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  std::array<int, 3> axes{2, 1, 0};
  std::ranges::stable_sort(axes, [&](int a, int b) {
    return extent[static_cast<std::size_t>(a)] > extent[static_cast<std::size_t>(b)];
  });
  std::vector<PlanePoint> points;
  for (const int axis : axes) {
    project(polygon, axis, points);
    const int sign = area_sign(points);
    if (sign < 0) {
      for (PlanePoint& p : points) std::swap(p.x, p.y);
    }
    if (sign != 0) break;
  }
  return points;
}

// The corners that are not strictly convex, in a grid of cells over the polygon: only these lie in ears.
class Obstacles {
 public:
  explicit Obstacles(std::span<const PlanePoint> points, std::size_t count)
      : low_(points[0]),
        side_(std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(count))), 1,
                                      256)) {
    PlanePoint high = points[0];
    for (const PlanePoint& p : points) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    scale_ = {static_cast<double>(side_) / (high.x - low_.x), static_cast<double>(side_) / (high.y - low_.y)};
    cells_.resize(side_ * side_);
  }

  void add(const PlanePoint& p, std::uint32_t corner) {
    cells_[cell(p.y, low_.y, scale_.y) * side_ + cell(p.x, low_.x, scale_.x)].push_back(corner);
  }

  // Whether f holds of a corner near the box; f is asked about all corners in it, and others.
  template <class F>
  bool any_near(const PlanePoint& low, const PlanePoint& high, F f) const {
    const std::size_t left = cell(low.x, low_.x, scale_.x), right = cell(high.x, low_.x, scale_.x);
    const std::size_t last = cell(high.y, low_.y, scale_.y);
    for (std::size_t row = cell(low.y, low_.y, scale_.y); row <= last; ++row) {
      for (std::size_t column = left; column <= right; ++column) {
        if (std::ranges::any_of(cells_[row * side_ + column], f)) return true;
      }
    }
    return false;
  }

 private:
  // Grows with x, whatever is rounded; 0 where the sizes are beyond the doubles.
  std::size_t cell(double x, double low, double scale) const {
    const double at = (x - low) * scale;
    if (!(at > 0)) return 0;
    return at < static_cast<double>(side_) ? static_cast<std::size_t>(at) : side_ - 1;
  }

  PlanePoint low_, scale_;
  std::size_t side_;
  std::vector<std::vector<std::uint32_t>> cells_;
};

// Which corners are cut off, from the best to what is left in a polygon that is none.
enum class Level : std::uint8_t {
  clear,     // no corner lies in the ear, nor on its sides
  touching,  // none lies in it, and none on its sides from which an edge leads into it
  flat,      // the same, or an ear without area
  convex,    // any ear that runs the right way
  any
};

class Ears {
 public:
  explicit Ears(std::vector<PlanePoint> points)
      : points_(std::move(points)),
        previous_(points_.size()),
        next_(points_.size()),
        turn_(points_.size()),
        obstacles_(points_, link()) {
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (turn_[i] <= 0) obstacles_.add(points_[i], i);
    }
  }

  void cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    std::size_t left = points_.size();
    std::vector<std::uint32_t> queue;
    std::vector<bool> is_queued(points_.size()), is_cut(points_.size());
    for (const Level level : {Level::clear, Level::touching, Level::flat, Level::convex, Level::any}) {
      queue.clear();
      const auto ask = [&](std::uint32_t i) {
        if (!is_queued[i]) queue.push_back(i);
        is_queued[i] = true;
      };
      for (std::uint32_t i = 1; i <= points_.size(); ++i) {
        const std::uint32_t corner = i < points_.size() ? i : 0;
        if (!is_cut[corner]) ask(corner);
      }
      for (std::size_t at = 0; at < queue.size() && left > 3; ++at) {
        const std::uint32_t i = queue[at];
        is_queued[i] = false;
        if (is_cut[i] || !is_ear(i, level)) continue;
        const std::uint32_t p = previous_[i], q = next_[i];
        triangles.push_back({p, i, q});
        is_cut[i] = true;
        --left;
        next_[p] = q;
        previous_[q] = p;
        turn_[i] = 1;  // no obstacle any more
        for (const std::uint32_t end : {p, q}) {
          const int before = turn_[end];
          turn_[end] = turn_at(end);
          if (before > 0 && turn_[end] <= 0) obstacles_.add(points_[end], end);
          ask(end);
        }
      }
      if (left == 3) break;
      std::fill(is_queued.begin(), is_queued.end(), false);
    }
    const auto i =
        static_cast<std::uint32_t>(std::find(is_cut.begin(), is_cut.end(), false) - is_cut.begin());
    triangles.push_back({i, next_[i], next_[next_[i]]});
  }

 private:
  int turn_at(std::uint32_t i) const {
    return plane_turn(points_[previous_[i]], points_[i], points_[next_[i]]);
  }

  // Returns how many corners are not strictly convex.
  std::size_t link() {
    const auto n = static_cast<std::uint32_t>(points_.size());
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      previous_[i] = i > 0 ? i - 1 : n - 1;
      next_[i] = i + 1 < n ? i + 1 : 0;
      turn_[i] = turn_at(i);
      count += turn_[i] <= 0 ? 1 : 0;
    }
    return count;
  }

  bool is_ear(std::uint32_t i, Level level) const {
    switch (level) {
      case Level::clear:
      case Level::touching:
        return turn_[i] > 0 && !is_blocked(i, level);
      case Level::flat:
        return turn_[i] == 0 || (turn_[i] > 0 && !is_blocked(i, level));
      case Level::convex:
        return turn_[i] >= 0;
      case Level::any:
        return true;
    }
    return true;
  }

  bool is_blocked(std::uint32_t i, Level level) const {
    const std::array<PlanePoint, 3> ear{points_[previous_[i]], points_[i], points_[next_[i]]};
    const PlanePoint low{std::min({ear[0].x, ear[1].x, ear[2].x}), std::min({ear[0].y, ear[1].y, ear[2].y})};
    const PlanePoint high{std::max({ear[0].x, ear[1].x, ear[2].x}), std::max({ear[0].y, ear[1].y, ear[2].y})};
    return obstacles_.any_near(low, high, [&](std::uint32_t o) {
      const PlanePoint& p = points_[o];
      if (turn_[o] > 0 || p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) return false;
      // A corner where a bridge begins stands there twice; its other edges lead out of this ear.
      if (std::ranges::find(ear, p) != ear.end()) return false;
      bool is_inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const PlanePoint &a = ear[k], &b = ear[(k + 1) % 3];
        const int side = plane_turn(a, b, p);
        if (side < 0) return false;
        if (side > 0) continue;
        is_inside = plane_turn(a, b, points_[previous_[o]]) > 0 || plane_turn(a, b, points_[next_[o]]) > 0;
      }
      return is_inside || level == Level::clear;
    });
  }

  std::vector<PlanePoint> points_;
  std::vector<std::uint32_t> previous_, next_;
  std::vector<int> turn_;
  Obstacles obstacles_;
};

}  // namespace

void triangulate(std::span<const Vec3> polygon, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({0, 1, 2});
    return;
  }
  std::vector<PlanePoint> points = seen_from_front(polygon);
  if (polygon.size() > 4) return Ears(std::move(points)).cut(triangles);
  const auto is_cut_by = [&](std::size_t i) {
    return plane_turn(points[i], points[i + 1], points[i + 2]) > 0 &&
           plane_turn(points[i + 2], points[(i + 3) % 4], points[i]) > 0;
  };
  if (!is_cut_by(0) && is_cut_by(1)) {
    triangles.insert(triangles.end(), {{1, 2, 3}, {1, 3, 0}});
  } else {
    triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  }
}

}  // namespace bitspan
