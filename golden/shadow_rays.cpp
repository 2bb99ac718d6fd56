// SPDX-License-Identifier: Apache-2.0
#include "golden/shadow_rays.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "golden/box_tree.hpp"

namespace bitspan::golden {
namespace {

// Planes that are one plane differ by the rounding of doubles, by no more than this share of q.
constexpr double same_plane = 1e-9;
// The surface of a receiver and the caster that it is, whose corners have been projected, clipped and
// rounded.
constexpr double same_surface = 1e-7;
// Corners that are one corner, clipped from both sides of an edge, texels.
constexpr double same_corner = 1e-6;

// A corner of a polygon in the picture, with how much nearer the caster is there than the surface, and than
// what the comparison takes for it.
struct Corner2 {
  double x, y, above, nearer;
};
using Polygon = std::vector<Corner2>;

// What of a polygon has side(corner) >= 0; side is linear.
template <class Side>
Polygon clipped(const Polygon& polygon, Side side) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner2& a = polygon[i];
    const Corner2& b = polygon[(i + 1) % polygon.size()];
    const double at_a = side(a);
    const double at_b = side(b);
    if (at_a >= 0) out.push_back(a);
    if ((at_a >= 0) == (at_b >= 0)) continue;
    const double t = at_a / (at_a - at_b);
    const auto between = [t](double of_a, double of_b) { return of_a + t * (of_b - of_a); };
    out.push_back(
        {between(a.x, b.x), between(a.y, b.y), between(a.above, b.above), between(a.nearer, b.nearer)});
  }
  return out;
}

struct Square {
  double x, y, reach;
  Polygon cut(Polygon polygon) const {
    polygon = clipped(polygon, [&](const Corner2& c) { return c.x - (x - reach); });
    polygon = clipped(polygon, [&](const Corner2& c) { return x + reach - c.x; });
    polygon = clipped(polygon, [&](const Corner2& c) { return c.y - (y - reach); });
    return clipped(polygon, [&](const Corner2& c) { return y + reach - c.y; });
  }
};

double side_of(double ax, double ay, double bx, double by, double px, double py) {
  return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
}
bool contains(const Caster& c, double x, double y) {
  bool positive = false;
  bool negative = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    const double side = side_of(c.x[i], c.y[i], c.x[k], c.y[k], x, y);
    positive = positive || side > 0;
    negative = negative || side < 0;
  }
  return !(positive && negative);
}

// The side i of a goes on in b, on its other side.
bool goes_on(const Caster& a, std::size_t i, const Caster& b) {
  const std::size_t k = (i + 1) % 3;
  const auto same = [&](std::size_t of_a, std::size_t of_b) {
    return std::abs(a.x[of_a] - b.x[of_b]) <= same_corner && std::abs(a.y[of_a] - b.y[of_b]) <= same_corner;
  };
  const auto side = [&](const Caster& c, std::size_t of_c) {
    return side_of(a.x[i], a.y[i], a.x[k], a.y[k], c.x[of_c], c.y[of_c]);
  };
  for (std::size_t m = 0; m < 3; ++m) {
    for (const std::size_t n : {(m + 1) % 3, (m + 2) % 3}) {
      if (same(i, m) && same(k, n) && side(a, (i + 2) % 3) * side(b, 3 - m - n) < 0) return true;
    }
  }
  return false;
}

// The share of the receiver's q that a caster has at each corner; none where it is not one share.
std::optional<double> share_of(const Receiver& r, const Caster& c) {
  std::array<double, 3> share{};
  for (std::size_t i = 0; i < 3; ++i) share[i] = c.q[i] / r.q(c.x[i], c.y[i]);
  const auto [low, high] = std::ranges::minmax(share);
  if (!(low > 0 && high - low <= same_surface * high)) return std::nullopt;
  return share[0];
}

}  // namespace

Caster caster_of(const Triangle& seen_by_light) {
  Caster out;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& v = seen_by_light.v[i];
    out.x[i] = v.x;
    out.y[i] = v.y;
    out.q[i] = 1 / v.s;
  }
  return out;
}

