// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/delaunay.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace bitspan {
namespace {

using Wide = __int128;

constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();

constexpr int next(int k) { return k == 2 ? 0 : k + 1; }
constexpr int before(int k) { return k == 0 ? 2 : k - 1; }
std::size_t index(int k) { return static_cast<std::size_t>(k); }

// Twice the area of a, b, c; coordinates differ by less than 2^31.
std::int64_t area_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
         (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

// The place of a point along Hilbert's curve, which has 2^30 steps along each axis.
std::uint64_t hilbert(const GridPoint& p) {
  std::uint32_t x = static_cast<std::uint32_t>(p.x + grid_point_limit);
  std::uint32_t y = static_cast<std::uint32_t>(p.y + grid_point_limit);
  std::uint64_t place = 0;
  for (std::uint32_t s = 1U << 30; s > 0; s >>= 1U) {
    const std::uint32_t right = (x & s) != 0 ? 1 : 0, lower = (y & s) != 0 ? 1 : 0;
    place = 4 * place + ((3 * right) ^ lower);
    if (lower == 0) {
      if (right == 1) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

}  // namespace

int side_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const std::int64_t area = area_of(a, b, c);
  return area > 0 ? 1 : area < 0 ? -1 : 0;
}

bool is_in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
  const auto lifted = [&](const GridPoint& p) {
    const std::int64_t x = std::int64_t{p.x} - d.x, y = std::int64_t{p.y} - d.y;
    return Wide{x * x + y * y};
  };
  const Wide inside =
      lifted(a) * area_of(d, b, c) + lifted(b) * area_of(d, c, a) + lifted(c) * area_of(d, a, b);
  if (inside != 0) return inside > 0;
  const GridPoint& greatest = std::max({a, b, c, d});
  if (greatest == d) return false;
  // The greatest one is lifted: d is below the plane where it lies on the greatest one's side of the other
  // two.
  if (greatest == c) return area_of(a, b, d) > 0;
  return greatest == b ? area_of(c, a, d) > 0 : area_of(b, c, d) > 0;
}

Delaunay::Delaunay(std::vector<GridPoint> points) : points_(std::move(points)) {
  const auto is_legal = [&](const GridPoint& p) {
    return p.x >= at(0).x && p.x <= at(2).x && p.y >= at(0).y && p.y <= at(2).y;
  };
  if (points_.size() < 4 || points_.size() > std::numeric_limits<std::int32_t>::max() / 2 ||
      at(0).x < -grid_point_limit || at(0).y < -grid_point_limit || at(2).x > grid_point_limit ||
      at(2).y > grid_point_limit || at(0).x >= at(2).x || at(0).y >= at(2).y ||
      at(1) != GridPoint{at(2).x, at(0).y} || at(3) != GridPoint{at(0).x, at(2).y} ||
      !std::ranges::all_of(points_, is_legal)) {
    throw std::invalid_argument("Delaunay: the points are not those of a rectangle");
  }
  triangle_of_.assign(points_.size(), -1);
  triangles_.reserve(2 * points_.size());
  const std::int32_t t = new_triangle(), u = new_triangle();
  // The diagonal that the rule of four points on a circle asks for.
  if (is_in_circle(at(0), at(1), at(2), at(3))) {
    set(t, {0, 1, 3}, {u, -1, -1});
    set(u, {1, 2, 3}, {-1, t, -1});
  } else {
    set(t, {0, 1, 2}, {-1, u, -1});
    set(u, {0, 2, 3}, {-1, -1, t});
  }
  size_ = 4;
}

std::int32_t Delaunay::new_triangle() {
  ++triangle_count_;
  if (free_.empty()) {
    triangles_.emplace_back();
    return static_cast<std::int32_t>(triangles_.size()) - 1;
  }
  const std::int32_t t = free_.back();
  free_.pop_back();
  return t;
}

void Delaunay::free_triangle(std::int32_t t) {
  --triangle_count_;
  tri(t).corner[0] = no_point;
  free_.push_back(t);
}

void Delaunay::set(std::int32_t t, std::array<std::uint32_t, 3> corners,
                   std::array<std::int32_t, 3> neighbours) {
  tri(t) = {corners, neighbours};
  for (const std::uint32_t corner : corners) triangle_of_[corner] = t;
  last_ = t;
}

// In triangle t, where there is one, what lies behind the edge from a to b.
void Delaunay::replace_neighbour(std::int32_t t, std::uint32_t a, std::uint32_t b, std::int32_t by) {
  if (t < 0) return;
  Triangle& triangle = tri(t);
  for (int k = 0; k < 3; ++k) {
    if (triangle.corner[index(next(k))] == a && triangle.corner[index(before(k))] == b) {
      triangle.neighbour[index(k)] = by;
      return;
    }
  }
}

// Gives the four corners of t and of its neighbour k the other diagonal. Corner k of t is in both afterwards.
void Delaunay::flip(std::int32_t t, int k) {
  const Triangle old = tri(t);
  const std::int32_t u = old.neighbour[index(k)];
  const Triangle other = tri(u);
  const std::uint32_t a = old.corner[index(k)], b = old.corner[index(next(k))],
                      c = old.corner[index(before(k))];
  int m = 0;
  while (other.neighbour[index(m)] != t || other.corner[index(next(m))] != c) ++m;
  const std::uint32_t d = other.corner[index(m)];
  // Behind c-a and a-b of t, and behind b-d and d-c of u.
  const std::int32_t ca = old.neighbour[index(next(k))], ab = old.neighbour[index(before(k))];
  const std::int32_t bd = other.neighbour[index(next(m))], dc = other.neighbour[index(before(m))];
  set(u, {a, d, c}, {dc, ca, t});
  set(t, {a, b, d}, {bd, u, ab});
  replace_neighbour(ca, a, c, u);
  replace_neighbour(bd, d, b, t);
}

// The edges of a triangle that may have to be flipped.
void Delaunay::suspect(std::int32_t t) {
  const std::array<std::uint32_t, 3> corner = tri(t).corner;
  for (int k = 0; k < 3; ++k) suspects_.push_back({t, corner[index(next(k))], corner[index(before(k))]});
}

// Flips edges until every circle is empty.
void Delaunay::settle() {
  while (!suspects_.empty()) {
    const Suspect edge = suspects_.back();
    suspects_.pop_back();
    const Triangle& triangle = tri(edge.triangle);
    if (triangle.corner[0] == no_point) continue;
    int k = 0;
    while (k < 3 &&
           (triangle.corner[index(next(k))] != edge.a || triangle.corner[index(before(k))] != edge.b))
      ++k;
    // An edge of a triangle that was flipped since is suspect under its new one.
    if (k == 3 || triangle.neighbour[index(k)] < 0) continue;
    const std::int32_t u = triangle.neighbour[index(k)];
    const Triangle& other = tri(u);
    int m = 0;
    while (other.corner[index(m)] == edge.a || other.corner[index(m)] == edge.b) ++m;
    if (!is_in_circle(at(triangle.corner[0]), at(triangle.corner[1]), at(triangle.corner[2]),
                      at(other.corner[index(m)]))) {
      continue;
    }
    flip(edge.triangle, k);
    suspect(edge.triangle);
    suspect(u);
  }
}

// The triangle in which p lies. The circles are empty, so the walk does not come back to where it was.
std::int32_t Delaunay::locate(const GridPoint& p) const {
  std::int32_t t = last_;
  while (true) {
    const Triangle& triangle = tri(t);
    int k = 0;
    while (k < 3 &&
           area_of(at(triangle.corner[index(next(k))]), at(triangle.corner[index(before(k))]), p) >= 0)
      ++k;
    if (k == 3) return t;
    t = triangle.neighbour[index(k)];
  }
}

void Delaunay::insert(std::uint32_t point) {
  if (has(point)) throw std::invalid_argument("Delaunay: the point is in already");
  const GridPoint& p = at(point);
  const std::int32_t t = locate(p);
  const Triangle hit = tri(t);
  // The edges around the hole that the triangle leaves, or that both triangles at an edge leave. On the edge
  // of the rectangle the hole is open.
  links_.clear();
  int on = -1;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t a = hit.corner[index(next(k))], b = hit.corner[index(before(k))];
    if (at(a) == p) throw std::invalid_argument("Delaunay: two points are equal");
    if (area_of(at(a), at(b), p) == 0) on = k;
  }
  const int first = on < 0 ? 0 : next(on);  // the edge behind the one that is hit
  for (int i = 0, k = first; i < (on < 0 ? 3 : 2); ++i, k = next(k)) {
    links_.push_back({hit.corner[index(next(k))], hit.corner[index(before(k))], hit.neighbour[index(k)], -1});
  }
  const std::int32_t u = on < 0 ? -1 : hit.neighbour[index(on)];
  if (u >= 0) {
    const Triangle other = tri(u);
    int m = 0;
    while (other.neighbour[index(m)] != t || other.corner[index(next(m))] != hit.corner[index(before(on))])
      ++m;
    for (int i = 0, k = next(m); i < 2; ++i, k = next(k)) {
      links_.push_back(
          {other.corner[index(next(k))], other.corner[index(before(k))], other.neighbour[index(k)], -1});
    }
    free_triangle(u);
  }
  free_triangle(t);
  for (Link& link : links_) link.triangle = new_triangle();
  const bool is_open = on >= 0 && u < 0;
  const std::size_t n = links_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Link& link = links_[i];
    const std::int32_t after = is_open && i + 1 == n ? -1 : links_[(i + 1) % n].triangle;
    const std::int32_t earlier = is_open && i == 0 ? -1 : links_[(i + n - 1) % n].triangle;
    set(link.triangle, {point, link.a, link.b}, {link.behind, after, earlier});
    replace_neighbour(link.behind, link.b, link.a, link.triangle);
    suspects_.push_back({link.triangle, link.a, link.b});
  }
  ++size_;
  settle();
}

