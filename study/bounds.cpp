#include "study/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "config/modes.hpp"
#include "study/error_sum.hpp"
#include "study/format_range.hpp"
#include "study/unit_error.hpp"

namespace bitspan {
namespace {

using F = FormatId;
using Error = bounds::ErrorSum;
using bounds::quantised;
using bounds::rounding;
using bounds::saturates;
using bounds::settle;
using bounds::ulp;
using bounds::Unit;
using bounds::UnitError;
using bounds::values;

constexpr double infinite = std::numeric_limits<double>::infinity();

// ---- A register that follows a line ----

struct Slopes {
  SlopeForm form;
  UnitError unit;
  double shortest;  // length divided by
};

// acc = Q(start + step p + offset), then acc = Q(acc + step): the line through two registers, `change` apart.
struct Line {
  F step, acc;
  int start_grid;     // fraction bits of the value at the line's start
  int position_grid;  // and of p
  std::string_view offset_name;
  double offset;
  double distance;  // from the line's start, at most
  int additions;    // at most
  double change;    // |n|, at most
  double gradient;  // |n| <= gradient length + slack
  double slack;
};

struct WalkError {
  Error small;               // what roundings add
  double lost = 0;           // a saturated slope loses up to this much on the way from one end to the other
  Interval slope_error = 0;  // of the slope, relative
  double overshoot = 0;      // past the far end, by slope_error
  bool any = false;          // a slope may be anything
  bool capped = false;       // a slope's rounding counts by the change, not by the way
  bool plain() const { return !any && !capped && lost == 0; }
};

WalkError walk_error(const Config& c, const Line& line, const Slopes& slopes) {
  const Format& step = c.format(line.step);
  const Format& acc = c.format(line.acc);
  WalkError out;
  const bool by_unit = shares_reciprocal(slopes.form);
  if (by_unit) {
    out.slope_error = slopes.unit.relative;
    out.any = slopes.unit.any;
  }
  out.overshoot = (Interval(line.change) * std::max(0.0, out.slope_error.hi)).hi;
  // Rounded to nearest, a slope moves by no more than itself (0 is a value of its register), so by no more
  // than the change over the whole way: what counts where the ends are all but equal.
  Interval rounded_slope = rounding(step) * Interval(0, line.distance);
  const double all = ((1 + out.slope_error) * line.change).hi;
  if (step.rounding != Rounding::trn && rounded_slope.mag() > all) {
    rounded_slope = Interval::plus_minus(all);
    out.capped = true;
  }
  out.small.add(key_of(line.step), rounded_slope);
  int grid = std::max(line.start_grid, step.fraction() + line.position_grid);
  if (line.offset != 0) grid = std::max(grid, acc.fraction() + 1);
  const Interval start = rounding(acc, grid);
  const Interval again = rounding(acc, std::max(acc.fraction(), step.fraction()));
  out.small.add(key_of(line.acc), start + again * Interval(0, line.additions));
  out.small.add(line.offset_name, line.offset);

  // The largest slope, by the shortest line; what its register cannot hold of it shortens the way made.
  const Interval range = values(step);
  const double top = std::max(0.0, std::min(-range.lo, range.hi));
  const Interval scale = 1 + out.slope_error;
  const auto change_over = [&](double length) {
    const Interval limited = Interval(line.gradient) * length + line.slack;
    return (scale * std::min(line.change, limited.hi)).hi;
  };
  const double steepest = (Interval(change_over(slopes.shortest)) / slopes.shortest).hi;
  const Interval rounded = Interval(steepest) + rounding(step);
  if (rounded.hi > top) {
    if (!saturates(step)) {
      out.any = true;
    } else {
      const double longest =
          top > 0 ? (Interval((scale * line.change).hi) / top).hi : infinite;  // of those that saturate
      const double most = std::isinf(longest) ? (scale * line.change).hi : change_over(longest);
      out.lost = std::max(0.0, (Interval(most) - Interval(top) * slopes.shortest).hi);
    }
  }
  return out;
}

// ---- Places ----

enum Place : std::size_t {
  setup_b,
  setup_h,
  setup_u,
  setup_v,
  edge_x_acc,
  edge_x,
  edge_h_acc,
  edge_h,
  edge_fu,
  edge_fv,
  edge_reciprocal,
  edge_u,
  edge_v,
  span_h,
  span_fu,
  span_fv,
  span_reciprocal,
  span_u,
  span_v,
  depth_z,
  picture_depth,
  picture_u,
  picture_v,
  place_count
};

struct PlaceName {
  const char *place, *stage, *quantity, *unit;
};
constexpr std::array<PlaceName, place_count> place_names{{
    {"setup.b", "constants", "B", "depth code"},
    {"setup.h", "setup", "h", "depth code"},
    {"setup.uv", "setup", "u", "texel"},
    {"setup.uv", "setup", "v", "texel"},
    {"edge.x_acc", "edge_walk", "x", "pixel"},
    {"edge.x", "edge_walk", "x", "pixel"},
    {"edge.h_acc", "edge_walk", "h", "depth code"},
    {"edge.h", "edge_walk", "h", "depth code"},
    {"edge.f", "edge_walk", "fu", "texel*depth code"},
    {"edge.f", "edge_walk", "fv", "texel*depth code"},
    {"reciprocal.pixel (edge_walk)", "edge_walk", "1/(h+B)", "relative"},
    {"edge.uv", "edge_walk", "u", "texel"},
    {"edge.uv", "edge_walk", "v", "texel"},
    {"span.h", "span", "h", "depth code"},
    {"span.f", "span", "fu", "texel*depth code"},
    {"span.f", "span", "fv", "texel*depth code"},
    {"reciprocal.pixel (span)", "span", "1/(h+B)", "relative"},
    {"span.uv", "span", "u", "texel"},
    {"span.uv", "span", "v", "texel"},
    {"depth.z", "depth", "z", "depth code"},
    {"depth buffer", "picture", "depth", "depth code"},
    {"picture u", "picture", "u", "texel"},
    {"picture v", "picture", "v", "texel"},
}};

double rounded_up(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::ceil(std::ldexp(mantissa, 32)), exponent - 32);
}

struct PlaceError {
  Error error;
  bool used = false;
  bool unbounded = false;
  double resolution = 0;
  // Rounded up to 32 bits: readable, and with room for whoever adds the terms up again.
  double bound() const { return unbounded ? infinite : rounded_up(error.total().mag()); }
};

// What the texts name.
struct Facts {
  double edge_distance = 0, span_distance = 0;
  int rows = 0, pixels = 0;
  double q_least = 0;
  double x_error = 0;
  double h_gradient = 0;
  std::array<double, 2> uv_gradient{};
  bool position_capped = false;
  bool slope_saturates = false;
};

struct Analysis {
  std::array<PlaceError, place_count> places;
  Facts facts;
  Hypotheses hypotheses;
};

// u or v on its way.
struct Coordinate {
  Interval range;
  double gradient;
};

class Analyser {
 public:
  explicit Analyser(const Config& config)
      : c_(config),
        pixel_(config.pixel_reciprocal),
        row_(config.row_reciprocal),
        edge_(config.edge_reciprocal) {}

