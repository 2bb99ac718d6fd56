// SPDX-License-Identifier: Apache-2.0
// Closed intervals of real numbers, for proofs. Every operation gives an interval that holds each result that
// its operands can have.
//
// The ends are doubles. A sum, product or quotient of two doubles is correctly rounded (IEEE 754, round to
// nearest). The real result therefore lies between the doubles next to the rounded one, and each end is moved
// one double outward. No rounding mode is switched, so nothing depends on what the compiler moves across a
// switch. The build has no -ffast-math and no contraction into fused operations, which would only be closer
// to the real result.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bitspan {

inline double next_down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }
inline double next_up(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }

struct Interval {
  double lo = 0;
  double hi = 0;

  Interval() = default;
  Interval(double x) : lo(x), hi(x) {}  // NOLINT(google-explicit-constructor): a number is an interval
  Interval(double low, double high) : lo(low), hi(high) {}

  static Interval plus_minus(double x) { return {-x, x}; }
  double mag() const { return std::max(std::fabs(lo), std::fabs(hi)); }
  // Returns a value that is not below hi - lo.
  double width() const { return lo == hi ? 0 : next_up(hi - lo); }
  bool holds(double x) const { return lo <= x && x <= hi; }
  bool inside(const Interval& of) const { return of.lo <= lo && hi <= of.hi; }
  bool operator==(const Interval&) const = default;
};

inline Interval hull(Interval a, Interval b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
inline Interval operator-(Interval a) { return {-a.hi, -a.lo}; }

inline Interval operator+(Interval a, Interval b) {
  if (a == Interval(0)) return b;  // exact, and frequent
  if (b == Interval(0)) return a;
  const double lo = a.lo + b.lo;
  const double hi = a.hi + b.hi;
  return {lo == 0 ? 0 : next_down(lo), hi == 0 ? 0 : next_up(hi)};  // a sum that comes to 0 is 0
}
inline Interval operator-(Interval a, Interval b) { return a + (-b); }

inline Interval operator*(Interval a, Interval b) {
  if (a == Interval(1)) return b;
  if (b == Interval(1)) return a;
  const auto product = [](double x, double y) -> Interval {
    if (x == 0 || y == 0) return 0;
    return {next_down(x * y), next_up(x * y)};
  };
  return hull(hull(product(a.lo, b.lo), product(a.lo, b.hi)), hull(product(a.hi, b.lo), product(a.hi, b.hi)));
}

// b must not hold 0.
inline Interval operator/(Interval a, Interval b) {
  if (b.lo <= 0 && b.hi >= 0) throw std::logic_error("interval division by an interval that holds 0");
  const auto [lo, hi] = std::minmax({a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi});
  return {next_down(lo), next_up(hi)};
}

inline Interval& operator+=(Interval& a, Interval b) { return a = a + b; }

// Returns the values of x t for t in 0..1.
inline Interval share_of(Interval x) { return hull(x, 0); }
inline Interval square(Interval x) {
  const Interval s = x * x;
  return x.holds(0) ? Interval(0, s.hi) : Interval(std::max(s.lo, 0.0), s.hi);
}

}  // namespace bitspan
