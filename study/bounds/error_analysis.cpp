// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/error_analysis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "config/modes.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {

using F = FormatId;

PlaceErrors ErrorAnalysis::run(const InputRange& in) {
  in_ = in;
  out_ = {};
  walked_h_ = {};
  constants();
  setup();
  if (in_.covers) {
    edge();
    span();
    if (has_project(c_.project)) project();
    if (has_light(c_.light) && unbounded_light(c_).empty()) light();
  }
  return out_;
}

double ErrorAnalysis::offset(const StartOffset& o, const Format& kept) {
  return o.half_ulp ? ulp(kept) / 2 : o.value;
}

PlaceError& ErrorAnalysis::place(Place p) {
  out_.places[p].used = true;
  return out_.places[p];
}

void ErrorAnalysis::deliver(Place p, ErrorSum e, F id, Interval truth) {
  const Interval any = values(format(id)) - truth;
  if (e.total().mag() > any.mag()) e.replace("range of the register", any);
  deliver(p, std::move(e), truth.mag());
}

void ErrorAnalysis::deliver(Place p, ErrorSum e, double largest, bool unbounded) {
  PlaceError& at = place(p);
  at.error = std::move(e);
  at.unbounded = unbounded;
  at.resolution = std::ldexp(largest, -50);
}

Interval ErrorAnalysis::relative_error(const ErrorSum& e) const {
  // The share of setup.s is relative already. It is q (s / s' - 1).
  Interval rest = 0;
  bool has_s = false;
  for (const auto& term : e.terms()) {
    if (term.first == "setup.s") {
      has_s = true;
    } else {
      rest += term.second;
    }
  }
  const Interval by_least = hull(rest / q_.lo, rest / q_.hi);
  return by_least + (has_s ? s_error_ : Interval(0));
}

double ErrorAnalysis::weight_error(Interval relative) {
  if (relative.lo <= -1) return 1;
  const Interval factor = (1 + Interval(relative.hi)) / (1 + Interval(relative.lo));
  return std::min(1.0, ((factor - 1) / 4).hi);
}

ErrorAnalysis::Divided ErrorAnalysis::divided(Interval q, const WalkError& walk, const ErrorSum& total,
                                              Interval range) const {
  Divided out;
  const Interval e = total.total();
  // A slope that stops short leaves h between the ends, and no register leaves its own range. A register that
  // is stopped from above may fall further on its way, by as much as it is short.
  const Interval small = walk.small.total();
  const bool stopped =
      walk.any || next_up(next_up(q.hi + small.hi) + walk.overshoot) > next_down(view_.b.lo + range.hi);
  const double between = stopped ? 0 : next_down(next_down(q.lo + small.lo) - walk.overshoot);
  const double least = std::max(between, next_down(view_.b.lo + range.lo));
  if (!(least > 0)) {
    out.none = true;
    return out;
  }
  const double most = next_up(q.hi + e.hi);
  double high = (Interval(q.hi) / least).hi;
  if (const Interval lowest = Interval(q.lo) + e.lo; lowest.lo > 0) {
    high = std::min(high, std::max(1.0, (Interval(q.lo) / lowest).hi));
  }
  out.ratio = {std::min(1.0, (Interval(q.lo) / (Interval(q.lo) + std::max(0.0, e.hi))).lo),
               std::max(1.0, high)};
  out.inverse = Interval(1) / Interval(least, std::max(least, most));
  out.operand = {least, std::max(least, most)};
  return out;
}

bool ErrorAnalysis::add_quotient(ErrorSum& e, const Quotient& d) {
  if (d.q.none || d.unit.any || d.f.any) return false;
  const Interval w_change = Interval::plus_minus(d.change);  // change w, w in 0..1
  const Interval recip = 1 + d.unit.relative;
  const Interval slope_error = d.f.lost > 0 ? hull(d.f.slope_error, -1) : d.f.slope_error;
  const Interval slope = 1 + slope_error;
  e.add(d.h_name, w_change * (d.q.ratio - 1));
  e.add(d.slope_unit, w_change * d.q.ratio * slope_error);
  e.add("reciprocal.pixel", w_change * d.q.ratio * slope * d.unit.relative);
  for (const auto& term : d.f_error.terms()) {
    e.add(term.first, term.second * d.q.inverse * recip);
  }
  return true;
}

