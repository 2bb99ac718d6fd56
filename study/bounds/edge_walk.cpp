// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "config/modes.hpp"
#include "study/bounds/error_analysis.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

using F = FormatId;

void ErrorAnalysis::edge() {
  const Format& coordinate = c_.coordinate_format();
  const int t_grid = std::max(1, coordinate.fraction());
  const double legal_edge = std::ldexp(1.0, -c_.subpixel_bits);
  const double shortest = std::max(in_.shortest_edge, legal_edge);
  const double tall = std::max(legal_edge, next_up(in_.y.hi - in_.y.lo));
  const double distance = std::max(0.0, next_up(std::min(in_.y.hi, in_.height - 0.5) - in_.y.lo));
  const int additions = static_cast<int>(std::min<double>(in_.height - 1, std::floor(distance)));
  const Slopes slopes{c_.edge_slope, edge_.error({std::min(shortest, tall), tall}), std::min(shortest, tall)};
  edge_way_ = {slopes, t_grid, distance, additions};
  out_.worst.edge_distance = distance;
  out_.worst.rows = additions;

  edge_position(t_grid, distance, additions, slopes);

  // The walk of h.
  const double h_change = next_up(h_.width() + vertex_h_.total().width());
  const Format& kept_h = format(F::edge_h);
  const WalkError h = walk_error(c_,
                                 {F::edge_h_step, F::edge_h_acc, format(F::setup_h).fraction(), t_grid,
                                  "start_offset.edge_h", offset(c_.start_offset.edge_h, kept_h), distance,
                                  additions, h_change, std::numeric_limits<double>::infinity(), 0},
                                 slopes);
  ErrorSum h_walk = line_error(h, h_change, "reciprocal.edge");
  StageHypotheses& stage = out_.hypotheses.edge;
  stage.additions = additions;
  stage.distance = distance;
  stage.shortest = slopes.shortest;
  stage.longest = tall;
  stage.slope_error = h.slope_error;
  stage.h_change = Interval::plus_minus(h_change);
  stage.h_carried = vertex_h_.total() + drift_;
  stage.h_offset = offset(c_.start_offset.edge_h, kept_h);
  stage.f_offset = offset(c_.start_offset.edge_f, format(F::edge_f));
  edge_h_ = vertex_h_;
  edge_h_.add(h_walk);
  overflow(edge_h_, h, F::edge_h_acc, h_, additions + 1);
  deliver(edge_h_acc, with_drift(edge_h_), F::edge_h_acc, Interval(0, hmax_));
  const Interval narrowing = rounding(kept_h, format(F::edge_h_acc).fraction());
  edge_h_.add("edge.h", narrowing);
  settle(edge_h_, kept_h, h_);
  deliver(edge_h, with_drift(edge_h_), F::edge_h, Interval(0, hmax_));

  // h_walk becomes the register's own part, against the line through the vertices' registers.
  const Interval line_h = within(h_ + vertex_h_.total(), F::setup_h);
  WalkError kept = h;
  kept.small.add("edge.h", narrowing);
  if (!overflow(h_walk, h, F::edge_h_acc, line_h, additions + 1)) kept.any = true;
  h_walk.add("edge.h", narrowing);
  if (!settle(h_walk, kept_h, line_h)) kept.any = true;
  walked_h_ = h_walk;
  const Interval line_q = positive(q_ + vertex_h_.total());
  const Interval kept_range = values(kept_h);
  const Interval h_range(kept_range.lo,
                         std::min(kept_range.hi, next_down(values(format(F::edge_h_acc)).hi + narrowing.lo)));
  const Divided q = divided(line_q, kept, h_walk, h_range);
  const UnitError unit = q.none ? UnitError{} : pixel_.error(q.operand);
  reciprocal_place(edge_reciprocal, edge_h_, 0, q, unit, "edge.h");
  stage.h_walk = h_walk.total();
  stage.q = line_q;
  stage.q_register = q.operand;
  stage.pixel_error = unit.relative;
  stage.adds_up = kept.adds_up() && !q.none && !unit.any;

  const Interval ends = relative_error(vertex_h_);
  for (std::size_t i = 0; i < 2; ++i) {
    const Interval uv = uv_[i].range;
    const double change = next_up(uv.width() + vertex_uv_[i].total().width());
    const double f_change = (Interval(change) * line_q.hi).hi;
    WalkError f = walk_error(
        c_,
        {F::edge_f_step, F::edge_f, 0, t_grid, key_of(F::edge_f),
         offset(c_.start_offset.edge_f, format(F::edge_f)), distance, additions,
         next_up(f_change + ulp(format(F::edge_f_diff))), std::numeric_limits<double>::infinity(), 0},
        slopes);
    const ErrorSum f_error =
        f_walk_error(F::edge_f_diff, F::edge_f, f, f_change, additions,
                     std::max(format(F::setup_h).fraction(), format(F::setup_b).fraction()) +
                         format(F::setup_uv).fraction());
    f_place(i == 0 ? edge_fu : edge_fv, f, f_error, f_change, vertex_uv_[i], ends, uv, 0, "reciprocal.edge");

    ErrorSum e = vertex_uv_[i];
    e.add("weights by h of the vertices",
          Interval::plus_minus((Interval(uv.width()) * weight_error(ends)).hi));
    stage.uv_change[i] = Interval::plus_minus(change);
    stage.uv_carried[i] = e.total();
    stage.f_change[i] = Interval::plus_minus(f_change);
    stage.f_walk[i] = f_error.total();
    stage.adds_up = stage.adds_up && f.adds_up();
    const bool finite =
        add_quotient(e, {"h of the edge walk", "reciprocal.edge", change, f, f_error, q, unit});
    e.add("edge.uv", rounding(format(F::edge_uv)));
    finish_quotient(e, finite, format(F::edge_uv), uv);
    edge_uv_[i] = e;
    deliver(i == 0 ? edge_u : edge_v, e, uv.mag());
  }
}

void ErrorAnalysis::edge_position(int t_grid, double distance, int additions, const Slopes& slopes) {
  position_ = {};
  if (has_x_step(c_)) {
    const double change = next_up(in_.x.hi - in_.x.lo);
    const int steps = sums_x_steps(c_.dda_update) ? additions : 0;
    const WalkError x = walk_error(c_,
                                   {F::edge_x_step, F::edge_x_acc, c_.subpixel_bits, t_grid,
                                    "start_offset.edge_x", offset(c_.start_offset.edge_x, format(F::edge_x)),
                                    distance, steps, change, std::numeric_limits<double>::infinity(), 0},
                                   slopes);
    position_ = line_error(x, change, "reciprocal.edge");
    overflow(position_, x, F::edge_x_acc, in_.x, steps + 1);
    deliver(edge_x_acc, position_, in_.x.mag());
  }
  position_.add("edge.x",
                rounding(format(F::edge_x),
                         has_x_step(c_) ? std::optional(format(F::edge_x_acc).fraction()) : std::nullopt));
  // Rounding is monotone. So where x and the pixel centres are values of edge.x, a covered centre stays
  // between the row's ends. Elsewhere nothing is known of the way from the left end.
  const Interval x_values = values(format(F::edge_x));
  settle(position_, format(F::edge_x), in_.x);
  x_any_ = !(in_.x + position_.total()).inside(x_values) || !Interval(0.5, in_.width - 0.5).inside(x_values);
  deliver(edge_x, position_, in_.x.mag());
  out_.worst.x_error = position_.total().mag();
}

}  // namespace bitspan::bounds
