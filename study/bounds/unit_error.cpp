// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/unit_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "config/modes.hpp"
#include "config/reciprocal.hpp"
#include "study/bounds/format_range.hpp"

namespace bitspan::bounds {
namespace {

constexpr std::int64_t runs = 16;

// Returns the range of y nq - 1 for y = c - slope t and nq = a + step t, t in 0..1. It is a parabola in t
// that opens downward.
Interval line(double c, Interval slope, double a, double step) {
  const auto product = [&](double t) { return (c - slope * t) * (a + Interval(step) * t) - 1; };
  const auto growth = [&](double t) { return (c - slope * t) * step - slope * (a + Interval(step) * t); };
  Interval relative = hull(product(0), product(1));
  // The parabola lies below each of its tangents. The one near the top is level, so any guess of the top
  // proves a bound.
  const double top = slope.hi > 0 ? std::clamp((c * step / slope.hi - a) / (2 * step), 0.0, 1.0) : 0.0;
  const Interval tangent = product(top) + growth(top) * Interval(-top, 1 - top);
  relative.hi = std::max(relative.hi, tangent.hi);
  return relative;
}

// Returns the range of y nq - 1 for y = c0 - (c1 - c2 t) t and nq = a + step t, t in 0..1. It is a cubic in
// t. A piece of it lies in the hull of its Bernstein coefficients.
Interval parabola(double c0, double c1, double c2, double a, double step) {
  constexpr int pieces = 8;
  constexpr double w = 1.0 / pieces;
  // The coefficients of the powers of t.
  const Interval k0 = Interval(c0) * a - 1;
  const Interval k1 = Interval(c0) * step - Interval(c1) * a;
  const Interval k2 = Interval(c2) * a - Interval(c1) * step;
  const Interval k3 = Interval(c2) * step;
  Interval relative = k0;
  for (int i = 0; i < pieces; ++i) {
    // The coefficients of the powers of x, where t = u + w x and x is in 0..1.
    const Interval u(i * w);
    const Interval b0 = k0 + u * (k1 + u * (k2 + u * k3));
    const Interval b1 = Interval(w) * (k1 + u * (2 * k2 + 3 * u * k3));
    const Interval b2 = Interval(w * w) * (k2 + 3 * u * k3);
    const Interval b3 = Interval(w * w * w) * k3;
    relative = hull(relative, b0);
    relative = hull(relative, b0 + b1 / 3);
    relative = hull(relative, b0 + (2 * b1 + b2) / 3);
    relative = hull(relative, b0 + b1 + b2 + b3);
  }
  return relative;
}

}  // namespace

Unit::Unit(const Reciprocal& r) : r_(r), table_(reciprocal_table(r)) {
  if (!has_table(r.kind)) {
    parts_ = {{Interval(1, 2), 0, 0}};
    return;
  }
  fraction_ = parts_of(r).fraction;
  const std::int64_t entries = std::int64_t{1} << r.index_bits;
  const std::int64_t run = std::max<std::int64_t>(1, entries / runs);
  for (std::int64_t first = 0; first < entries; first += run) {
    Interval table;
    for (std::int64_t j = first; j < first + run; ++j) {
      const Interval own = segment(j);
      table = j == first ? own : hull(table, own);
    }
    const double step = 1.0 / static_cast<double>(entries);
    const Interval nq(1 + static_cast<double>(first) * step, 1 + static_cast<double>(first + run) * step);
    // n is less than 2^-operand_bits above nq, and below the run's end.
    parts_.push_back({nq, table, with_rest(computed(nq, table))});
  }
}

UnitError Unit::error(Interval d) const {
  const Interval range = values(r_.output);
  UnitError out;
  bool first = true;
  double most = 0;  // the largest y, or y 2^-e
  const auto join = [&](Interval e) {
    out.relative = first ? e : hull(out.relative, e);
    first = false;
  };
  for (const TablePart& part : parts_) {
    const Interval y = (1 + part.relative) / part.operand;
    most = std::max(most, r_.normalize ? y.hi : ((1 + part.relative) / d.lo).hi);
    const Interval step = r_.normalize ? rounding(r_.output, fraction_) : rounding(r_.output);
    join(part.relative + step * (r_.normalize ? part.operand : d));
  }
  // Rounding is monotone. Only what is beyond the largest value is therefore rounded past it.
  if (most <= range.hi) return out;
  if (!saturates(r_.output)) {
    out.any = true;
    return out;
  }
  out.relative = hull(out.relative, Interval(range.hi) * (r_.normalize ? 1 : d.lo) - 1);
  return out;
}

double Unit::table_value(std::int64_t i) const {
  return std::ldexp(static_cast<double>(table_[static_cast<std::size_t>(i)]), -r_.table_bits);
}

// Returns the range of y nq - 1 over segment j, as it is read from the table.
Interval Unit::segment(std::int64_t j) const {
  const double step = std::ldexp(1.0, -r_.index_bits);
  const double a = 1 + static_cast<double>(j) * step;
  const double y = table_value(j);
  switch (r_.kind) {
    case ReciprocalKind::restoring:  // has no table
      break;
    case ReciprocalKind::lut_linear:
      return line(y, Interval(y) - table_value(j + 1), a, step);
    case ReciprocalKind::lut_newton:
      return Interval(a, a + step) * y - 1;
    case ReciprocalKind::lut_quadratic: {
      const std::int64_t segments = std::int64_t{1} << r_.index_bits;
      // g is cut, and counts t times. y becomes larger by less than that.
      const Interval cut_of_g(0, std::ldexp(1.0, -r_.internal_bits));
      return parabola(y, table_value(segments + j), table_value(2 * segments + j), a, step) +
             Interval(a, a + step) * cut_of_g;
    }
  }
  unreachable();
}

// Returns y nq - 1 after the truncations. With e = nq y - 1, a Newton step gives -e^2 + (1 + e) r1 - nq r2.
// Its two truncations are a = nq y - r1 and y' = y (2 - a) - r2.
Interval Unit::computed(Interval nq, Interval e) const {
  const Interval lost(0, std::ldexp(1.0, -r_.internal_bits));
  switch (r_.kind) {
    case ReciprocalKind::restoring:  // has no table
      break;
    case ReciprocalKind::lut_linear:
    case ReciprocalKind::lut_quadratic:
      return e - nq * lost;
    case ReciprocalKind::lut_newton:
      for (int i = 0; i < r_.steps; ++i) e = (1 + e) * lost - square(e) - nq * lost;
      return e;
  }
  unreachable();
}

// Turns y nq - 1 into y n - 1, where n / nq is 1 to 1 + 2^-operand_bits.
Interval Unit::with_rest(Interval e) const {
  return e + (1 + e) * Interval(0, std::ldexp(1.0, -r_.operand_bits));
}

}  // namespace bitspan::bounds
