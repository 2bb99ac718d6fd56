// SPDX-License-Identifier: Apache-2.0
// The timed model against the RTL, clock for clock: the span interpolator, and the chain from it to merge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "cli/verdict.hpp"

namespace bitspan {

// Runs systemc over the scene (its first `triangles`, where it has more), records in_valid and out_ready of
// its span interpolator on every clock, drives the RTL with the same, and compares in_ready and out_valid on
// every clock and each value delivered. The configuration must have RTL.
CycleVerdict compare_cycles(const Config& config, const Scene& scene,
                            std::size_t triangles = std::numeric_limits<std::size_t>::max());

// Runs systemc with the RTL's ports over the scene, once with an ideal memory and once with one of random
// latencies and stalls, and beside it, clock by clock, the span interpolator and the pixel stages in RTL as
// they are connected: pixels go from one design to the other. Compares every output of every handshake on
// every clock, and the picture. Returns nothing where the RTL does not draw the scene.
std::vector<ChainVerdict> compare_chain(const Config& config, const Scene& scene, std::uint64_t seed,
                                        std::size_t triangles = std::numeric_limits<std::size_t>::max());

// Both over the first few triangles of a scene.
struct ClockCheck {
  std::uint64_t interpolator_clocks = 0, chain_clocks = 0;  // compared
  std::string failure;                                      // one line, empty where all are equal
};
ClockCheck check_clocks(const Config& config, const Scene& scene, std::uint64_t seed);

}  // namespace bitspan