  Analysis run(const InputRange& in) {
    in_ = in;
    out_ = {};
    constants();
    setup();
    if (in_.covers) {
      edge();
      span();
    }
    return out_;
  }

 private:
  const Format& format(F id) const { return c_.format(id); }
  static double offset(const StartOffset& o, const Format& kept) {
    return o.half_ulp ? ulp(kept) / 2 : o.value;
  }

  PlaceError& place(Place p) {
    out_.places[p].used = true;
    return out_.places[p];
  }
  // truth: the range of what the register is compared with, and id its format. Neither leaves its range.
  void deliver(Place p, Error e, F id, Interval truth) {
    const Interval any = values(format(id)) - truth;
    if (e.total().mag() > any.mag()) e.replace("range of the register", any);
    deliver(p, std::move(e), truth.mag());
  }
  void deliver(Place p, Error e, double largest, bool unbounded = false) {
    PlaceError& at = place(p);
    at.error = std::move(e);
    at.unbounded = unbounded;
    at.resolution = std::ldexp(largest, -50);
  }

  // B, and scale_ = (q as the registers would hold it without further rounding) / (ideal's h + B).
  void constants() {
    int e = 0;
    if (std::frexp(in_.s_max, &e) == 0.5) --e;
    exponent_ = e;
    const Format& s = format(F::setup_s);
    const double near = std::ldexp(in_.s_min, -e);
    const double far = std::ldexp(in_.s_max, -e);
    if (!saturates(s) && far > values(s).hi) {
      throw InputError("formats.setup.s: too narrow for s_max; no bound is known for what wraps there");
    }
    s_near_ = quantised(near, s);
    const double s_far = quantised(far, s);
    if (!(s_near_ > 0 && s_near_ < s_far)) {
      throw InputError("formats.setup.s: too coarse for s_min and s_max; legal: 0 < s_min' < s_max'");
    }
    hmax_ = std::ldexp(1.0, c_.depth_bits) - 1;
    const Interval b = Interval(hmax_) * s_near_ / (Interval(s_far) - s_near_);
    const Format& b_format = format(F::setup_b);
    if (!saturates(b_format) && (b + rounding(b_format)).hi > values(b_format).hi) {
      throw InputError("formats.setup.b: too narrow for B; no bound is known for what wraps there");
    }
    b_ = quantised(b, b_format);
    if (!(b_.lo > 0)) throw InputError("formats.setup.b: too coarse for the s range; legal: B > 0");
    const Interval ideal_b = Interval(hmax_) * in_.s_min / (Interval(in_.s_max) - in_.s_min);
    scale_ = b_ / ideal_b * (Interval(s_far) / far);
    const Interval nearness = Interval(in_.s_max) / in_.s;  // q = ideal_b nearness
    ideal_q_ = ideal_b * nearness;
    q_ = scale_ * ideal_q_;
    h_ = Interval(b_ * (Interval(s_far) / far) * nearness) - b_;
    ideal_b_ = ideal_b;
    far_scale_ = Interval(s_far) / far;
    drift_ = drift_over(0);
    Error error;
    error.add("setup.b", b_ - ideal_b);
    deliver(setup_b, error, ideal_b.hi);
    gradients();
  }
  // What the rounding of B and s_max' does to the surface's h, on the triangle and `beyond` outside its h:
  // linear in h, so the ends bound what is between.
  Interval drift_over(double beyond) const {
    const auto at = [this](Interval nearness) {
      return (b_ - ideal_b_) * (nearness - 1) + b_ * nearness * (far_scale_ - 1);
    };
    const Interval out = Interval(beyond) / (b_ * far_scale_);
    return hull(at(Interval(in_.s_max) / in_.s.hi - out), at(Interval(in_.s_max) / in_.s.lo + out));
  }
  // The steepest surface of the range, in codes and texels a pixel.
  void gradients() {
    const Interval inverse = Interval(1) / in_.s;
    // Gradient = (sum of three values times heights) / doubled area; the positive heights sum up to at most
    // the triangle's, and the area is a multiple of 2^-2k.
    const Interval tallest = Interval(in_.y.hi) - in_.y.lo;
    const Interval per_area = std::ldexp(1.0, 2 * c_.subpixel_bits);
    const Interval steepest = (inverse.hi - Interval(inverse.lo)) * tallest * per_area;
    const double gradient = std::min(in_.inverse_s_gradient, steepest.hi);
    h_gradient_ = (hull(scale_, 1) * ideal_b_ * in_.s_max * gradient).hi;
    const auto coordinate = [&](Interval range, double known) {
      const Interval worst = Interval(2) * tallest * per_area * (Interval(range.hi) - range.lo) *
                             square(Interval(inverse.hi)) / square(Interval(inverse.lo));
      return Coordinate{range, std::min(known, worst.hi)};
    };
    uv_ = {coordinate(in_.u, in_.u_gradient), coordinate(in_.v, in_.v_gradient)};
    out_.facts.h_gradient = h_gradient_;
    out_.facts.uv_gradient = {uv_[0].gradient, uv_[1].gradient};
    out_.facts.q_least = q_.lo;
  }

