// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/patch.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "config/config.hpp"
#include "scene/generate/cubic.hpp"

namespace bitspan {
namespace {

// Four registers, of one cubic.
using PatchCurve = std::array<std::int64_t, 4>;

// x with 3 k fraction bits, on `guard` ones; half goes up.
std::int64_t with_guard(std::int64_t x, int k, int guard) {
  const int dropped = 3 * k - guard;
  return dropped == 0 ? x : (x + (std::int64_t{1} << (dropped - 1))) >> dropped;
}

PatchCurve start_of(const std::array<std::int64_t, 4>& p, int k, int guard) {
  const auto [d, c, b, a] = cubic_of(bezier_matrix, 1, p).power;
  const std::int64_t n = std::int64_t{1} << k;
  return {d << guard, with_guard(a + n * (b + n * c), k, guard), with_guard(6 * a + 2 * n * b, k, guard),
          with_guard(6 * a, k, guard)};
}
void advance(PatchCurve& d) {
  for (std::size_t i = 0; i < 3; ++i) d[i] += d[i + 1];
}

std::array<std::int64_t, 4> column_of(const PatchGrid& grid, std::size_t j) {
  return {grid[0][j], grid[1][j], grid[2][j], grid[3][j]};
}

// A boundary of a patch: its control points, and where its points stand among the patch's.
struct Boundary {
  std::size_t patch = 0;
  std::size_t first = 0;
  std::ptrdiff_t step = 0;
};
using BoundaryKey = std::array<std::array<std::int64_t, 3>, 4>;

std::vector<std::pair<BoundaryKey, Boundary>> boundaries_of(const Patch& patch, std::size_t index, int k) {
  const auto side = static_cast<std::ptrdiff_t>(patch_side(k));
  struct Way {
    std::size_t row, column, down, right;
    std::ptrdiff_t first, step;
  };
  const Way ways[] = {{0, 0, 0, 1, 0, 1},
                      {3, 0, 0, 1, side * (side - 1), 1},
                      {0, 0, 1, 0, 0, side},
                      {0, 3, 1, 0, side - 1, side}};
  std::vector<std::pair<BoundaryKey, Boundary>> out;
  for (const Way& way : ways) {
    BoundaryKey key;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        key[i][axis] = patch.axis[axis][way.row + i * way.down][way.column + i * way.right];
      }
    }
    // One order for both patches of a boundary.
    BoundaryKey back = key;
    std::ranges::reverse(back);
    const bool turned = back < key;
    const std::ptrdiff_t first = turned ? way.first + way.step * (side - 1) : way.first;
    out.emplace_back(turned ? back : key,
                     Boundary{index, static_cast<std::size_t>(first), turned ? -way.step : way.step});
  }
  return out;
}

}  // namespace

void check_patch_count(const PatchSet& set, int k) {
  const std::size_t steps = patch_side(k) - 1;
  if (set.patches.size() > patch_triangles_limit / (2 * steps * steps)) {
    throw InputError(set.name + ": " + std::to_string(set.patches.size()) + " patches of 4^" +
                     std::to_string(k) + " parts are too many; expected at most " +
                     std::to_string(patch_triangles_limit) + " triangles");
  }
}

std::vector<std::int64_t> patch_points(const PatchGrid& grid, int k, int guard) {
  std::array<PatchCurve, 4> rows;
  for (std::size_t j = 0; j < 4; ++j) rows[j] = start_of(column_of(grid, j), k, guard);
  const std::size_t side = patch_side(k);
  std::vector<std::int64_t> out;
  out.reserve(side * side);
  for (std::size_t row = 0; row < side; ++row) {
    PatchCurve along = start_of({rows[0][0], rows[1][0], rows[2][0], rows[3][0]}, k, guard);
    for (std::size_t column = 0; column < side; ++column) {
      out.push_back(along[0]);
      advance(along);
    }
    for (PatchCurve& d : rows) advance(d);
  }
  return out;
}

