// SPDX-License-Identifier: Apache-2.0
// Proves from the formats and the table of the reciprocal square root RS how far its m 2^-e is from 1 /
// sqrt(d).
#pragma once

#include "config/config.hpp"
#include "study/bounds/unit_error.hpp"

namespace bitspan::bounds {

// Returns an interval that holds the root of each number of x; x is not below 0.
Interval root_of(Interval x);

// m 2^-e = (1 + relative) / sqrt(d), of every d > 0.
UnitError root_error(const Config& config);

}  // namespace bitspan::bounds
