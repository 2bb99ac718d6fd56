// SPDX-License-Identifier: Apache-2.0
#include "report/truth.hpp"

#include <algorithm>
#include <utility>

#include "config/keys.hpp"

namespace bitspan {
namespace {

// Whether the edge has height and crosses the centre of row y, or the row next to one that it crosses.
bool edge_near(const IdealTriangle& t, int edge, std::int64_t y) {
  const std::int64_t a = t.v[edge == 2 ? 1 : 0].y;
  const std::int64_t b = t.v[edge == 1 ? 1 : 2].y;
  const std::int64_t one = std::int64_t{1} << t.subpixel_bits;
  return a != b && y * one + one >= std::min(a, b) && y * one <= std::max(a, b);
}

}  // namespace

Config truth_config(const Config& config) {
  Config out;
  for (const Key& key : keys()) {
    if ((affected(key) & affects::ideal) != 0) copy_value(config, out, key);
  }
  return out;
}

Truth::Truth(const Config& config, const Scene& scene, std::span<const Triangle> triangles,
             std::shared_ptr<const golden::SceneLevels> levels)
    : config_(truth_config(config)), scene_(&scene), levels_(std::move(levels)) {
  if (levels_ == nullptr)
    levels_ = std::make_shared<golden::SceneLevels>(golden::scene_levels(config_, scene));
  const int k = config.subpixel_bits;
  for (const Triangle& triangle : triangles) {
    Entry& e = triangles_.emplace_back();
    e.shape = ideal_triangle(config_, triangle);
    if (!e.shape) continue;
    const IdealTriangle& t = *e.shape;
    for (int i = 0; i < 3; ++i) {
      e.vertex[static_cast<std::size_t>(i)] = ideal_at_vertex(config_, scene, t, i);
    }
    const auto box = [&](std::int64_t a, std::int64_t b, std::int64_t c, int size) {
      return std::pair{std::clamp<std::int64_t>((std::min({a, b, c}) >> k) - 1, 0, size),
                       std::clamp<std::int64_t>((std::max({a, b, c}) >> k) + 2, 0, size)};
    };
    const auto [x0, x1] = box(t.v[0].x, t.v[1].x, t.v[2].x, scene.width);
    const auto [y0, y1] = box(t.v[0].y, t.v[1].y, t.v[2].y, scene.height);
    e.y = y0;
    e.count = y1 - y0;
    e.row = rows_.size();
    e.edge = edges_.size();
    for (std::int64_t y = y0; y < y1; ++y) {
      for (int edge = 0; edge < 3; ++edge) {
        edges_.push_back(edge_near(t, edge, y) ? ideal_on_edge(config_, scene, t, edge, y) : IdealPoint{});
      }
      // A row's covered pixels follow one another: the triangle is convex.
      Row& row = rows_.emplace_back();
      row.at = fragments_.size();
      row.first = x0;
      while (row.first < x1 && !ideal_covers(config_, t, row.first, y)) ++row.first;
      for (row.end = row.first; row.end < x1 && ideal_covers(config_, t, row.end, y); ++row.end) {
        fragments_.push_back(ideal_at(config_, scene, t, row.end, y, levels_.get()));
      }
    }
  }
}

IdealPoint Truth::on_edge(std::size_t i, int edge, std::int64_t y) const {
  const Entry& e = triangles_[i];
  if (y >= e.y && y < e.y + e.count && edge_near(*e.shape, edge, y)) {
    return edges_[e.edge + 3 * static_cast<std::size_t>(y - e.y) + static_cast<std::size_t>(edge)];
  }
  return ideal_on_edge(config_, *scene_, *e.shape, edge, y);
}

Truth::Pixels Truth::covered(std::size_t i, std::int64_t y) const {
  const Entry& e = triangles_[i];
  if (y < e.y || y >= e.y + e.count) return {};
  const Row& row = rows_[e.row + static_cast<std::size_t>(y - e.y)];
  return {row.first, row.end};
}

IdealFragment Truth::at(std::size_t i, std::int64_t x, std::int64_t y) const {
  const Entry& e = triangles_[i];
  if (y >= e.y && y < e.y + e.count) {
    const Row& row = rows_[e.row + static_cast<std::size_t>(y - e.y)];
    if (x >= row.first && x < row.end) return fragments_[row.at + static_cast<std::size_t>(x - row.first)];
  }
  return ideal_at(config_, *scene_, *e.shape, x, y, levels_.get());
}

std::size_t Truth::bytes() const {
  return triangles_.capacity() * sizeof(Entry) + rows_.capacity() * sizeof(Row) +
         edges_.capacity() * sizeof(IdealPoint) + fragments_.capacity() * sizeof(IdealFragment);
}

}  // namespace bitspan
