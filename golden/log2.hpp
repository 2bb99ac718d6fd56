// SPDX-License-Identifier: Apache-2.0
// Lg of docs/numeric-spec.md: the binary logarithm, linear between powers of two.
#pragma once

#include "golden/real.hpp"

namespace bitspan::golden {

// x > 0.
template <class Real>
Real linear_log2(Real x) {
  const int e = exponent_of(x);
  return Real(e - 1) + x * pow2<Real>(-e);
}

}  // namespace bitspan::golden
