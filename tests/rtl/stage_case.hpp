// SPDX-License-Identifier: Apache-2.0
// What the tests of the pixel stages in RTL share: seeds, random configurations, the sweep after reset.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tests/rtl/stage_bench.hpp"

namespace bitspan {

// As many seeds as $BITSPAN_RTL_CONFIGS, else `count`, from $BITSPAN_RTL_SEED, else 1, on.
std::vector<std::uint64_t> stage_seeds(int count);
// How to run one of them alone.
std::string stage_seed_text(std::uint64_t seed);
// Legal, of any mode, and with a package for the pixel stages.
Config random_stage_config(std::uint64_t seed);
// Runs the clocks in which a stage clears its scoreboard after reset.
void await_sweep(StageBench& bench, const Config& config);

}  // namespace bitspan
