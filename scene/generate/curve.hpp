// SPDX-License-Identifier: Apache-2.0
// Curves through and near points; docs/geometry.md. [C1, B8]
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/names.hpp"
#include "scene/generate/cubic.hpp"
#include "scene/geometry.hpp"

namespace bitspan {

// What the points are.
//   hermite      p0, tangent at p0, p1, tangent at p1, ...
//   bezier       3 n + 1 points; the curve goes through each third one
//   bspline      the curve goes near them; two continuous derivatives
//   catmull_rom  the curve goes through them; one continuous derivative
//   spline       the curve goes through them; two continuous derivatives, the tangents at both ends given
BITSPAN_ENUM(CurveKind, hermite, bezier, bspline, catmull_rom, spline);

// How a curve of bspline and of catmull_rom, whose pieces take four points, gets its first and last pieces.
//   mirrored  a point is added beyond each end, as far as the last but one: the curve reaches both ends
//   closed    the points repeat: there is no end
//   doubled   each end counts twice
BITSPAN_ENUM(CurveEnd, mirrored, closed, doubled);

struct CurveOptions {
  CurveKind kind = CurveKind::bspline;
  CurveEnd end = CurveEnd::mirrored;
  std::optional<Vec3> first_tangent{}, last_tangent{};  // of spline; else towards the next point
};

// The pieces of one coordinate, one behind the other.
template <class T>
std::vector<Cubic<T>> curve_pieces(std::vector<T> points, CurveKind kind, CurveEnd end,
                                   const T& first_tangent, const T& last_tangent) {
  std::vector<Cubic<T>> out;
  const auto four = [&](std::size_t i) {
    return std::array<T, 4>{points[i], points[i + 1], points[i + 2], points[i + 3]};
  };
  switch (kind) {
    case CurveKind::hermite:
      for (std::size_t i = 0; i + 3 < points.size(); i += 2) {
        out.push_back(
            cubic_of<T>(hermite_matrix, 1, {points[i], points[i + 2], points[i + 1], points[i + 3]}));
      }
      return out;
    case CurveKind::bezier:
      for (std::size_t i = 0; i + 3 < points.size(); i += 3)
        out.push_back(cubic_of(bezier_matrix, 1, four(i)));
      return out;
    case CurveKind::spline: {
      const std::vector<T> m = spline_tangents(points, first_tangent, last_tangent);
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        out.push_back(cubic_of<T>(hermite_matrix, 1, {points[i], points[i + 1], m[i], m[i + 1]}));
      }
      return out;
    }
    case CurveKind::bspline:
    case CurveKind::catmull_rom:
      break;
  }
  const std::size_t n = points.size();
  switch (end) {
    case CurveEnd::mirrored: {
      const T before = 2 * points[0] - points[1];
      const T behind = 2 * points[n - 1] - points[n - 2];
      points.insert(points.begin(), before);
      points.push_back(behind);
      break;
    }
    case CurveEnd::closed: {
      const T before = points[n - 1];
      const T first = points[0];
      const T second = points[1];
      points.insert(points.begin(), before);
      points.push_back(first);
      points.push_back(second);
      break;
    }
    case CurveEnd::doubled: {
      const T before = points[0];
      const T behind = points[n - 1];
      points.insert(points.begin(), before);
      points.push_back(behind);
      break;
    }
  }
  const bool near = kind == CurveKind::bspline;
  for (std::size_t i = 0; i + 3 < points.size(); ++i) {
    out.push_back(near ? cubic_of(bspline_matrix, 6, four(i)) : cubic_of(catmull_rom_matrix, 2, four(i)));
  }
  return out;
}

// A piece of a curve in space: x, y, z.
using CurvePiece = std::array<Cubic<double>, 3>;
inline Vec3 point_at(const CurvePiece& piece, double t) {
  return {piece[0].at(t), piece[1].at(t), piece[2].at(t)};
}

// Throws InputError where the points are not as many as the kind takes.
std::vector<CurvePiece> make_curve(const std::vector<Vec3>& points, const CurveOptions& options);

// The pieces in Bezier's form on the grid of 2^-fraction, with the nearest points of it: a joint is one
// point.
using GridPiece = std::array<std::array<std::int64_t, 4>, 3>;
// Throws InputError where a point has more than 2^40 steps of the grid.
std::vector<GridPiece> on_curve_grid(const std::vector<CurvePiece>& pieces, int fraction);

// Reads points, a line each: x,y or x,y,z. Blank lines and lines that begin with # are left out. Throws
// InputError with file and line.
std::vector<Vec3> read_points(const std::string& path);

}  // namespace bitspan