  // Errors of h up to the last step are against B' / B times ideal's h + B, minus B': the rounding of B then
  // shifts the whole surface, and not u and v.
  Error with_drift(Error e) const {
    e.add("setup.b", drift_);
    return e;
  }

  void setup() {
    const Format& s = format(F::setup_s);
    const Interval near = std::ldexp(in_.s.lo, -exponent_);
    const Interval step = rounding(s);
    // s / s' of the nearest vertex, where it is furthest from 1. s' >= s_min' > 0, for rounding is monotone.
    const Interval least = near + step.lo;
    const Interval most_ratio = least.lo >= s_near_ ? near / least : (Interval(s_near_) - step.lo) / s_near_;
    Interval ratio(std::min(1.0, (near / (near + step.hi)).lo), std::max(1.0, most_ratio.hi));
    const Interval farthest = std::ldexp(in_.s.hi, -exponent_);
    if (farthest.hi > values(s).hi) {  // saturates by at most this
      ratio.hi = std::max(ratio.hi, (farthest / values(s).hi).hi);
    }
    s_error_ = ratio - 1;
    vertex_h_ = {};
    vertex_h_.add("setup.s", q_ * s_error_);
    vertex_h_.add("setup.h", rounding(format(F::setup_h)));
    settle(vertex_h_, format(F::setup_h), h_);
    deliver(setup_h, with_drift(vertex_h_), hmax_);
    for (std::size_t i = 0; i < 2; ++i) {
      Error e;
      e.add("setup.uv", rounding(format(F::setup_uv)));
      settle(e, format(F::setup_uv), uv_[i].range);
      vertex_uv_[i] = e;
      deliver(i == 0 ? setup_u : setup_v, e, uv_[i].range.mag());
    }
  }

