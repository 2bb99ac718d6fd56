// SPDX-License-Identifier: Apache-2.0
// Height fields: what terrain is made of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace bitspan {

// A height per sample of a grid whose step is 1 along both axes. Column i lies at x = i, row j at z = j.
struct HeightField {
  int columns = 0, rows = 0;    // each at least 2
  std::vector<double> heights;  // row by row

  double at(int i, int j) const {
    return heights[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(i)];
  }
};

inline constexpr int field_side_limit = 32768;            // samples, each way
inline constexpr std::size_t field_area_limit = 1 << 26;  // samples in all
inline constexpr double field_height_limit = 0x1p53;      // either way: integers below are doubles

// Reads a field by its contents: an array with two axes of an NPY file, one of an NPZ file, or a PNG of grey
// levels, whose codes become heights. `array` names the array of an NPZ file; without it the file must have
// one with two axes. Numbers may be integers or floating-point ones of 1 to 8 bytes, of either byte order and
// in either order of axes. Throws InputError with one line where the file is unreadable, damaged, larger than
// the limits or smaller than 2 x 2, and where a height is not finite or is beyond its limit.
HeightField read_height_field(const std::string& path, const std::optional<std::string>& array = {});

// The height between samples by bilinear interpolation, that of the sample at a sample. 0 <= x <= columns -
// 1, and z alike.
inline double height_at(const HeightField& field, double x, double z) {
  const int i = std::min(static_cast<int>(x), field.columns - 2);
  const int j = std::min(static_cast<int>(z), field.rows - 2);
  const double a = x - i, b = z - j;
  const double above = field.at(i, j) * (1 - a) + field.at(i + 1, j) * a;
  const double below = field.at(i, j + 1) * (1 - a) + field.at(i + 1, j + 1) * a;
  return above * (1 - b) + below * b;
}

// Every n-th sample along both axes, from the first one. Throws InputError where fewer than 2 are left along
// one.
HeightField every_nth(const HeightField& field, int n);

}  // namespace bitspan