Receiver receiver_at(const std::array<std::array<double, 3>, 3>& xyw, const std::array<double, 3>& weights) {
  std::array<double, 3> a{}, b{}, p{};
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = xyw[1][k] - xyw[0][k];
    b[k] = xyw[2][k] - xyw[0][k];
    for (std::size_t i = 0; i < 3; ++i) p[k] += weights[i] * xyw[i][k];
  }
  const std::array<double, 3> n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                a[0] * b[1] - a[1] * b[0]};
  const double d = n[0] * xyw[0][0] + n[1] * xyw[0][1] + n[2] * xyw[0][2];
  return {p[0] / p[2], p[1] / p[2], n[0] / d, n[1] / d, n[2] / d};
}

struct ShadowRays::Tree : BoxTree {
  using BoxTree::BoxTree;
};

ShadowRays::ShadowRays(std::span<const Caster> casters) : casters_(casters.begin(), casters.end()) {
  std::vector<BoxTree::Entry> entries;
  for (std::size_t i = 0; i < casters_.size(); ++i) {
    const auto [x_low, x_high] = std::ranges::minmax(casters_[i].x);
    const auto [y_low, y_high] = std::ranges::minmax(casters_[i].y);
    entries.emplace_back(BoxTree::Box{{x_low, y_low}, {x_high, y_high}}, static_cast<std::uint32_t>(i));
  }
  tree_ = std::make_unique<Tree>(entries);
}
ShadowRays::~ShadowRays() = default;

Lit ShadowRays::at(const Receiver& r, double reach, double margin) const {
  const Square square{r.x, r.y, reach};
  const std::vector<BoxTree::Entry> found =
      tree_->touching(BoxTree::Box{{r.x - reach, r.y - reach}, {r.x + reach, r.y + reach}});
  // The surface itself, and what the comparison takes for it where that is farther.
  double share = 1;
  double least_apart = HUGE_VAL;
  for (const auto& [box, index] : found) {
    if (!contains(casters_[index], r.x, r.y)) continue;
    const auto of_caster = share_of(r, casters_[index]);
    if (!of_caster || std::abs(1 - *of_caster) >= least_apart) continue;
    least_apart = std::abs(1 - *of_caster);
    share = std::min(1.0, *of_caster);
  }
  const double shift = std::min(r.shift, 0.0);
  const double least = same_plane * std::abs(r.q(r.x, r.y));
  bool some_nearer = false;
  std::vector<const Caster*> covering;  // nearer by the margin all over the square
  for (const auto& [box, index] : found) {
    const Caster& c = casters_[index];
    Polygon polygon;
    for (std::size_t i = 0; i < 3; ++i) {
      const double q = r.q(c.x[i], c.y[i]);
      polygon.push_back({c.x[i], c.y[i], c.q[i] - (share * q + shift), c.q[i] - (q + r.shift)});
    }
    polygon = square.cut(std::move(polygon));
    if (polygon.empty()) continue;
    const double high = std::ranges::max(polygon, {}, &Corner2::above).above;
    const double low = std::ranges::min(polygon, {}, &Corner2::nearer).nearer;
    if (c.vanishes && high > -margin) return Lit::unknown;
    if (!(high + c.excess > least)) continue;
    some_nearer = true;
    if (low >= margin) covering.push_back(&c);
  }
  if (!some_nearer) return Lit::lit;
  // From the one at the point on, over every side that is in the square. With none at an end, nothing of the
  // square is open.
  std::vector<const Caster*> reached;
  for (const Caster* c : covering) {
    if (contains(*c, r.x, r.y)) {
      reached.push_back(c);
      break;
    }
  }
  if (reached.empty()) return Lit::open;
  for (std::size_t at = 0; at < reached.size(); ++at) {
    const Caster& c = *reached[at];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = (i + 1) % 3;
      if (square.cut({{c.x[i], c.y[i], 0, 0}, {c.x[k], c.y[k], 0, 0}}).empty()) continue;
      const auto next = std::ranges::find_if(covering, [&](const Caster* b) { return goes_on(c, i, *b); });
      if (next == covering.end()) return Lit::open;
      if (std::ranges::find(reached, *next) == reached.end()) reached.push_back(*next);
    }
  }
  return Lit::dark;
}

}  // namespace bitspan::golden
