// SPDX-License-Identifier: Apache-2.0
#include "golden/surface.hpp"

#include <cmath>
#include <vector>

#include "config/modes.hpp"
#include "golden/quantize.hpp"

namespace bitspan {

namespace {

// In the order of the edge walk.
IdealTriangle snapped(const Config& config, const Triangle& triangle) {
  using Corner = IdealTriangle::Corner;
  const golden::Quantizer<long double> snap(config.coordinate_format());
  IdealTriangle out;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& in = triangle.v[i];
    Corner& corner = out.v[i];
    corner.x = snap.raw(snap(in.x));
    corner.y = snap.raw(snap(in.y));
    corner.s = in.s;
    corner.u = in.u;
    corner.v = in.v;
    corner.given = static_cast<const Attributes&>(in);
    corner.place = static_cast<int>(i);
    std::copy(in.c.begin(), in.c.end(), corner.c.begin());
  }
  std::stable_sort(out.v.begin(), out.v.end(),
                   [](const Corner& a, const Corner& b) { return a.y < b.y || (a.y == b.y && a.x < b.x); });
  out.subpixel_bits = config.subpixel_bits;
  out.texture = triangle.texture;
  return out;
}

}  // namespace

std::optional<IdealTriangle> ideal_triangle(const Config& config, const Triangle& triangle) {
  IdealTriangle out = snapped(config, triangle);
  const golden::Wide area =
      golden::area_of(golden::point_of(out.v[0]), golden::point_of(out.v[1]), golden::point_of(out.v[2]));
  if (area == 0) return std::nullopt;
  out.mid_right = area > 0;
  return out;
}

IdealLine ideal_line(const Config& config, const Triangle& line) {
  IdealLine out;
  out.shape = snapped(config, line);
  const auto pixel = [&](std::int64_t at) { return at >> config.subpixel_bits; };
  const IdealTriangle::Corner& from = out.shape.v[0];
  const IdealTriangle::Corner& to = out.shape.v[2];
  const std::int64_t x = pixel(from.x), y = pixel(from.y);
  const std::int64_t dx = pixel(to.x) - x, dy = pixel(to.y) - y;  // dy >= 0
  const std::int64_t n = std::max(std::abs(dx), dy);
  for (std::int64_t i = 0; i <= n; ++i) {
    // The nearest pixel to the true line, the one with the larger coordinate of two that are as near.
    const auto near = [&](std::int64_t d) {
      const std::int64_t twice = 2 * d * i + n;
      const std::int64_t down = twice / (2 * n);
      return twice < 0 && down * 2 * n != twice ? down - 1 : down;
    };
    out.pixels.push_back({n == 0 ? x : x + near(dx), n == 0 ? y : y + near(dy), {{n - i, 0, i}, n}});
    if (n == 0) out.pixels.back().weight = {{1, 0, 0}, 1};
  }
  return out;
}

bool ideal_covers(const Config& config, const IdealTriangle& triangle, std::int64_t x, std::int64_t y) {
  return golden::covers(triangle, golden::areas_at(triangle, golden::centre_of(triangle, x, y)),
                        config.fill_rule);
}

namespace golden {

Point centre_of(const IdealTriangle& t, std::int64_t x, std::int64_t y) {
  const std::int64_t pixel = std::int64_t{1} << t.subpixel_bits;
  return {(2 * x + 1) * pixel, (2 * y + 1) * pixel};
}
Point point_of(const IdealTriangle::Corner& c) { return {2 * c.x, 2 * c.y}; }

Wide area_of(Point a, Point b, Point c) {
  return Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x);
}

Areas areas_at(const IdealTriangle& t, Point p) {
  const Point a = point_of(t.v[0]);
  const Point b = point_of(t.v[1]);
  const Point c = point_of(t.v[2]);
  return {{area_of(b, c, p), area_of(c, a, p), area_of(a, b, p)}, area_of(a, b, c)};
}

namespace {

// Inside by the fill rule, seen from the edge from a to b of a triangle whose area has the sign of `whole`.
bool on_inner_side(Wide part, Wide whole, Point a, Point b, FillRule rule) {
  const bool positive = whole > 0;
  if (part != 0) return (part > 0) == positive;
  if (owns_every_edge(rule)) return true;
  // The centre lies on the edge: inside on a left edge, or on a top one. The distance to the inner side grows
  // with x by (a.y - b.y) and with y by (b.x - a.x), in a triangle of positive area.
  const std::int64_t right = positive ? a.y - b.y : b.y - a.y;
  const std::int64_t down = positive ? b.x - a.x : a.x - b.x;
  return right > 0 || (right == 0 && down > 0);
}

// A whole number from 0 on, of any size: digits to the base 2^32, the lowest first.
using Natural = std::vector<std::uint32_t>;

Natural natural(Wide x) {
  Natural out;
  for (; x != 0; x >>= 32) out.push_back(static_cast<std::uint32_t>(x));
  return out;
}

Natural operator+(const Natural& a, const Natural& b) {
  Natural out;
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()) || carry != 0; ++i) {
    carry += std::uint64_t{i < a.size() ? a[i] : 0} + (i < b.size() ? b[i] : 0);
    out.push_back(static_cast<std::uint32_t>(carry));
    carry >>= 32;
  }
  return out;
}

