// SPDX-License-Identifier: Apache-2.0
// The cases of `bitspan fuzz`: configurations and scenes, each made from a seed and its number alone.
// tests/report/fuzz_cases_test.cpp counts what those of a default run reach.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Which configurations the engines take part in that run a design, of which one is built per configuration.
enum class FuzzDesigns : std::uint8_t { none, some, all };

struct FuzzPlan {
  std::uint64_t seed = 1;
  std::uint64_t cases = 384;             // of a default run
  std::uint64_t streams_per_config = 2;  // cases that share a configuration
  FuzzDesigns designs = FuzzDesigns::some;
};

// Draws per case: a scene that is refused, or that covers nothing, is drawn again.
inline constexpr int fuzz_draws = 8;

// A seed for (seed, index, purpose): each case can be made alone.
std::uint64_t fuzz_seed(std::uint64_t seed, std::uint64_t index, std::uint64_t purpose);

// Whether the designs take part in configuration `group`. With `some`, in one of four.
bool fuzz_takes_designs(const FuzzPlan& plan, std::uint64_t group);
// The configurations with designs that share a build: they have a number in common.
std::uint64_t fuzz_build(const FuzzPlan& plan, std::uint64_t group);

// Configuration `group`, for the cases from group * streams_per_config on. Where designs take part, RTL and
// its pixel stages can be built for it. check: as in RandomConfigOptions.
Config fuzz_config(const FuzzPlan& plan, std::uint64_t group, std::span<const Config> bases,
                   const std::function<void(const Config&)>& check);

// A scene of case `index` for its configuration; `draw` grows up to fuzz_draws where the ones before were
// refused or covered no pixel, and makes it gentler.
Scene fuzz_scene(const FuzzPlan& plan, std::uint64_t index, int draw, const Config& config);

}  // namespace bitspan
