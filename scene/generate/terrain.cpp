// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/terrain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

#include "config/config.hpp"

namespace bitspan {
namespace {

constexpr double vertices_limit = 4294967295.0;

// Where the vertices of one row are, in steps from the left edge.
struct GridRows {
  GridKind kind;
  std::uint64_t columns;

  bool is_shifted(std::uint64_t row) const { return kind == GridKind::equilateral && row % 2 == 1; }
  // A shifted row has both ends, too, so that the edge is straight.
  std::uint64_t count(std::uint64_t row) const { return columns + (is_shifted(row) ? 1 : 0); }
  double place(std::uint64_t row, std::uint64_t i) const {
    const auto last = static_cast<double>(columns - 1);
    const auto at = static_cast<double>(i);
    return is_shifted(row) ? std::clamp(at - 0.5, 0.0, last) : at;
  }
};

// Calls face(a, b, c) with the triangles between a row of vertices from `above` and one from `below`,
// counterclockwise seen from above.
template <class Face>
void faces_between(const GridRows& rows, std::uint64_t row, std::uint32_t above, std::uint32_t below,
                   const Face& face) {
  const auto n = static_cast<std::uint32_t>(rows.count(row)),
             m = static_cast<std::uint32_t>(rows.count(row + 1));
  // One vertex further above and below in turn; the longer row first.
  std::uint32_t i = 0, j = 0;
  while (i + 1 < n || j + 1 < m) {
    const bool is_below = i + 1 >= n || (j + 1 < m && (m > n ? j <= i : j < i));
    if (is_below) {
      face(above + i, below + j, below + j + 1);
      ++j;
    } else {
      face(above + i, below + j, above + i + 1);
      ++i;
    }
  }
}

// The squares of ring_mesh, and its triangles one after the other.
class Rings {
 public:
  Rings(int columns, int rows, const RingOptions& options)
      : columns_(columns), rows_(rows), options_(options) {
    while (1 << top_ < std::max(columns, rows) - 1) ++top_;
  }

  RingMesh make() {
    visit(0, 0, top_);
    for (int level = 0; level <= top_; ++level)
      out_.levels += has_level_[static_cast<std::size_t>(level)] ? 1 : 0;
    return std::move(out_);
  }

 private:
  bool is_inside(int i, int j) const { return i >= 0 && j >= 0 && i < columns_ - 1 && j < rows_ - 1; }
  // Whether the square at (i, j) of 2^level samples is divided.
  bool is_divided(int i, int j, int level) const {
    if (level == 0) return false;
    const double width = 1 << level;
    const double dx = std::max({i - options_.x, options_.x - i - width, 0.0});
    const double dz = std::max({j - options_.z, options_.z - j - width, 0.0});
    return std::max(dx, dz) < options_.near / 2 * width;
  }
  void visit(int i, int j, int level) {
    if (!is_inside(i, j)) return;  // all of it lies beyond the edge
    if (!is_divided(i, j, level)) return square(i, j, level);
    const int half = 1 << (level - 1);
    visit(i, j, level - 1);
    visit(i + half, j, level - 1);
    visit(i, j + half, level - 1);
    visit(i + half, j + half, level - 1);
  }
  // The corners of a square and, where a neighbour is finer, the middles between them, counterclockwise seen
  // from above: the left edge downward, the lower one, the right one upward, the upper one.
  void square(int i, int j, int level) {
    has_level_[static_cast<std::size_t>(level)] = true;
    const int width = 1 << level, half = width / 2;
    const auto is_finer = [&](int ni, int nj) { return is_inside(ni, nj) && is_divided(ni, nj, level); };
    std::array<std::uint32_t, 8> around{};
    std::size_t count = 0;
    const auto add = [&](int x, int z) { around[count++] = vertex(i + x, j + z); };
    add(0, 0);
    if (is_finer(i - width, j)) add(0, half);
    add(0, width);
    if (is_finer(i, j + width)) add(half, width);
    add(width, width);
    if (is_finer(i + width, j)) add(width, half);
    add(width, 0);
    if (is_finer(i, j - width)) add(half, 0);
    if (count == 4) {
      triangle(around[0], around[1], around[3]);
      triangle(around[3], around[1], around[2]);
      return;
    }
    const std::uint32_t middle = vertex(i + half, j + half);
    for (std::size_t k = 0; k < count; ++k) triangle(middle, around[k], around[(k + 1) % count]);
  }
  std::uint32_t vertex(int i, int j) {
    const int x = std::min(i, columns_ - 1), z = std::min(j, rows_ - 1);
    const auto key =
        static_cast<std::uint64_t>(z) * static_cast<std::uint64_t>(columns_) + static_cast<std::uint64_t>(x);
    const auto [entry, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(out_.vertices.size()));
    if (is_new) out_.vertices.push_back({x, z});
    return entry->second;
  }
  // What is pressed onto the edge has no area, and is left out.
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto &p = out_.vertices[a], &q = out_.vertices[b], &r = out_.vertices[c];
    const std::int64_t area =
        std::int64_t{q[0] - p[0]} * (r[1] - p[1]) - std::int64_t{q[1] - p[1]} * (r[0] - p[0]);
    if (area != 0) out_.triangles.push_back({a, b, c});
  }

