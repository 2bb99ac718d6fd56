// SPDX-License-Identifier: Apache-2.0
// bitspan make curve
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/make_commands.hpp"
#include "cli/scene_options.hpp"
#include "config/curve.hpp"
#include "config/store.hpp"
#include "io/atomic_file.hpp"
#include "scene/generate/curve.hpp"
#include "study/curves.hpp"

namespace bitspan {
namespace {

struct CurveArguments {
  std::string points, output, config = "depth16";
  std::string kind = "bspline", end = "mirrored";
  std::vector<double> first_tangent, last_tangent;
  int k = 4;
  bool adders = false;
  int point_bits = 16;
};

// The points of a curve, a joint once.
struct CurvePoints {
  std::vector<Vec3> points;
  std::vector<double> t;  // the piece's number, and t in it
};

CurvePoints points_of(const std::vector<CurvePiece>& pieces, int k) {
  CurvePoints out;
  const int steps = 1 << k;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (int n = i == 0 ? 0 : 1; n <= steps; ++n) {
      const double t = static_cast<double>(n) / steps;
      out.points.push_back(point_at(pieces[i], t));
      out.t.push_back(static_cast<double>(i) + t);
    }
  }
  return out;
}

// What three adders make of the curve, and how far that is from the cubics on the grid.
struct AdderPoints : CurvePoints {
  double worst = 0;          // of all points
  std::size_t ends_off = 0;  // pieces that do not end on their last control point
  std::int64_t largest = 0;  // of the control points, in steps of the grid
};

AdderPoints points_by_adders(const std::vector<GridPiece>& pieces, const CurveFormats& formats, int fraction,
                             int k) {
  const model::ForwardDifferenceStage stage = model::prepare_forward_difference(formats, fraction, k);
  AdderPoints out;
  const int steps = 1 << k;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::vector<Vec3> points(static_cast<std::size_t>(steps) + 1);
    bool is_off = false;
    constexpr std::array axes{&Vec3::x, &Vec3::y, &Vec3::z};
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const auto& p = pieces[i][axis];
      for (const std::int64_t x : p) out.largest = std::max(out.largest, std::abs(x));
      const AdderCurve curve = curve_by_adders(stage, p, fraction);
      for (std::size_t n = 0; n < points.size(); ++n) points[n].*axes[axis] = curve.points[n];
      out.worst = std::max(out.worst, curve.worst);
      is_off = is_off || curve.misses_end;
    }
    out.ends_off += is_off ? 1 : 0;
    for (std::size_t n = i == 0 ? 0 : 1; n < points.size(); ++n) {
      out.points.push_back(points[n]);
      out.t.push_back(static_cast<double>(i) + static_cast<double>(n) / steps);
    }
  }
  return out;
}

// The text of the file: an OBJ with one line element, or t,x,y,z per line.
std::string text_of(const CurvePoints& curve, bool is_obj) {
  std::string out = is_obj ? "" : "t,x,y,z\n";
  std::string line = "l";
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Vec3& p = curve.points[i];
    out += is_obj ? fmt::format("v {} {} {}\n", p.x, p.y, p.z)
                  : fmt::format("{},{},{},{}\n", curve.t[i], p.x, p.y, p.z);
    line += fmt::format(" {}", i + 1);
  }
  return is_obj ? out + line + "\n" : out;
}

std::optional<Vec3> tangent_of(const std::vector<double>& given) {
  if (given.empty()) return std::nullopt;
  for (const double x : given) {
    if (!(std::fabs(x) <= 1e12)) throw InputError("make curve: a tangent is beyond 1e12; expected x,y,z");
  }
  return Vec3{given[0], given[1], given.size() > 2 ? given[2] : 0};
}

