// SPDX-License-Identifier: Apache-2.0
// What the tests of the pixel stages in RTL share: seeds, random configurations, the sweep after reset.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "tests/rtl/rtl_copy.hpp"
#include "tests/rtl/stage_bench.hpp"

namespace bitspan {

// As many seeds as $BITSPAN_RTL_CONFIGS, else `count`, from $BITSPAN_RTL_SEED, else 1, on.
std::vector<std::uint64_t> stage_seeds(int count);
// How to run one of them alone.
std::string stage_seed_text(std::uint64_t seed);
// Legal, of any mode, and with a package for the pixel stages.
Config random_stage_config(std::uint64_t seed);
// depth16 with mip chains: both kinds of level, each mode of lod that the RTL has, both filters.
std::vector<Config> level_configs();
// Runs the clocks in which a stage clears its scoreboard after reset.
void await_sweep(StageBench& bench, const Config& config);

// Bugs of the scoreboard that both depth and merge show.
inline constexpr PlantedBug scoreboard_bugs[] = {
    {"rtl/scoreboard.sv", "free_q <= !(entered ^ left_a ^ left_b);", "free_q <= entered | !entered;"},
    {"rtl/scoreboard.sv", "enter && place_q == looked_place_q;", "enter && place_q < looked_place_q;"},
    {"rtl/scoreboard.sv", "enter && place_q == known_place_q;", "enter && place_q < known_place_q;"},
    {"rtl/scoreboard.sv", "leave_a_i && place_a == known_place_q;", "leave_a_i && place_a < known_place_q;"},
    {"rtl/scoreboard.sv", "assign enters_entry = enter && place_q == place;",
     "assign enters_entry = enter && place_q < place;"},
    {"rtl/scoreboard.sv", "leave_a_i && place_a == looked_place_q;",
     "leave_a_i && place_a < looked_place_q;"},
    {"rtl/scoreboard.sv", "assign leaves_a_entry = leave_a_i && place_a == place;",
     "assign leaves_a_entry = leave_a_i && place_a < place;"},
    {"rtl/scoreboard.sv", "left_a_since_q <= left_a_since_q ^ leaves_a_looked;",
     "left_a_since_q <= left_a_since_q;"},
};

}  // namespace bitspan