  int columns_, rows_;
  RingOptions options_;
  int top_ = 0;  // 2^top_ samples are the whole field
  RingMesh out_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::array<bool, 32> has_level_{};
};

}  // namespace

PlacedField::PlacedField(const HeightField& field, const TerrainPlace& place) : field_(field), place_(place) {
  const auto [low, high] = std::ranges::minmax_element(field.heights);
  lowest_ = *low;
  highest_ = *high;
}

Vec3 PlacedField::position(double x, double height, double z) const {
  return {(x - (field_.columns - 1) / 2.0) * place_.spacing, (height - lowest_) * place_.vertical,
          (z - (field_.rows - 1) / 2.0) * place_.spacing};
}

void PlacedField::write(ObjWriter& out, double x, double height, double z) const {
  const double range = highest_ - lowest_;
  std::optional<double> shade;
  if (place_.shade) {
    // Of three digits, which is finer than a colour's code.
    const double part = range > 0 ? std::clamp((height - lowest_) / range, 0.0, 1.0) : 0.5;
    shade = std::round(1000 * (0.45 + 0.5 * part)) / 1000;
  }
  out.vertex(position(x, height, z), shade);
}

MeshCounts write_grid(const HeightField& field, const TerrainPlace& place, const GridOptions& grid,
                      ObjWriter& out, const WorkProgress& progress) {
  const bool is_equilateral = grid.kind == GridKind::equilateral;
  const double width = field.columns - 1, depth = field.rows - 1;
  const int columns = grid.columns > 0 ? grid.columns : field.columns;
  const double step = width / (columns - 1);
  const double row_step = is_equilateral ? step * std::sqrt(0.75) : step;
  const double rows_real = std::max(std::round(depth / row_step) + 1, 2.0);
  if (rows_real * (columns + 1.0) > vertices_limit) {
    throw InputError(
        fmt::format("a grid of {} x {} vertices; expected at most 2^32 - 1 in all", columns, rows_real));
  }
  const auto rows = static_cast<std::uint64_t>(rows_real);
  const GridRows vertices{grid.kind, static_cast<std::uint64_t>(columns)};
  const PlacedField placed(field, place);
  MeshCounts counts;
  for (std::uint64_t j = 0; j < rows; ++j) {
    // Whole where they can be, so that samples are met.
    const double z = static_cast<double>(j) * depth / static_cast<double>(rows - 1);
    for (std::uint64_t i = 0; i < vertices.count(j); ++i) {
      placed.write(out, vertices.place(j, i) * width / (columns - 1), z);
    }
    counts.vertices += vertices.count(j);
    if (progress) progress(j, 2 * rows);
  }
  std::uint32_t above = 0;
  for (std::uint64_t j = 0; j + 1 < rows; ++j) {
    const std::uint32_t below = above + static_cast<std::uint32_t>(vertices.count(j));
    faces_between(vertices, j, above, below, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      out.face(std::array{a, b, c});
      ++counts.triangles;
    });
    above = below;
    if (progress) progress(rows + j, 2 * rows);
  }
  return counts;
}

RingMesh ring_mesh(int columns, int rows, const RingOptions& rings) {
  return Rings(columns, rows, rings).make();
}

}  // namespace bitspan