PatchPoints patch_points(const Patch& patch, int k, int guard) {
  PatchPoints out;
  for (std::size_t axis = 0; axis < out.size(); ++axis) out[axis] = patch_points(patch.axis[axis], k, guard);
  return out;
}

Vec3 place_in(const PatchSet& set, const PatchPoints& points, std::size_t at, int guard) {
  const auto value = [&](std::size_t axis) {
    return std::ldexp(static_cast<double>(points[axis][at]), -(set.fraction + 2 * guard));
  };
  return {value(0), value(1), value(2)};
}

Vec3 patch_normal(const Patch& patch, double u, double v) {
  const auto tangents = [&](double at_u, double at_v, Vec3& along_u, Vec3& along_v) {
    constexpr std::array axes{&Vec3::x, &Vec3::y, &Vec3::z};
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      std::array<double, 4> point{};
      std::array<double, 4> slope{};
      for (std::size_t j = 0; j < 4; ++j) {
        const auto p = column_of(patch.axis[axis], j);
        const Cubic<double> column = cubic_of<double>(bezier_matrix, 1,
                                                      {static_cast<double>(p[0]), static_cast<double>(p[1]),
                                                       static_cast<double>(p[2]), static_cast<double>(p[3])});
        point[j] = column.at(at_v);
        slope[j] = column.slope_at(at_v);
      }
      along_u.*axes[axis] = cubic_of(bezier_matrix, 1, point).slope_at(at_u);
      along_v.*axes[axis] = cubic_of(bezier_matrix, 1, slope).at(at_u);
    }
  };
  Vec3 along_u, along_v;
  tangents(u, v, along_u, along_v);
  const Vec3 normal = cross(along_u, along_v);
  if (length(normal) > 1e-9 * (dot(along_u, along_u) + dot(along_v, along_v))) return normal;
  // Where a side is a single point, the normal nearby stands for it.
  constexpr double inward = 1.0 / 1024;
  tangents(u + (0.5 - u) * inward, v + (0.5 - v) * inward, along_u, along_v);
  return cross(along_u, along_v);
}

PatchCracks count_cracks(const PatchSet& set, int k, int guard) {
  PatchCracks out;
  std::vector<PatchPoints> points;
  std::map<BoundaryKey, std::vector<Boundary>> shared;
  const std::size_t side = patch_side(k);
  for (std::size_t i = 0; i < set.patches.size(); ++i) {
    const Patch& patch = set.patches[i];
    const PatchPoints& of_patch = points.emplace_back(patch_points(patch, k, guard));
    for (const std::size_t row : {std::size_t{0}, std::size_t{3}}) {
      for (const std::size_t column : {std::size_t{0}, std::size_t{3}}) {
        const std::size_t at = (row / 3 * side + column / 3) * (side - 1);
        bool is_off = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          is_off = is_off || of_patch[axis][at] != patch.axis[axis][row][column] << (2 * guard);
        }
        ++out.corners;
        out.corners_off += is_off ? 1 : 0;
      }
    }
    for (const auto& [key, boundary] : boundaries_of(patch, i, k)) {
      // A side that is a single point bounds nothing.
      if (std::ranges::count(key, key[0]) < 4) shared[key].push_back(boundary);
    }
  }
  for (const auto& [key, of_patches] : shared) {
    for (std::size_t n = 1; n < of_patches.size(); ++n) {
      ++out.boundaries;
      const Boundary& a = of_patches[0];
      const Boundary& b = of_patches[n];
      for (std::size_t i = 0; i < side; ++i) {
        const auto at = [&](const Boundary& of) {
          return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(of.first) +
                                          static_cast<std::ptrdiff_t>(i) * of.step);
        };
        bool differs = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          differs = differs || points[a.patch][axis][at(a)] != points[b.patch][axis][at(b)];
        }
        ++out.points;
        out.cracks += differs ? 1 : 0;
      }
    }
  }
  return out;
}

}  // namespace bitspan
