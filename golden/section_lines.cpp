// SPDX-License-Identifier: Apache-2.0
#include "golden/section_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace bitspan::golden {

namespace {

// Where a side of a face crosses a level of 1/S. Its ends are in the order of the edge walk, so that both
// faces of a side have the same point.
Point crossing_of(const IdealTriangle::Corner& a, const IdealTriangle::Corner& b, long double q, int bits) {
  const long double part = (q - 1 / a.s) / (1 / b.s - 1 / a.s);
  const auto along = [&](std::int64_t from, std::int64_t to) {
    const auto first = static_cast<long double>(from);
    const long double at = first + part * (static_cast<long double>(to) - first);
    return static_cast<std::int64_t>(std::llround(std::ldexp(at, line_bits - bits)));
  };
  return {along(a.x, b.x), along(a.y, b.y)};
}

// Adds what a face has at a level.
void add_part(const OracleFace& face, long double q, std::vector<LinePart>& to) {
  const auto& v = face.shape.v;
  std::vector<Point> ends;
  for (const auto& [i, j] : {std::pair<std::size_t, std::size_t>{0, 1}, {1, 2}, {0, 2}}) {
    if ((1 / v[i].s > q) != (1 / v[j].s > q)) {
      ends.push_back(crossing_of(v[i], v[j], q, face.shape.subpixel_bits));
    }
  }
  if (ends.size() != 2 || ends[0].x == ends[1].x) return;
  if (ends[0].x > ends[1].x) std::swap(ends[0], ends[1]);
  to.push_back({ends[0], ends[1], face.index});
}

std::string overlap_of(const std::vector<LinePart>& parts) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i - 1].b.x <= parts[i].a.x) continue;
    return fmt::format("triangles {} and {} lie over each other at one distance; {}", parts[i - 1].triangle,
                       parts[i].triangle, no_height_field);
  }
  return "";
}

SectionLine side_edge(Point a, Point b) {
  SectionLine out{true, {}};
  if (a.x > b.x) std::swap(a, b);
  if (a.x != b.x) out.parts.push_back({a, b, -1});
  return out;
}

}  // namespace

int compared(const Ratio& a, const Ratio& b) { return (a.n * b.d - b.n * a.d).sign(); }

Ratio height_at(const LinePart& part, std::int64_t x) {
  const Integer d = part.b.x - part.a.x;
  return {d * part.a.y + Integer(part.b.y - part.a.y) * (x - part.a.x), d};
}

SectionLines section_lines(std::span<const OracleFace> faces, int count, bool side_edges) {
  long double far = std::numeric_limits<long double>::infinity();
  long double near = 0;
  for (const OracleFace& face : faces) {
    for (const IdealTriangle::Corner& corner : face.shape.v) {
      far = std::min(far, 1 / corner.s);
      near = std::max(near, 1 / corner.s);
    }
  }
  SectionLines out;
  if (!(far < near)) return out;
  const auto level = [&](std::int64_t k) {
    return near - (near - far) * (static_cast<long double>(2 * k + 1) / static_cast<long double>(2 * count));
  };
  std::vector<std::vector<LinePart>> sections(static_cast<std::size_t>(count));
  for (const OracleFace& face : faces) {
    const auto [least, most] =
        std::minmax({1 / face.shape.v[0].s, 1 / face.shape.v[1].s, 1 / face.shape.v[2].s});
    const auto number = [&](long double q) {
      return static_cast<std::int64_t>(std::floor((near - q) / (near - far) * count));
    };
    const std::int64_t first = std::max<std::int64_t>(0, number(most) - 1);
    const std::int64_t last = std::min<std::int64_t>(count - 1, number(least) + 1);
    for (std::int64_t k = first; k <= last; ++k)
      add_part(face, level(k), sections[static_cast<std::size_t>(k)]);
  }
  std::optional<std::array<Point, 2>> before;
  for (std::vector<LinePart>& parts : sections) {
    if (parts.empty()) continue;
    std::ranges::sort(parts, {}, [](const LinePart& part) { return part.a.x; });
    if (out.fault.empty()) out.fault = overlap_of(parts);
    const std::array<Point, 2> ends{parts.front().a, parts.back().b};
    if (side_edges && before) out.lines.push_back(side_edge((*before)[0], ends[0]));
    out.lines.push_back({false, std::move(parts)});
    if (side_edges && before) out.lines.push_back(side_edge((*before)[1], ends[1]));
    before = ends;
  }
  return out;
}

int section_count(const Scene& scene) { return std::max(2, scene.height / 8); }

std::string refuses_lines(const Config& config, const Scene& scene) {
  return section_lines(faces_of_scene(config, scene), section_count(scene)).fault;
}

}  // namespace bitspan::golden
