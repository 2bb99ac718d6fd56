// SPDX-License-Identifier: Apache-2.0
// The one way a double comes in: taken apart into mantissa and exponent, without loss.
#pragma once

#include "model/numeric/exact.hpp"

namespace bitspan::model {

// x exactly, with the fewest bits (an odd raw value, or 0); x finite.
Exact exact_of(double x);

// The smallest E with x <= 2^E; x finite and > 0.
int ceil_log2(double x);

}  // namespace bitspan::model
