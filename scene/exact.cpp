// SPDX-License-Identifier: Apache-2.0
#include "scene/exact.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace bitspan {

int orientation(double ax, double ay, double bx, double by, double cx, double cy) {
  const double left = (bx - ax) * (cy - ay);
  const double right = (by - ay) * (cx - ax);
  const double area = left - right;
  // Five roundings of relative size 2^-53 lie in front of `area`; 2^-50 bounds them all. Below 1e-280 a
  // product may have lost bits to underflow.
  const double bound = 0x1p-50 * (std::fabs(left) + std::fabs(right));
  if (std::fabs(area) > bound && std::fabs(area) > 1e-280) return area > 0 ? 1 : -1;

  using Rational = boost::multiprecision::cpp_rational;
  const Rational x(ax), y(ay);
  const Rational exact = (Rational(bx) - x) * (Rational(cy) - y) - (Rational(by) - y) * (Rational(cx) - x);
  return exact.sign();
}

}  // namespace bitspan
