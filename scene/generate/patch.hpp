// SPDX-License-Identifier: Apache-2.0
// Bicubic patches in Bezier's form by forward differences in integers; docs/geometry.md. [P1]
//
// Control points are multiples of 2^-fraction. A patch has 2^k steps each way. First four curves go from row
// to row, one through each column of control points, then a curve per row through the four points that they
// are at: 16 registers for the columns and four for the row. Each way adds `guard` fraction bits; with 3 k no
// bit is ever lost.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/geometry.hpp"

namespace bitspan {

// Of one coordinate: [row][column], at most 2^20 from 0.
using PatchGrid = std::array<std::array<std::int64_t, 4>, 4>;
struct Patch {
  std::array<PatchGrid, 3> axis;  // x, y, z
};

struct PatchSet {
  std::string name;
  int fraction = 0;  // of the control points; may be negative
  std::vector<Patch> patches;
};

inline constexpr int patch_k_least = 2, patch_k_limit = 6, patch_k_default = 4;
inline constexpr std::size_t patch_triangles_limit = 20'000'000;

constexpr std::size_t patch_side(int k) { return (std::size_t{1} << k) + 1; }

// Throws InputError where so many patches have too many triangles.
void check_patch_count(const PatchSet& set, int k);

// Point (row, column) stands at row * patch_side(k) + column, as a multiple of 2^-(fraction + 2 guard). v
// goes from row to row, u along a row. 0 <= guard <= 3 k.
std::vector<std::int64_t> patch_points(const PatchGrid& grid, int k, int guard);

// The same of x, y and z.
using PatchPoints = std::array<std::vector<std::int64_t>, 3>;
PatchPoints patch_points(const Patch& patch, int k, int guard);
// Where one of a set's points is.
Vec3 place_in(const PatchSet& set, const PatchPoints& points, std::size_t at, int guard);

// Outward, of any length: u cross v.
Vec3 patch_normal(const Patch& patch, double u, double v);

// The boundaries that two patches share, by their control points, at the same points.
struct PatchCracks {
  std::size_t boundaries = 0;   // shared ones, counted per pair
  std::size_t points = 0;       // on them, ends included
  std::size_t cracks = 0;       // where the two patches have not the same bits
  std::size_t corners = 0;      // of patches
  std::size_t corners_off = 0;  // those that are not their control point
};
PatchCracks count_cracks(const PatchSet& set, int k, int guard);

}  // namespace bitspan