void ErrorAnalysis::reciprocal_place(Place p, const ErrorSum& h, double moved, const Divided& d,
                                     const UnitError& unit, std::string_view h_name) {
  ErrorSum e;
  const Interval off = relative_error(h);
  if (d.none || unit.any) {
    deliver(p, e, 1, true);
    return;
  }
  // Takes the tighter of two: the error of h, and the ends of both ranges.
  Interval by_h = q_ / d.operand;
  if (off.lo > -1) {
    const Interval by_error = Interval(1) / (1 + off);
    by_h = {std::max(by_h.lo, by_error.lo), std::min(by_h.hi, by_error.hi)};
  }
  const Interval by_b = Interval(1) / scale_;
  e.add("setup.b", by_b - 1);
  e.add(h_name, by_b * (by_h - 1));
  const Interval by_x = Interval::plus_minus(moved) / q_.lo;
  e.add("edge.x", by_b * by_h * by_x);
  e.add("reciprocal.pixel", by_b * by_h * (1 + by_x) * unit.relative);
  deliver(p, e, 1);
}

Interval ErrorAnalysis::positive(Interval q) {
  return {std::max(q.lo, std::numeric_limits<double>::min()), q.hi};
}

void ErrorAnalysis::finish_quotient(ErrorSum& e, bool finite, const Format& f, Interval truth) {
  if (!finite) {
    e.replace("range of the register", values(f) - truth);
    return;
  }
  settle(e, f, truth);
}

ErrorSum ErrorAnalysis::line_error(const WalkError& w, double change, std::string_view unit) {
  ErrorSum e = w.small;
  e.add(unit, Interval::plus_minus(change) * w.slope_error);
  if (w.lost > 0) {
    e.add("saturated slope", Interval::plus_minus(w.lost));
    out_.worst.slope_saturates = true;
  }
  return e;
}

Interval ErrorAnalysis::within(Interval x, F id) const {
  const Interval range = values(format(id));
  return {std::clamp(x.lo, range.lo, range.hi), std::clamp(x.hi, range.lo, range.hi)};
}

bool ErrorAnalysis::overflow(ErrorSum& e, const WalkError& w, F acc, Interval truth, int times) const {
  if (!w.any) return settle(e, format(acc), truth, times);
  e.replace("overflow", values(format(acc)) - truth);
  return false;
}

ErrorSum ErrorAnalysis::f_walk_error(F diff, F acc, WalkError& w, double change, int additions, int grid) {
  const Interval truth = Interval::plus_minus(change);
  const Interval scale = 1 + w.slope_error;
  ErrorSum e;
  e.add(key_of(diff), rounding(format(diff), grid) * scale);
  if (!settle(e, format(diff), truth)) w.any = true;
  e.share();  // counts by the distance walked
  e.add(w.small);
  if (w.lost > 0) out_.worst.slope_saturates = true;
  if (!overflow(e, w, acc, hull(truth * scale, 0), additions + 1)) w.any = true;
  return e;
}

void ErrorAnalysis::f_place(Place p, const WalkError& w, const ErrorSum& f_error, double change,
                            const ErrorSum& ends_uv, Interval ends_q, Interval uv, double position,
                            std::string_view unit) {
  const F acc = p < span_h ? F::edge_f : F::span_f;
  ErrorSum e = f_error;
  e.add(unit, Interval::plus_minus(change) * (w.lost > 0 ? hull(w.slope_error, -1) : w.slope_error));
  const Interval ideal_change = Interval::plus_minus(uv.width());
  e.add("h of the ends", ideal_change * ideal_q_.hi * (scale_ * (1 + ends_q) - 1));
  e.add("u, v of the ends",
        Interval::plus_minus(ends_uv.total().width()) * ideal_q_.hi * scale_ * (1 + ends_q));
  if (position > 0) e.add("edge.x", Interval::plus_minus(position));
  if (w.any) e.add("overflow", values(format(acc)) * 2);
  deliver(p, e, acc, Interval::plus_minus((Interval(uv.width()) * ideal_q_.hi + position).hi));
}

}  // namespace bitspan::bounds
