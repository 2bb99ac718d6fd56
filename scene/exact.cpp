// SPDX-License-Identifier: Apache-2.0
#include "scene/exact.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace bitspan {
namespace {

// The sign of a - b.
int order(double a, double b) { return a > b ? 1 : a < b ? -1 : 0; }

// Whether a - b is a double: Knuth's sum in two parts, whose second is 0.
bool is_exact(double a, double b) {
  const double difference = a - b, virtual_b = a - difference;
  return (a - (difference + virtual_b)) + (virtual_b - b) == 0;
}

}  // namespace

int orientation(double ax, double ay, double bx, double by, double cx, double cy) {
  const double left = (bx - ax) * (cy - ay);
  const double right = (by - ay) * (cx - ax);
  const double area = left - right;
  // Five roundings of relative size 2^-53 lie in front of `area`; 2^-50 bounds them all. Below 1e-280 a
  // product may have lost bits to underflow.
  const double bound = 0x1p-50 * (std::fabs(left) + std::fabs(right));
  if (std::fabs(area) > bound && std::fabs(area) > 1e-280) return area > 0 ? 1 : -1;

  // The products' signs are those of comparisons. They decide where lines run along an axis.
  const int left_sign = order(bx, ax) * order(cy, ay), right_sign = order(by, ay) * order(cx, ax);
  if (left_sign != right_sign) return left_sign > right_sign ? 1 : -1;
  if (left_sign == 0 || (bx == cx && by == cy)) return 0;
  // Where the differences are exact, so are products in two parts.
  if (is_exact(bx, ax) && is_exact(cy, ay) && is_exact(by, ay) && is_exact(cx, ax) &&
      std::fabs(left) > 1e-280 && std::fabs(right) > 1e-280 && std::isfinite(bound)) {
    if (left != right) return left > right ? 1 : -1;
    return order(std::fma(bx - ax, cy - ay, -left), std::fma(by - ay, cx - ax, -right));
  }

  using Rational = boost::multiprecision::cpp_rational;
  const Rational x(ax), y(ay);
  const Rational exact = (Rational(bx) - x) * (Rational(cy) - y) - (Rational(by) - y) * (Rational(cx) - x);
  return exact.sign();
}

}  // namespace bitspan
