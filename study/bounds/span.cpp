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

void ErrorAnalysis::span() {
  const Format& x_format = format(F::edge_x);
  const double unit_x = ulp(x_format);
  const Interval off = position_.total();
  const bool exact = !has_x_step(c_);
  const double wide = std::min(in_.longest_row, std::max(0.0, next_up(in_.x.hi - in_.x.lo)));
  const double longest = std::max(unit_x, next_up(wide + off.width()));
  const double distance =
      std::min(longest, std::max(0.0, next_up(std::min(next_up(in_.x.hi + off.hi), in_.width - 0.5) -
                                              next_down(in_.x.lo + off.lo))));
  const int additions = static_cast<int>(std::min<double>(in_.width - 1, std::floor(distance)));
  // The registers of a row's ends are at least an ulp of edge.x apart, or nothing is divided.
  const double shortest = std::clamp(next_down(in_.shortest_row - off.width()), unit_x, longest);
  const Slopes slopes{form_of(c_.row_slope), row_.error({shortest, longest}), shortest};
  out_.worst.span_distance = distance;
  out_.worst.pixels = additions;
  const int p_grid = std::max(1, x_format.fraction());
  row_way_ = {slopes, p_grid, distance, additions};
  row_width_ = wide;
  const double away = off.mag();  // from a pixel's centre to the point of the chord that it stands for

  // The change of h along a chord.
  const Interval end_h = edge_h_.total();
  const double chord_h = std::min(h_.width(), (Interval(h_gradient_) * wide).hi);
  const double h_change = next_up(chord_h + end_h.width());
  const double h_slack = (Interval(h_gradient_) * off.width() + end_h.width()).hi;
  WalkError h = walk_error(c_,
                           {F::span_h_step, F::span_h, format(F::edge_h).fraction(), p_grid,
                            "start_offset.span_h", offset(c_.start_offset.span_h, c_.depth_format()),
                            distance, additions, h_change, h_gradient_, h_slack},
                           slopes);
  if (x_any_) h.any = true;
  ErrorSum h_walk = line_error(h, h_change, "reciprocal.row");
  ErrorSum at_chord = edge_h_;
  at_chord.add(h_walk);
  if (!overflow(at_chord, h, F::span_h, h_, additions + 1)) h.any = true;
  // The chord's point and the pixel's centre are apart by the error of the ends' x. Where coverage is exact,
  // both lie between the same ends, so h differs by no more than it does between the ends.
  double moved = (Interval(h_gradient_) * away).hi;
  if (exact && moved > chord_h) {
    moved = chord_h;
    out_.worst.position_capped = true;
  }
  ErrorSum total = at_chord;
  total.add("edge.x", Interval::plus_minus(moved));
  centre_h_ = total;
  const double beyond = exact ? 0 : moved;  // outside the triangle
  const Interval drift = drift_over(beyond);
  total.add("setup.b", drift);
  deliver(span_h, total, F::span_h, Interval(-beyond, hmax_ + beyond));
  depth_places(total, beyond);
  const Interval line_h = within(h_ + end_h, F::edge_h);
  if (!overflow(h_walk, h, F::span_h, line_h, additions + 1)) h.any = true;
  walked_h_.add(h_walk);
  const Interval line_q = positive(q_ + end_h);
  const Divided q = divided(line_q, h, h_walk, values(format(F::span_h)));
  const UnitError unit = q.none ? UnitError{} : pixel_.error(q.operand);
  pixel_unit_ = unit;
  pixel_divides_ = !q.none;
  reciprocal_place(span_reciprocal, at_chord, moved, q, unit, "span.h");
  const Interval centre_q(next_down(q_.lo - beyond), next_up(q_.hi + beyond));

  StageHypotheses& stage = out_.hypotheses.span;
  stage.additions = additions;
  stage.distance = distance;
  stage.shortest = shortest;
  stage.longest = longest;
  stage.slope_error = h.slope_error;
  stage.h_change = Interval::plus_minus(h_change);
  stage.h_carried = end_h + Interval::plus_minus(moved) + drift;
  stage.h_walk = h_walk.total();
  stage.q = line_q;
  stage.q_register = q.operand;
  stage.pixel_error = unit.relative;
  stage.h_offset = offset(c_.start_offset.span_h, c_.depth_format());
  stage.f_offset = offset(c_.start_offset.span_f, format(F::span_f));
  stage.adds_up = h.adds_up() && !q.none && !unit.any;

  const Interval ends = relative_error(edge_h_);
  for (std::size_t i = 0; i < 2; ++i) {
    span_coordinate(i, slopes, q, unit, ends, line_q, distance, additions, p_grid, away, wide, centre_q);
  }
}