  // Of the registers' q against the truth at the same place, relative: e is the error of h.
  Interval relative_error(const Error& e) const {
    // The share of setup.s is relative already: q (s / s' - 1).
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

  // By how much the weight w of the far end is off where the two ends' q err by `relative`: the odds
  // w / (1 - w) change by a factor e^d, and w by at most tanh(d / 4) <= d / 4 <= (e^d - 1) / 4.
  static double weight_error(Interval relative) {
    if (relative.lo <= -1) return 1;
    const Interval factor = (1 + Interval(relative.hi)) / (1 + Interval(relative.lo));
    return std::min(1.0, ((factor - 1) / 4).hi);
  }

  // q / q' and 1 / q' of q' = q + walk: q on the line through registers, walk what the accumulator adds.
  // range: of h, the lowest that it is held at and the lowest it may be stopped at from above.
  struct Divided {
    Interval ratio, inverse, operand;
    bool none = false;  // q' may be 0
  };
  Divided divided(Interval q, const WalkError& walk, const Error& total, Interval range) const {
    Divided out;
    const Interval e = total.total();
    // A slope that stops short leaves h between the ends; and no register leaves its own range. One that is
    // stopped from above may fall further on its way, by as much as it is short.
    const Interval small = walk.small.total();
    const bool stopped =
        walk.any || next_up(next_up(q.hi + small.hi) + walk.overshoot) > next_down(b_.lo + range.hi);
    const double between = stopped ? 0 : next_down(next_down(q.lo + small.lo) - walk.overshoot);
    const double least = std::max(between, next_down(b_.lo + range.lo));
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

  // u1 + f (m 2^-e): f stands for change w q on the way.
  struct Quotient {
    std::string_view h_name, slope_unit;
    double change;  // |u2 - u1| of the registers
    const WalkError& f;
    const Error& f_error;  // of f, the slope's relative error and what saturation loses apart
    const Divided& q;
    const UnitError& unit;
  };
  // Adds to e what the division and f add. False where nothing finite holds.
  static bool add_quotient(Error& e, const Quotient& d) {
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

  // 1 / (h + B) as the unit gives it, against ideal's. h: its error on the scaled surface, at a point that is
  // `moved` in h away from where the truth is taken.
  void reciprocal_place(Place p, const Error& h, double moved, const Divided& d, const UnitError& unit,
                        std::string_view h_name) {
    Error e;
    const Interval off = relative_error(h);
    if (d.none || unit.any) {
      deliver(p, e, 1, true);
      return;
    }
    // By the error of h, or by the ends of both ranges.
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

  void edge() {
    const Format& coordinate = c_.coordinate_format();
    const int t_grid = std::max(1, coordinate.fraction());
    const double legal_edge = std::ldexp(1.0, -c_.subpixel_bits);
    const double shortest = std::max(in_.shortest_edge, legal_edge);
    const double tall = std::max(legal_edge, next_up(in_.y.hi - in_.y.lo));
    const double distance = std::max(0.0, next_up(std::min(in_.y.hi, in_.height - 0.5) - in_.y.lo));
    const int additions = static_cast<int>(std::min<double>(in_.height - 1, std::floor(distance)));
    const Slopes slopes{c_.edge_slope, edge_.error({std::min(shortest, tall), tall}),
                        std::min(shortest, tall)};
    out_.facts.edge_distance = distance;
    out_.facts.rows = additions;

    edge_position(t_grid, distance, additions, slopes);

    // h
    const double h_change = next_up(h_.width() + vertex_h_.total().width());
    const Format& kept_h = format(F::edge_h);
    const WalkError h = walk_error(
        c_,
        {F::edge_h_step, F::edge_h_acc, format(F::setup_h).fraction(), t_grid, "start_offset.edge_h",
         offset(c_.start_offset.edge_h, kept_h), distance, additions, h_change, infinite, 0},
        slopes);
    Error h_walk = line_error(h, h_change, "reciprocal.edge");
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

    // The register's own part, against the line through the vertices' registers.
    const Interval line_h = within(h_ + vertex_h_.total(), F::setup_h);
    WalkError kept = h;
    kept.small.add("edge.h", narrowing);
    if (!overflow(h_walk, h, F::edge_h_acc, line_h, additions + 1)) kept.any = true;
    h_walk.add("edge.h", narrowing);
    if (!settle(h_walk, kept_h, line_h)) kept.any = true;
    const Interval line_q = positive(q_ + vertex_h_.total());
    const Interval kept_range = values(kept_h);
    const Interval h_range(
        kept_range.lo, std::min(kept_range.hi, next_down(values(format(F::edge_h_acc)).hi + narrowing.lo)));
    const Divided q = divided(line_q, kept, h_walk, h_range);
    const UnitError unit = q.none ? UnitError{} : pixel_.error(q.operand);
    reciprocal_place(edge_reciprocal, edge_h_, 0, q, unit, "edge.h");
    stage.h_walk = h_walk.total();
    stage.q = line_q;
    stage.q_register = q.operand;
    stage.pixel_error = unit.relative;
    stage.plain = kept.plain() && !q.none && !unit.any;

    const Interval ends = relative_error(vertex_h_);
    for (std::size_t i = 0; i < 2; ++i) {
      const Interval uv = uv_[i].range;
      const double change = next_up(uv.width() + vertex_uv_[i].total().width());
      const double f_change = (Interval(change) * line_q.hi).hi;
      WalkError f = walk_error(c_,
                               {F::edge_f_step, F::edge_f, 0, t_grid, key_of(F::edge_f),
                                offset(c_.start_offset.edge_f, format(F::edge_f)), distance, additions,
                                next_up(f_change + ulp(format(F::edge_f_diff))), infinite, 0},
                               slopes);
      const Error f_error =
          f_walk_error(F::edge_f_diff, F::edge_f, f, f_change, additions,
                       std::max(format(F::setup_h).fraction(), format(F::setup_b).fraction()) +
                           format(F::setup_uv).fraction());
      f_place(i == 0 ? edge_fu : edge_fv, f, f_error, f_change, vertex_uv_[i], ends, uv, 0,
              "reciprocal.edge");

      Error e = vertex_uv_[i];
      e.add("weights by h of the vertices",
            Interval::plus_minus((Interval(uv.width()) * weight_error(ends)).hi));
      stage.uv_change[i] = Interval::plus_minus(change);
      stage.uv_carried[i] = e.total();
      stage.f_change[i] = Interval::plus_minus(f_change);
      stage.f_walk[i] = f_error.total();
      stage.plain = stage.plain && f.plain();
      const bool finite =
          add_quotient(e, {"h of the edge walk", "reciprocal.edge", change, f, f_error, q, unit});
      e.add("edge.uv", rounding(format(F::edge_uv)));
      finish_uv(e, finite, format(F::edge_uv), uv);
      edge_uv_[i] = e;
      deliver(i == 0 ? edge_u : edge_v, e, uv.mag());
    }
  }

  static Interval positive(Interval q) { return {std::max(q.lo, std::numeric_limits<double>::min()), q.hi}; }

  // Where nothing finite is known before the register, its range is.
  static void finish_uv(Error& e, bool finite, const Format& f, Interval truth) {
    if (!finite) {
      e.replace("range of the register", values(f) - truth);
      return;
    }
    settle(e, f, truth);
  }

  void edge_position(int t_grid, double distance, int additions, const Slopes& slopes) {
    position_ = {};
    if (has_x_step(c_)) {
      const double change = next_up(in_.x.hi - in_.x.lo);
      const int steps = sums_x_steps(c_.dda_update) ? additions : 0;
      const WalkError x = walk_error(
          c_,
          {F::edge_x_step, F::edge_x_acc, c_.subpixel_bits, t_grid, "start_offset.edge_x",
           offset(c_.start_offset.edge_x, format(F::edge_x)), distance, steps, change, infinite, 0},
          slopes);
      position_ = line_error(x, change, "reciprocal.edge");
      overflow(position_, x, F::edge_x_acc, in_.x, steps + 1);
      deliver(edge_x_acc, position_, in_.x.mag());
    }
    position_.add("edge.x",
                  rounding(format(F::edge_x),
                           has_x_step(c_) ? std::optional(format(F::edge_x_acc).fraction()) : std::nullopt));
    // Where x and the pixel centres are values of edge.x, rounding, being monotone, leaves a covered centre
    // between the row's ends. Else nothing is known of the way from the left end.
    const Interval x_values = values(format(F::edge_x));
    settle(position_, format(F::edge_x), in_.x);
    x_any_ =
        !(in_.x + position_.total()).inside(x_values) || !Interval(0.5, in_.width - 0.5).inside(x_values);
    deliver(edge_x, position_, in_.x.mag());
    out_.facts.x_error = position_.total().mag();
  }

  // Of a walk along a line whose ends are `change` apart.
  Error line_error(const WalkError& w, double change, std::string_view unit) {
    Error e = w.small;
    e.add(unit, Interval::plus_minus(change) * w.slope_error);
    if (w.lost > 0) {
      e.add("saturated slope", Interval::plus_minus(w.lost));
      out_.facts.slope_saturates = true;
    }
    return e;
  }
  // Values that a register has are in its range.
  Interval within(Interval x, F id) const {
    const Interval range = values(format(id));
    return {std::clamp(x.lo, range.lo, range.hi), std::clamp(x.hi, range.lo, range.hi)};
  }
  // settle() of a walk's accumulator.
  bool overflow(Error& e, const WalkError& w, F acc, Interval truth, int times) const {
    if (!w.any) return settle(e, format(acc), truth, times);
    e.replace("overflow", values(format(acc)) - truth);
    return false;
  }

  // Of f's register, against (1 + slope error) (the way made of the change): its own roundings and that of
  // the difference it starts from.
  Error f_walk_error(F diff, F acc, WalkError& w, double change, int additions, int grid) {
    const Interval truth = Interval::plus_minus(change);
    const Interval scale = 1 + w.slope_error;
    Error e;
    e.add(key_of(diff), rounding(format(diff), grid) * scale);
    if (!settle(e, format(diff), truth)) w.any = true;
    e.share();  // times the way made
    e.add(w.small);
    if (w.lost > 0) out_.facts.slope_saturates = true;
    if (!overflow(e, w, acc, hull(truth * scale, 0), additions + 1)) w.any = true;
    return e;
  }

  // f's register against (u - u1) (h + B) of ideal. position: what the centre's distance from the row's point
  // adds.
  void f_place(Place p, const WalkError& w, const Error& f_error, double change, const Error& ends_uv,
               Interval ends_q, Interval uv, double position, std::string_view unit) {
    const F acc = p < span_h ? F::edge_f : F::span_f;
    Error e = f_error;
    e.add(unit, Interval::plus_minus(change) * (w.lost > 0 ? hull(w.slope_error, -1) : w.slope_error));
    const Interval ideal_change = Interval::plus_minus(uv.width());
    e.add("h of the ends", ideal_change * ideal_q_.hi * (scale_ * (1 + ends_q) - 1));
    e.add("u, v of the ends",
          Interval::plus_minus(ends_uv.total().width()) * ideal_q_.hi * scale_ * (1 + ends_q));
    if (position > 0) e.add("edge.x", Interval::plus_minus(position));
    if (w.any) e.add("overflow", values(format(acc)) * 2);
    deliver(p, e, acc, Interval::plus_minus((Interval(uv.width()) * ideal_q_.hi + position).hi));
  }

  void span() {
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
    // A row's registers are an ulp of edge.x apart, or nothing is divided.
    const double shortest = std::clamp(next_down(in_.shortest_row - off.width()), unit_x, longest);
    const Slopes slopes{c_.row_slope, row_.error({shortest, longest}), shortest};
    out_.facts.span_distance = distance;
    out_.facts.pixels = additions;
    const int p_grid = std::max(1, x_format.fraction());
    const double away = off.mag();  // from a pixel's centre to the point of the chord that it stands for

    // h: change along a chord.
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
    Error h_walk = line_error(h, h_change, "reciprocal.row");
    Error at_chord = edge_h_;
    at_chord.add(h_walk);
    if (!overflow(at_chord, h, F::span_h, h_, additions + 1)) h.any = true;
    // The chord's point and the pixel's centre: apart by the error of the ends' x. Between the same ends,
    // where coverage is exact, by no more than the ends differ.
    double moved = (Interval(h_gradient_) * away).hi;
    if (exact && moved > chord_h) {
      moved = chord_h;
      out_.facts.position_capped = true;
    }
    Error total = at_chord;
    total.add("edge.x", Interval::plus_minus(moved));
    const double beyond = exact ? 0 : moved;  // outside the triangle
    const Interval drift = drift_over(beyond);
    total.add("setup.b", drift);
    deliver(span_h, total, F::span_h, Interval(-beyond, hmax_ + beyond));
    depth_places(total, beyond);
    const Interval line_h = within(h_ + end_h, F::edge_h);
    if (!overflow(h_walk, h, F::span_h, line_h, additions + 1)) h.any = true;
    const Interval line_q = positive(q_ + end_h);
    const Divided q = divided(line_q, h, h_walk, values(format(F::span_h)));
    const UnitError unit = q.none ? UnitError{} : pixel_.error(q.operand);
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
    stage.plain = h.plain() && !q.none && !unit.any;

    const Interval ends = relative_error(edge_h_);
    for (std::size_t i = 0; i < 2; ++i) {
      span_coordinate(i, slopes, q, unit, ends, line_q, distance, additions, p_grid, away, wide, centre_q);
    }
  }

  void span_coordinate(std::size_t i, const Slopes& slopes, const Divided& q, const UnitError& unit,
                       Interval ends, Interval line_q, double distance, int additions, int p_grid,
                       double away, double wide, Interval centre_q) {
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
    const Error f_error = f_walk_error(F::span_f_diff, F::span_f, f, f_change, additions,
                                       std::max(format(F::edge_h).fraction(), format(F::setup_b).fraction()) +
                                           format(F::edge_uv).fraction());
    // (u - u1) q changes by q du + (u - u1) dq.
    const double f_moved =
        ((Interval(uv_[i].gradient) * ideal_q_.hi + Interval(uv.width()) * h_gradient_) * away).hi;
    const double f_most = (Interval(2) * uv.width() * ideal_q_.hi).hi;
    f_place(i == 0 ? span_fu : span_fv, f, f_error, f_change, edge_uv_[i], ends, Interval(0, chord),
            exact ? std::min(f_moved, f_most) : f_moved, "reciprocal.row");

    Error e = edge_uv_[i];
    e.add("weights by h of the ends", Interval::plus_minus((Interval(chord) * weight_error(ends)).hi));
    bool finite = true;
    double moved = (Interval(uv_[i].gradient) * away).hi;
    if (exact) {
      moved = std::min(moved, chord);
    } else if (centre_q.lo > 0) {
      // Outside the triangle on its row: du/dx = N(y) / q^2.
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
    stage.plain = stage.plain && f.plain() && finite;
    const bool divides = add_quotient(e, {"h of the span", "reciprocal.row", change, f, f_error, q, unit});
    e.add("span.uv", rounding(format(F::span_uv)));
    if (finite) {
      const Interval truth = exact ? uv : uv + Interval::plus_minus(moved);
      finish_uv(e, divides, format(F::span_uv), truth);
    }
    deliver(i == 0 ? span_u : span_v, e, uv.mag(), !finite);
    deliver(i == 0 ? picture_u : picture_v, e, uv.mag(), !finite);
  }

  // beyond: how far outside 0..hmax the truth may be.
  void depth_places(const Error& h, double beyond) {
    const Format z = c_.depth_format();
    const bool reversed = is_complement_of_h(c_.depth_code);
    Error e;
    e.add(h, reversed ? Interval(-1) : Interval(1));
    e.add("depth.round", rounding(z, format(F::span_h).fraction()));
    settle(e, z, Interval(0, hmax_) + Interval::plus_minus(beyond));
    deliver(depth_z, e, hmax_);
    // The truth's picture holds the nearest code.
    e.add("the nearest code of the truth", Interval::plus_minus(0.5));
    deliver(picture_depth, e, hmax_);
  }

  Config c_;
  Unit pixel_, row_, edge_;
  InputRange in_;
  Analysis out_;
  int exponent_ = 0;
  double hmax_ = 0, s_near_ = 0;
  Interval b_, ideal_b_, far_scale_, scale_, ideal_q_, q_, h_, drift_, s_error_;
  double h_gradient_ = 0;
  bool x_any_ = false;
  std::array<Coordinate, 2> uv_{};
  Error vertex_h_, edge_h_, position_;
  std::array<Error, 2> vertex_uv_, edge_uv_;
};

// ---- Texts ----

std::string number(double x) { return std::isinf(x) ? "infinite" : fmt::format("{:.4g}", x); }

std::string dominant_of(const PlaceError& place) {
  if (place.unbounded) return "no finite bound";
  double sum = 0;
  const std::pair<std::string_view, Interval>* largest = nullptr;
  for (const auto& term : place.error.terms()) {
    sum += term.second.mag();
    if (largest == nullptr || term.second.mag() > largest->second.mag()) largest = &term;
  }
  if (largest == nullptr) return "exact";
  return fmt::format("{}: {} ({:.0f} % of the sum)", largest->first, number(largest->second.mag()),
                     100 * largest->second.mag() / sum);
}

std::string why_of(std::size_t p, const Config& c, const Facts& f) {
  const auto walked = [&](const char* what, double distance, int additions) {
    return fmt::format(
        "{} ways of up to {} pixels, {} additions: a step's rounding counts by the way, an "
        "addition's where the accumulator is coarser than the step",
        what, number(distance), additions);
  };
  const bool divides = !shares_reciprocal(c.edge_slope);
  switch (p) {
    case setup_b:
      return "rounding of B and of s_min', s_max'; it scales the whole surface, and leaves u and v alone";
    case setup_h:
      return "rounding of s' counts by q (s / s' - 1), most at the nearest vertex; then the register's "
             "rounding";
    case setup_u:
    case setup_v:
      return "one rounding";
    case edge_x_acc:
    case edge_x:
      return !has_x_step(c) ? "x is exact before the rounding" : walked("edges are", f.edge_distance, f.rows);
    case edge_h_acc:
    case edge_h:
      return walked("edges are", f.edge_distance, f.rows) +
             "; an edge of height d is left after d rows at most, so the rounding of its " +
             (divides ? "slope" : "slope and the reciprocal's error") +
             " cannot add up further however steep it is" +
             (f.slope_saturates
                  ? "; a slope beyond its register stops short of the far end and adds what is missing"
                  : "");
    case edge_fu:
    case edge_fv:
    case span_fu:
    case span_fv:
      return "against (u - u1)(h + B) of the truth: errors of the ends times the largest q, and the walk's "
             "own";
    case edge_reciprocal:
    case span_reciprocal:
      return fmt::format(
          "relative; error of h over the least h + B, {}, and the unit's own error over its whole "
          "table",
          number(f.q_least));
    case edge_u:
    case edge_v:
      return fmt::format(
          "u is between the vertices' u by weights w = t q2 / q: their h errs relative to q >= {}; f "
          "and 1/(h + B) count on the change of u only",
          number(f.q_least));
    case span_h:
    case depth_z:
    case picture_depth:
      return walked("rows are", f.span_distance, f.pixels) +
             fmt::format("; x of the ends errs by {} pixel, times {} codes a pixel", number(f.x_error),
                         number(f.h_gradient)) +
             (f.position_capped
                  ? "; capped by the change between the ends, for a covered centre lies between them: "
                    "a sliver's chord may be shorter than an ulp of edge.x"
                  : "") +
             (f.slope_saturates ? "; a slope beyond its register stops short of the far end" : "");
    case span_u:
    case span_v:
    case picture_u:
    case picture_v:
    default:
      return fmt::format(
          "as edge.uv along a row: {} pixels, q >= {}, x of the ends errs by {} pixel, times {} texels "
          "a pixel, capped in exact coverage by the change between the ends",
          f.pixels, number(f.q_least), number(f.x_error),
          number(p == span_u || p == picture_u ? f.uv_gradient[0] : f.uv_gradient[1]));
  }
}

std::vector<Bound> texts(const Config& config, const std::array<PlaceError, place_count>& places,
                         const std::array<Facts, place_count>& facts) {
  std::vector<Bound> out;
  // The same places for every range of a configuration, also where no pixel is covered.
  for (std::size_t p = 0; p < place_count; ++p) {
    if (p == edge_x_acc && !has_x_step(config)) continue;
    const PlaceName& name = place_names[p];
    Bound b{name.place,
            name.stage,
            name.quantity,
            name.unit,
            places[p].bound(),
            places[p].resolution,
            dominant_of(places[p]),
            places[p].used ? why_of(p, config, facts[p]) : "never computed: no pixel's centre is covered",
            {}};
    for (const auto& term : places[p].error.terms())
      b.terms.push_back({std::string(term.first), term.second});
    out.push_back(std::move(b));
  }
  return out;
}

bool is_bounded(Perspective p) {
  switch (p) {
    case Perspective::delta_f:
      return true;
    case Perspective::const_depth_rows:
    case Perspective::hyperbolic:
    case Perspective::affine:
      return false;
  }
  unreachable();
}
bool is_bounded(DepthCode code) {
  switch (code) {
    case DepthCode::inverse:
    case DepthCode::opengl:
      return true;
    case DepthCode::linear:
      return false;
  }
  unreachable();
}
void check_modes(const Config& config) {
  const auto refuse = [](std::string_view key, std::string_view value, std::string_view legal) {
    throw InputError(fmt::format("{}: no bound is known for {}; legal for bounds: {}", key, value, legal));
  };
  if (!is_bounded(config.perspective)) {
    refuse("perspective.mode", to_string(config.perspective), "delta_f");
  }
  if (!is_bounded(config.depth_code)) refuse("depth.code", to_string(config.depth_code), "inverse, opengl");
}

void check_range(const InputRange& r) {
  const auto refuse = [](const char* name, const std::string& text) {
    throw InputError(fmt::format("input range: {}: {}", name, text));
  };
  if (r.width < 1 || r.height < 1) refuse("width, height", "legal: 1 and more");
  if (!(std::isfinite(r.s_max) && r.s_min > 0 && r.s_min < r.s_max)) {
    refuse("s_min, s_max", "legal: finite, 0 < s_min < s_max");
  }
  const auto interval = [&](const char* name, Interval i) {
    if (!(std::isfinite(i.lo) && std::isfinite(i.hi) && i.lo <= i.hi))
      refuse(name, "legal: finite, lo <= hi");
  };
  interval("s", r.s);
  interval("x", r.x);
  interval("y", r.y);
  interval("u", r.u);
  interval("v", r.v);
  if (!(r.s_min <= r.s.lo && r.s.hi <= r.s_max)) refuse("s", "legal: within s_min..s_max");
  for (const double g :
       {r.shortest_edge, r.shortest_row, r.longest_row, r.inverse_s_gradient, r.u_gradient, r.v_gradient}) {
    if (!(g >= 0)) refuse("shortest_edge, gradients", "legal: 0 and more");
  }
}

}  // namespace

bool has_bounds(const Config& config) {
  return is_bounded(config.perspective) && is_bounded(config.depth_code);
}

std::vector<Bound> error_bounds(const Config& config, const InputRange& range) {
  check_modes(config);
  check_range(range);
  const Analysis analysis = Analyser(config).run(range);
  std::array<Facts, place_count> facts;
  facts.fill(analysis.facts);
  return texts(config, analysis.places, facts);
}

std::function<double(const InputRange&)> edge_position_error(const Config& config) {
  check_modes(config);
  return [analyser = std::make_shared<Analyser>(config)](const InputRange& range) {
    check_range(range);
    return analyser->run(range).places[edge_x].bound();
  };
}

std::vector<Bound> error_bounds(const Config& config, const Scene& scene) {
  check_modes(config);
  std::vector<InputRange> triangles = triangle_ranges(config, scene);
  if (triangles.empty()) triangles.push_back(input_range(config, scene));
  Analyser analyser(config);
  std::array<PlaceError, place_count> places;
  std::array<Facts, place_count> facts;
  for (const InputRange& r : triangles) {
    check_range(r);
    Analysis own = analyser.run(r);
    for (std::size_t p = 0; p < place_count; ++p) {
      if (!own.places[p].used) continue;
      const double resolution = std::max(places[p].resolution, own.places[p].resolution);
      if (!places[p].used || own.places[p].bound() > places[p].bound()) {
        places[p] = std::move(own.places[p]);
        facts[p] = own.facts;
      }
      places[p].resolution = resolution;
    }
  }
  return texts(config, places, facts);
}

Hypotheses bound_hypotheses(const Config& config, const InputRange& range) {
  check_modes(config);
  check_range(range);
  return Analyser(config).run(range).hypotheses;
}

std::vector<BoundCheck> check_bounds(std::span<const Bound> bounds, std::span<const FieldError> observed) {
  std::vector<BoundCheck> out;
  for (const FieldError& field : observed) {
    const Bound* found = nullptr;
    for (const Bound& b : bounds) {
      if (b.stage == field.stage && b.quantity == field.quantity) found = &b;
    }
    if (found == nullptr || field.count == 0) continue;
    BoundCheck check{found->place, field.stage, field.quantity, found->unit, found->bound,
                     field.max,    0,           false};
    check.ratio = field.max == 0 ? 0 : field.max / found->bound;
    check.holds = field.max <= found->bound + found->resolution;  // false for a NaN
    out.push_back(std::move(check));
  }
  return out;
}

bool all_hold(std::span<const BoundCheck> checks) {
  return std::all_of(checks.begin(), checks.end(), [](const BoundCheck& c) { return c.holds; });
}

}  // namespace bitspan
