// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/places.hpp"

#include <cmath>

namespace bitspan::bounds {

namespace {

double rounded_up(double x) {
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::ceil(std::ldexp(mantissa, 32)), exponent - 32);
}

}  // namespace

double PlaceError::bound() const {
  return unbounded ? std::numeric_limits<double>::infinity() : rounded_up(error.total().mag());
}

}  // namespace bitspan::bounds
