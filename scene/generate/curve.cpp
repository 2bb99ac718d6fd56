// SPDX-License-Identifier: Apache-2.0
#include "scene/generate/curve.hpp"

#include <cmath>
#include <string_view>

#include "config/config.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

constexpr std::size_t curve_points_limit = 1'000'000;

// Throws InputError where a kind does not take so many points.
void check_point_count(CurveKind kind, CurveEnd end, std::size_t count) {
  const auto expect = [&](bool held, const char* what) {
    if (!held) {
      throw InputError("curve: " + std::to_string(count) + " points; " + std::string(to_string(kind)) +
                       " takes " + what);
    }
  };
  switch (kind) {
    case CurveKind::hermite:
      return expect(count >= 4 && count % 2 == 0, "2 n lines from 4 on, a point and its tangent in turn");
    case CurveKind::bezier:
      return expect(count >= 4 && count % 3 == 1, "3 n + 1 points, 4 or more");
    case CurveKind::bspline:
    case CurveKind::catmull_rom:
      return end == CurveEnd::closed ? expect(count >= 3, "3 points or more, closed")
                                     : expect(count >= 2, "2 points or more");
    case CurveKind::spline:
      return expect(count >= 2, "2 points or more");
  }
}

}  // namespace

std::vector<CurvePiece> make_curve(const std::vector<Vec3>& points, const CurveOptions& options) {
  check_point_count(options.kind, options.end, points.size());
  constexpr std::array axes{&Vec3::x, &Vec3::y, &Vec3::z};
  std::vector<CurvePiece> out;
  const std::size_t n = points.size();
  const Vec3 first = options.first_tangent.value_or(points[1] - points[0]);
  const Vec3 last = options.last_tangent.value_or(points[n - 1] - points[n - 2]);
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    std::vector<double> of_axis;
    of_axis.reserve(n + 3);
    for (const Vec3& p : points) of_axis.push_back(p.*axes[axis]);
    const auto pieces =
        curve_pieces(std::move(of_axis), options.kind, options.end, first.*axes[axis], last.*axes[axis]);
    out.resize(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) out[i][axis] = pieces[i];
  }
  return out;
}

std::vector<GridPiece> on_curve_grid(const std::vector<CurvePiece>& pieces, int fraction) {
  const auto nearest = [&](double x) {
    const double in_steps = std::floor(std::ldexp(x, fraction) + 0.5);
    if (!(std::fabs(in_steps) <= 0x1p40)) {
      throw InputError("curve: a control point at " + std::to_string(x) +
                       " is beyond the grid; expected at most 2^40 steps of 2^-" + std::to_string(fraction));
    }
    return static_cast<std::int64_t>(in_steps);
  };
  std::vector<GridPiece> out;
  out.reserve(pieces.size());
  for (const CurvePiece& piece : pieces) {
    GridPiece grid;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Cubic<double>& c = piece[axis];
      grid[axis] = {nearest(c.at(0)), nearest(c.at(0) + c.slope_at(0) / 3),
                    nearest(c.at(1) - c.slope_at(1) / 3), nearest(c.at(1))};
      // Sums of doubles may round the same joint to both sides.
      if (!out.empty()) out.back()[axis][3] = grid[axis][0];
    }
    out.push_back(grid);
  }
  return out;
}

std::vector<Vec3> read_points(const std::string& path) {
  const std::string text = read_whole(path, "expected a file of points, x,y,z per line");
  std::vector<Vec3> points;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    std::array<double, 3> xyz{};
    std::size_t count = 0;
    bool legal = true;
    for (bool more = true; more && legal;) {
      const std::size_t comma = line.find(',');
      const auto value = to_number(trimmed(line.substr(0, comma)));
      legal = value && std::isfinite(*value) && std::fabs(*value) <= 1e12 && count < 3;
      if (legal) xyz[count++] = *value;
      more = comma != std::string_view::npos;
      line.remove_prefix(more ? comma + 1 : line.size());
    }
    if (!legal || count < 2) {
      throw InputError(path + ":" + std::to_string(number) +
                       ": is no point; expected x,y or x,y,z, numbers of at most 1e12");
    }
    if (points.size() == curve_points_limit) {
      throw InputError(path + ":" + std::to_string(number) + ": is one point too many; expected at most " +
                       std::to_string(curve_points_limit));
    }
    points.push_back({xyz[0], xyz[1], xyz[2]});
  }
  return points;
}

}  // namespace bitspan