void ErrorAnalysis::span_coordinate(std::size_t i, const Slopes& slopes, const Divided& q,
                                    const UnitError& unit, Interval ends, Interval line_q, double distance,
                                    int additions, int p_grid, double away, double wide, Interval centre_q) {
  const bool exact = !has_x_step(c_);
  const Interval uv = uv_[i].range;
  const Interval off = position_.total();
  const double end_width = edge_uv_[i].total().width();
  const double chord = std::min(uv.width(), (Interval(uv_[i].gradient) * wide).hi);
  const double change = next_up(chord + end_width);
  const double f_change = (Interval(change) * line_q.hi).hi;
  const double f_gradient = (Interval(uv_[i].gradient) * line_q.hi).hi;
  const double f_slack = ((Interval(uv_[i].gradient) * off.width() + end_width) * line_q.hi).hi;
  const double diff_ulp = ulp(format(F::span_f_diff));
  WalkError f = walk_error(c_,
                           {F::span_f_step, F::span_f, 0, p_grid, key_of(F::span_f),
                            offset(c_.start_offset.span_f, format(F::span_f)), distance, additions,
                            next_up(f_change + diff_ulp), f_gradient, next_up(f_slack + diff_ulp)},
                           slopes);
  if (x_any_) f.any = true;
  const ErrorSum f_error = f_walk_error(
      F::span_f_diff, F::span_f, f, f_change, additions,
      std::max(format(F::edge_h).fraction(), format(F::setup_b).fraction()) + format(F::edge_uv).fraction());
  // (u - u1) q changes by q du + (u - u1) dq over `away`.
  const double f_moved =
      ((Interval(uv_[i].gradient) * ideal_q_.hi + Interval(uv.width()) * h_gradient_) * away).hi;
  const double f_most = (Interval(2) * uv.width() * ideal_q_.hi).hi;
  f_place(i == 0 ? span_fu : span_fv, f, f_error, f_change, edge_uv_[i], ends, Interval(0, chord),
          exact ? std::min(f_moved, f_most) : f_moved, "reciprocal.row");

  ErrorSum e = edge_uv_[i];
  e.add("weights by h of the ends", Interval::plus_minus((Interval(chord) * weight_error(ends)).hi));
  bool finite = true;
  double moved = (Interval(uv_[i].gradient) * away).hi;
  if (exact) {
    moved = std::min(moved, chord);
  } else if (centre_q.lo > 0) {
    // Outside the triangle on its row, du/dx = N(y) / q^2.
    moved = (Interval(moved) * square(Interval(q_.lo) / Interval(centre_q.lo))).hi;
  } else {
    finite = false;
  }
  if (finite) e.add("edge.x", Interval::plus_minus(moved));
  StageHypotheses& stage = out_.hypotheses.span;
  stage.uv_change[i] = Interval::plus_minus(change);
  stage.uv_carried[i] = e.total();
  stage.f_change[i] = Interval::plus_minus(f_change);
  stage.f_walk[i] = f_error.total();
  stage.adds_up = stage.adds_up && f.adds_up() && finite;
  const bool divides = add_quotient(e, {"h of the span", "reciprocal.row", change, f, f_error, q, unit});
  e.add("span.uv", rounding(format(F::span_uv)));
  if (finite) {
    const Interval truth = exact ? uv : uv + Interval::plus_minus(moved);
    finish_quotient(e, divides, format(F::span_uv), truth);
  }
  deliver(i == 0 ? span_u : span_v, e, uv.mag(), !finite);
  deliver(i == 0 ? picture_u : picture_v, e, uv.mag(), !finite);
}

ErrorSum ErrorAnalysis::stored_code(const ErrorSum& h, F from, Interval truth) const {
  const Format z = c_.depth_format();
  ErrorSum e;
  e.add(h, is_complement_of_h(c_.depth_code) ? Interval(-1) : Interval(1));
  e.add("depth.round", rounding(z, format(from).fraction()));
  settle(e, z, is_complement_of_h(c_.depth_code) ? Interval(hmax_) - truth : truth);
  return e;
}

void ErrorAnalysis::depth_places(const ErrorSum& h, double beyond) {
  ErrorSum e = stored_code(h, F::span_h, Interval(0, hmax_) + Interval::plus_minus(beyond));
  deliver(depth_z, e, hmax_);
  // The picture of the truth has the nearest code.
  e.add("the nearest code of the truth", Interval::plus_minus(0.5));
  deliver(picture_depth, e, hmax_);
}

}  // namespace bitspan::bounds
