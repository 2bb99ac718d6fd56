// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "config/modes.hpp"
#include "study/bounds/error_analysis.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

using F = FormatId;

ErrorAnalysis::ProjectedLine ErrorAnalysis::projected_line(std::size_t j, const ProjectedRange& p,
                                                           int exponent, Interval ends) {
  const Format& vertex = format(F::project_vertex);
  const Format& acc = format(F::project_acc);
  const Interval to_q = view_.b * view_.far_scale * in_.s_max * std::ldexp(1.0, -exponent);
  ProjectedLine out;
  out.exact = p.over_s[j] * to_q;
  out.gradient = (Interval(p.over_s_gradient[j]) * to_q.hi).hi;
  out.line = out.exact * (1 + ends);

  ErrorSum& e = out.error;
  ErrorSum at_vertex;
  at_vertex.add(key_of(F::project_vertex), rounding(vertex));
  settle(at_vertex, vertex, p.xyw[j] * std::ldexp(1.0, -exponent));
  e.add(at_vertex, q_ + vertex_h_.total());
  const int grid = vertex.fraction() + std::max(format(F::setup_h).fraction(), format(F::setup_b).fraction());
  e.add(key_of(F::project_acc), rounding(acc, grid));
  settle(e, acc, out.line);

  const auto walk = [&](const Way& way, double change, double gradient, double slack, std::string_view unit) {
    WalkError w = walk_error(c_,
                             {F::project_step, F::project_acc, acc.fraction(), way.position_grid, "", 0,
                              way.distance, way.additions, change, gradient, slack},
                             way.slopes);
    w.any = w.any || (x_any_ && &way == &row_way_);
    e.add(line_error(w, change, unit));
    overflow(e, w, F::project_acc, out.line, way.additions + 1);
  };
  walk(edge_way_, next_up(out.line.width() + e.total().width()), std::numeric_limits<double>::infinity(), 0,
       "reciprocal.edge");
  // The line is linear between the vertices, as their h weighs it; the gradient is the exact one.
  const double end_width = next_up(e.total().width() + (out.exact * ends).width());
  const double chord = std::min(out.exact.width(), (Interval(out.gradient) * row_width_).hi);
  walk(row_way_, next_up(chord + end_width), out.gradient,
       (Interval(out.gradient) * position_.total().width() + end_width).hi, "reciprocal.row");
  e.add(key_of(F::project_value), rounding(format(F::project_value), acc.fraction()));
  settle(e, format(F::project_value), out.line);
  return out;
}

void ErrorAnalysis::project() {
  if (!in_.projected) {
    for (const Place p : {project_s, project_t, project_ratio, project_h, project_z}) deliver(p, {}, 1, true);
    return;
  }
  const ProjectedRange& p = *in_.projected;
  const DepthRange range = depth_range(p.s_min, p.s_max);
  const Interval ends = relative_error(vertex_h_);
  std::array<ProjectedLine, 3> lines;
  for (std::size_t j = 0; j < 3; ++j) lines[j] = projected_line(j, p, range.exponent, ends);
  const ProjectedLine& w = lines[2];
  const Interval register_w = w.line + w.error.total();
  out_.worst.w_least = register_w.lo;
  const bool divides = register_w.lo > 0;
  const UnitError unit = divides ? pixel_.error(register_w) : UnitError{};
  const Interval inverse = divides ? Interval(1) / register_w : Interval(0);
  // Where coverage is by a dda, a centre may lie outside the triangle. There d(X / W)/dx = N / W^2.
  const double away = position_.total().mag();
  double outside = 1;
  bool finite = true;
  if (has_x_step(c_)) {
    const Interval least = Interval(w.exact.lo) - Interval(w.gradient) * away;
    finite = least.lo > 0;
    if (finite) outside = square(Interval(w.exact.lo) / least.lo).hi;
  }

  // The quotient of a line and W. truth: of it at the vertices.
  const auto quotient = [&](const ErrorSum& line, Interval truth, double gradient, F to) {
    ErrorSum e;
    e.add("weights by h of the vertices",
          Interval::plus_minus((Interval(truth.width()) * weight_error(ends)).hi));
    e.add(line, inverse);
    e.add(w.error, -truth * inverse);
    e.add("reciprocal.project", (truth + e.total()) * unit.relative);
    double moved = (Interval(gradient) * away * outside).hi;
    if (!has_x_step(c_)) moved = std::min({moved, truth.width(), (Interval(gradient) * row_width_).hi});
    e.add("edge.x", Interval::plus_minus(moved));
    e.add(key_of(to), rounding(format(to)));
    const Interval at_centre = has_x_step(c_) ? truth + Interval::plus_minus(moved) : truth;
    finish_quotient(e, divides && !unit.any, format(to), at_centre);
    return std::pair(e, at_centre);
  };
  for (std::size_t k = 0; k < 2; ++k) {
    auto [e, truth] = quotient(lines[k].error, p.place[k], p.place_gradient[k], F::span_uv);
    deliver(k == 0 ? project_s : project_t, std::move(e), truth.mag(), !finite);
  }

  // ratio stands for 2^E / W, and is (h + B) over W (h + B).
  const double whole = std::ldexp(1.0, range.exponent);
  const auto [ratio, truth] =
      quotient(walked_h_, p.place[2] * whole, (Interval(p.place_gradient[2]) * whole).hi, F::project_ratio);
  deliver(project_ratio, ratio, truth.mag(), !finite);

  const Interval a = quantised(range.b * range.far, format(F::distance_a));
  const Interval ideal_a = range.ideal_b * (Interval(p.s_max) * std::ldexp(1.0, -range.exponent));
  const Interval h = ideal_a * truth - range.ideal_b;
  ErrorSum e;
  e.add(ratio, a);
  e.add("setup.b, distance.a", (a - ideal_a) * truth - (range.b - range.ideal_b));
  const int grid = std::max(format(F::distance_a).fraction() + format(F::project_ratio).fraction(),
                            format(F::setup_b).fraction());
  e.add(key_of(F::project_h), rounding(format(F::project_h), grid));
  // Behind the projector, and where A wraps, nothing is known.
  const Interval whole_a = range.b * range.far + rounding(format(F::distance_a));
  const bool known = divides && !unit.any &&
                     (saturates(format(F::distance_a)) || whole_a.hi <= values(format(F::distance_a)).hi);
  const ErrorSum unheld = e;
  finish_quotient(e, known, format(F::project_h), h);
  deliver(project_h, e, h.mag() + range.ideal_b.hi, !finite);
  // The code and the true one are both held to 0..hmax. A register of h that holds all of these and saturates
  // moves them no further apart.
  const Interval codes(0, hmax_);
  const Interval held = values(format(F::project_h));
  const bool fits = saturates(format(F::project_h)) ? codes.inside(held) : (h + unheld.total()).inside(held);
  ErrorSum code;
  if (known && fits) {
    code = stored_code(unheld, F::project_h, codes);
  } else {
    code.add("range of the register", values(c_.depth_format()) - codes);
  }
  deliver(project_z, code, hmax_, !finite);
}

}  // namespace bitspan::bounds