int make_curve_file(const CurveArguments& o) {
  CurveOptions options{.kind = choice<CurveKind>(o.kind, "--kind"),
                       .end = choice<CurveEnd>(o.end, "--end"),
                       .first_tangent = tangent_of(o.first_tangent),
                       .last_tangent = tangent_of(o.last_tangent)};
  if (options.kind != CurveKind::spline && (options.first_tangent || options.last_tangent)) {
    throw InputError("make curve: --first-tangent, --last-tangent are for --kind spline; leave them out");
  }
  const bool has_ends = options.kind == CurveKind::bspline || options.kind == CurveKind::catmull_rom;
  if (!has_ends && options.end != CurveEnd::mirrored) {
    throw InputError("make curve: --end is for --kind bspline and catmull_rom; leave it out");
  }
  const std::vector<CurvePiece> pieces = make_curve(read_points(o.points), options);
  const bool is_obj = o.output.ends_with(".obj");
  if ((pieces.size() << o.k) > 20'000'000) {
    throw InputError(fmt::format("make curve: {} pieces of 2^{} steps; expected at most 20,000,000 points",
                                 pieces.size(), o.k));
  }
  if (!o.adders) {
    const CurvePoints curve = points_of(pieces, o.k);
    write_file(o.output, text_of(curve, is_obj));
    fmt::print("{}: {} pieces, {} points\n", o.output, pieces.size(), curve.points.size());
    return exit_held;
  }
  const CurveFormats formats = curve_formats(find_config(o.config));
  check_curve(formats, o.point_bits, o.k);
  const AdderPoints curve = points_by_adders(on_curve_grid(pieces, o.point_bits), formats, o.point_bits, o.k);
  write_file(o.output, text_of(curve, is_obj));
  const auto violation = curve_violation(formats, {o.point_bits, curve.largest}, o.k);
  fmt::print("{}: {} pieces, {} points by adders\n", o.output, pieces.size(), curve.points.size());
  fmt::print("certificate: {}\n", violation ? *violation : "every point is exact");
  fmt::print("error: {:.6g} at most, bound {:.6g}; {} of {} pieces end beside their last control point\n",
             curve.worst, curve_error_bound(formats, o.point_bits, o.k), curve.ends_off, pieces.size());
  return exit_held;
}

}  // namespace

void add_make_curve(CLI::App& make, Action& action) {
  CLI::App* sub = make.add_subcommand("curve", "the points of a cubic curve, from its control points");
  const auto o = std::make_shared<CurveArguments>();
  sub->add_option("points", o->points, "file of points, x,y or x,y,z per line")->required();
  sub->add_option("-o,--output", o->output, "file to write: .obj, a line; else t,x,y,z per line")->required();
  sub->add_option(
         "--kind", o->kind,
         "hermite (points and tangents in turn), bezier (3 n + 1 points), bspline (near the points), "
         "catmull_rom or spline (through the points)")
      ->check(CLI::IsMember(names_of<CurveKind>()))
      ->capture_default_str();
  sub->add_option("--end", o->end,
                  "of bspline and catmull_rom: a mirrored point beyond each end, closed, or each end doubled")
      ->check(CLI::IsMember(names_of<CurveEnd>()))
      ->capture_default_str();
  sub->add_option("--first-tangent", o->first_tangent,
                  "of spline: x,y,z of the tangent at the first point (default: towards the next point)")
      ->delimiter(',')
      ->expected(2, 3);
  sub->add_option("--last-tangent", o->last_tangent, "of spline: x,y,z of the tangent at the last point")
      ->delimiter(',')
      ->expected(2, 3);
  sub->add_option("-k,--halvings", o->k, "2^k steps per piece")
      ->check(CLI::Range(0, curve_k_limit))
      ->capture_default_str();
  sub->add_flag(
      "--adders", o->adders,
      "by the unit forward_difference in the registers curve.d0..d3 of --config, with its certificate");
  sub->add_option("--point-bits", o->point_bits, "with --adders: fraction bits of the control points")
      ->check(CLI::Range(0, 40))
      ->capture_default_str();
  sub->add_option("--config", o->config, "shipped name or TOML file, for --adders")->capture_default_str();
  sub->footer(help_footer("the file is written", "",
                          "bitspan make curve points.csv --kind spline -o curve.obj\n"
                          "  bitspan make curve points.csv --adders -k 5 -o curve.csv"));
  sub->callback([o, &action] { action = [o] { return make_curve_file(*o); }; });
}

}  // namespace bitspan