Natural operator*(const Natural& a, const Natural& b) {
  Natural out(a.size() + b.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < b.size() || carry != 0; ++j) {
      carry += out[i + j] + std::uint64_t{a[i]} * (j < b.size() ? b[j] : 0);
      out[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  }
  while (!out.empty() && out.back() == 0) out.pop_back();
  return out;
}

std::strong_ordering compared(const Natural& a, const Natural& b) {
  if (a.size() != b.size()) return a.size() <=> b.size();
  return std::lexicographical_compare_three_way(a.rbegin(), a.rend(), b.rbegin(), b.rend());
}

// s 2^-grid, of a grid that s lies on.
Natural on_grid(long double s, int grid) {
  int exponent = 0;
  const long double mantissa = std::ldexp(std::frexp(s, &exponent), 64);
  const auto shift = static_cast<unsigned>(exponent - 64 - grid);
  Natural power(shift / 32, 0);
  power.push_back(std::uint32_t{1} << shift % 32);
  return natural(static_cast<Wide>(mantissa)) * power;
}

struct Fraction {
  Natural numerator, denominator;
};
Fraction fraction_of(const InverseDistance& q, int grid) {
  std::array<Natural, 3> s;
  for (std::size_t i = 0; i < 3; ++i) s[i] = on_grid(q.s[i], grid);
  return {
      natural(q.part[0]) * s[1] * s[2] + natural(q.part[1]) * s[0] * s[2] + natural(q.part[2]) * s[0] * s[1],
      natural(q.whole) * s[0] * s[1] * s[2]};
}

}  // namespace

bool covers(const IdealTriangle& t, const Areas& areas, FillRule rule) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Point a = point_of(t.v[(i + 1) % 3]);
    const Point b = point_of(t.v[(i + 2) % 3]);
    if (!on_inner_side(areas.part[i], areas.whole, a, b, rule)) return false;
  }
  return true;
}

PixelBox pixel_box(const IdealTriangle& t, int width, int height) {
  const auto [left, right] = std::minmax({t.v[0].x, t.v[1].x, t.v[2].x});
  return {std::max<std::int64_t>(0, left >> t.subpixel_bits),
          std::min<std::int64_t>(width - 1, right >> t.subpixel_bits),
          std::max<std::int64_t>(0, t.v[0].y >> t.subpixel_bits),
          std::min<std::int64_t>(height - 1, t.v[2].y >> t.subpixel_bits)};
}

InverseDistance inverse_distance(const IdealTriangle& t, const Areas& inside) {
  InverseDistance out;
  const bool positive = inside.whole > 0;
  out.whole = positive ? inside.whole : -inside.whole;
  for (std::size_t i = 0; i < 3; ++i) {
    out.part[i] = positive ? inside.part[i] : -inside.part[i];
    out.s[i] = t.v[i].s;
    out.value += static_cast<long double>(out.part[i]) / (static_cast<long double>(out.whole) * out.s[i]);
  }
  return out;
}

std::strong_ordering operator<=>(const InverseDistance& a, const InverseDistance& b) {
  // All terms are positive, so that no sum cancels.
  if (std::abs(a.value - b.value) > 0x1p-58L * std::max(a.value, b.value)) {
    return a.value < b.value ? std::strong_ordering::less : std::strong_ordering::greater;
  }
  int grid = std::ilogb(a.s[0]) - 63;
  for (const auto& s : {a.s, b.s}) {
    for (const long double at : s) grid = std::min(grid, std::ilogb(at) - 63);
  }
  const Fraction x = fraction_of(a, grid);
  const Fraction y = fraction_of(b, grid);
  return compared(x.numerator * y.denominator, y.numerator * x.denominator);
}

long double h_max(const Config& config) { return std::ldexp(1.0L, config.depth_bits) - 1; }

long double depth_code(const Config& config, long double s_min, long double s_max, long double q) {
  return h_max(config) * s_min * (s_max * q - 1) / (s_max - s_min);
}
long double depth_code(const Config& config, const Scene& scene, long double q) {
  return depth_code(config, scene.s_min, scene.s_max, q);
}

}  // namespace golden
}  // namespace bitspan