// The edges opposite to a point, in the positive direction; of one on an edge of the rectangle from edge to
// edge.
void Delaunay::star(std::uint32_t point, std::vector<Link>& out) const {
  out.clear();
  const auto corner_of = [&](std::int32_t t) {
    const auto& corner = tri(t).corner;
    return static_cast<int>(std::ranges::find(corner, point) - corner.begin());
  };
  const std::int32_t first = triangle_of_[point];
  std::int32_t t = first;
  // Back to the edge of the rectangle, where it lies there.
  while (true) {
    const std::int32_t earlier = tri(t).neighbour[index(before(corner_of(t)))];
    if (earlier < 0) break;
    t = earlier;
    if (t == first) break;
  }
  const std::int32_t start = t;
  do {
    const Triangle& triangle = tri(t);
    const int k = corner_of(t);
    out.push_back({triangle.corner[index(next(k))], triangle.corner[index(before(k))],
                   triangle.neighbour[index(k)], t});
    t = triangle.neighbour[index(next(k))];
  } while (t >= 0 && t != start);
}

bool Delaunay::is_on_edge(std::uint32_t point) const {
  const GridPoint& p = at(point);
  return p.x == at(0).x || p.x == at(2).x || p.y == at(0).y || p.y == at(2).y;
}

void Delaunay::remove(std::uint32_t point, std::vector<std::array<std::uint32_t, 3>>* hole) {
  if (point < 4 || !has(point)) throw std::invalid_argument("Delaunay: no point that can be taken out");
  const GridPoint& p = at(point);
  // Triangles outside of the hole stay, and those in it have the numbers of the ones before.
  if (hole != nullptr) star(point, links_);
  const std::size_t least = is_on_edge(point) ? 2 : 3;
  // Ears of the polygon around the point are cut off until no more can be. Any polygon with an edge more than
  // the last one has two ears, and the point is in one of them at most, or on the line between both.
  while (true) {
    star(point, scratch_);
    const std::size_t n = scratch_.size();
    if (n == least) break;
    std::size_t i = least == 2 ? 1 : 0;
    for (; i < n; ++i) {
      const Link &one = scratch_[(i + n - 1) % n], &two = scratch_[i];
      if (area_of(at(one.a), at(two.a), at(two.b)) > 0 && area_of(at(one.a), at(two.b), p) > 0) break;
    }
    if (i == n) break;  // four neighbours, and the point is between two of them
    // The edge between the point and two.a goes; the triangle before it is the ear afterwards.
    const std::int32_t t = scratch_[(i + n - 1) % n].triangle;
    const auto& corner = tri(t).corner;
    const auto k = static_cast<int>(std::ranges::find(corner, scratch_[(i + n - 1) % n].a) - corner.begin());
    flip(t, k);
    suspect(t);
  }
  const std::vector<Link>& rest = scratch_;
  const std::size_t n = rest.size();
  for (const Link& link : rest) free_triangle(link.triangle);
  const auto close = [&](std::int32_t t, const Link& link) {
    replace_neighbour(link.behind, link.b, link.a, t);
  };
  const std::int32_t t = new_triangle();
  if (n == 4) {
    // Two triangles on both sides of the line on which the point lies.
    const std::size_t s = area_of(at(rest[0].a), p, at(rest[2].a)) == 0 ? 0 : 1;
    const Link &a = rest[s], &b = rest[s + 1], &c = rest[(s + 2) % 4], &d = rest[(s + 3) % 4];
    const std::int32_t u = new_triangle();
    set(t, {a.a, b.a, c.a}, {b.behind, u, a.behind});
    set(u, {a.a, c.a, d.a}, {c.behind, d.behind, t});
    close(t, a);
    close(t, b);
    close(u, c);
    close(u, d);
    suspect(u);
  } else {
    // On the edge of the rectangle nothing lies behind the third side.
    const std::int32_t third = n == 3 ? rest[2].behind : -1;
    set(t, {rest[0].a, rest[1].a, rest[1].b}, {rest[1].behind, third, rest[0].behind});
    for (const Link& link : rest) close(t, link);
  }
  suspect(t);
  triangle_of_[point] = -1;
  --size_;
  settle();
  if (hole == nullptr) return;
  hole->clear();
  for (const Link& link : links_) {
    if (tri(link.triangle).corner[0] != no_point) hole->push_back(tri(link.triangle).corner);
  }
}

