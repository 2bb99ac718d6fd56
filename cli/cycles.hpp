// SPDX-License-Identifier: Apache-2.0
// The timed model's span interpolator against the RTL, clock for clock.
#pragma once

#include <cstddef>
#include <limits>

#include "cli/verdict.hpp"

namespace bitspan {

// Runs systemc over the scene (its first `triangles`, where it has more), records in_valid and out_ready of
// its span interpolator on every clock, drives the RTL with the same, and compares in_ready and out_valid on
// every clock and each value delivered. The configuration must have RTL.
CycleVerdict compare_cycles(const Config& config, const Scene& scene,
                            std::size_t triangles = std::numeric_limits<std::size_t>::max());

}  // namespace bitspan
