// SPDX-License-Identifier: Apache-2.0
// Cubic curves by the forms of docs/geometry.md, one coordinate at a time. [C1, B8]
//
// T: double, or exact rationals. A piece has t from 0 to 1.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace bitspan {

// power[i]: of t^i.
template <class T>
struct Cubic {
  std::array<T, 4> power{};

  T at(const T& t) const { return ((power[3] * t + power[2]) * t + power[1]) * t + power[0]; }
  T slope_at(const T& t) const { return (3 * power[3] * t + 2 * power[2]) * t + power[1]; }
  T bend_at(const T& t) const { return 6 * power[3] * t + 2 * power[2]; }
  bool operator==(const Cubic&) const = default;
};

// Rows: t^3, t^2, t, 1; columns: what the piece is given by.
using CubicMatrix = std::array<std::array<int, 4>, 4>;
// Two ends, then the two tangents there.
inline constexpr CubicMatrix hermite_matrix{{{2, -2, 1, 1}, {-3, 3, -2, -1}, {0, 0, 1, 0}, {1, 0, 0, 0}}};
inline constexpr CubicMatrix bezier_matrix{{{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}}};
// Four points in a row, near the middle two of which the piece goes; over 6.
inline constexpr CubicMatrix bspline_matrix{{{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 0, 3, 0}, {1, 4, 1, 0}}};
// Four points in a row, through the middle two of which the piece goes; over 2.
inline constexpr CubicMatrix catmull_rom_matrix{
    {{-1, 3, -3, 1}, {2, -5, 4, -1}, {-1, 0, 1, 0}, {0, 2, 0, 0}}};

template <class T>
Cubic<T> cubic_of(const CubicMatrix& matrix, int divisor, const std::array<T, 4>& given) {
  Cubic<T> out;
  for (std::size_t row = 0; row < 4; ++row) {
    T sum{0};
    for (std::size_t column = 0; column < 4; ++column) sum += matrix[row][column] * given[column];
    out.power[3 - row] = sum / divisor;
  }
  return out;
}

// The tangents at all points of a curve with two continuous derivatives through them, whose first and last
// tangent is given. points: two at least.
//
//   m[i-1] + 4 m[i] + m[i+1] = 3 (p[i+1] - p[i-1])     0 < i < n
template <class T>
std::vector<T> spline_tangents(const std::vector<T>& points, const T& first, const T& last) {
  const std::size_t n = points.size();
  std::vector<T> m(n);
  m.front() = first;
  m.back() = last;
  // Forward: row i becomes m[i] + over[i] m[i+1] = m[i] as stored.
  std::vector<T> over(n, T{0});
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const T pivot = 4 - over[i - 1];
    over[i] = T{1} / pivot;
    m[i] = (3 * (points[i + 1] - points[i - 1]) - m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= over[i] * m[i + 1];
  return m;
}

}  // namespace bitspan