void Delaunay::insert_all(const WorkProgress& progress) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(points_.size());
  for (std::uint32_t i = 4; i < points_.size(); ++i) {
    if (!has(i)) order.emplace_back(hilbert(at(i)), i);
  }
  std::ranges::sort(order);
  for (const auto& [place, point] : order) {
    insert(point);
    if (progress && size_ % 1024 == 0) progress(size_, points_.size());
  }
}

std::vector<std::array<std::uint32_t, 3>> Delaunay::triangles() const {
  std::vector<std::array<std::uint32_t, 3>> out;
  out.reserve(triangle_count_);
  for (const Triangle& triangle : triangles_) {
    if (triangle.corner[0] == no_point) continue;
    auto corner = triangle.corner;
    std::rotate(corner.begin(), std::ranges::min_element(corner), corner.end());
    out.push_back(corner);
  }
  std::ranges::sort(out);
  return out;
}

void Delaunay::neighbours(std::uint32_t point, std::vector<std::uint32_t>& out) const {
  std::vector<Link> links;
  star(point, links);
  out.clear();
  for (const Link& link : links) out.push_back(link.a);
  if (links.back().b != links.front().a) out.push_back(links.back().b);
}

void voronoi_cell(const Delaunay& points, std::uint32_t point, std::vector<std::array<double, 2>>& out) {
  const auto& all = points.points();
  out.clear();
  for (std::size_t i = 0; i < 4; ++i)
    out.push_back({static_cast<double>(all[i].x), static_cast<double>(all[i].y)});
  std::vector<std::uint32_t> around;
  points.neighbours(point, around);
  std::vector<std::array<double, 2>> cut;
  for (const std::uint32_t other : around) {
    // How much farther a place is from the other point, by a linear function of it.
    const double dx = 1.0 * all[other].x - all[point].x, dy = 1.0 * all[other].y - all[point].y;
    const double mx = (1.0 * all[other].x + all[point].x) / 2, my = (1.0 * all[other].y + all[point].y) / 2;
    const auto inside = [&](const std::array<double, 2>& q) { return (mx - q[0]) * dx + (my - q[1]) * dy; };
    cut.clear();
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto &a = out[i], &b = out[(i + 1) % out.size()];
      const double at_a = inside(a), at_b = inside(b);
      if (at_a >= 0) cut.push_back(a);
      if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
        const double part = at_a / (at_a - at_b);
        cut.push_back({a[0] + (b[0] - a[0]) * part, a[1] + (b[1] - a[1]) * part});
      }
    }
    out.swap(cut);
  }
}

}  // namespace bitspan
