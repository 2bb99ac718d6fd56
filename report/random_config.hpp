// SPDX-License-Identifier: Apache-2.0
// Random configurations, drawn key by key from the table of config/keys.hpp: a new key is drawn by its row.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "config/config.hpp"

namespace bitspan {

struct RandomConfigOptions {
  bool rtl_only = false;  // only what the RTL can be built for
  // No fewer: 13 hold what random_scene draws about a picture of 400 pixels. A scene that does not fit is
  // refused by check_scene_range.
  int least_coordinate_bits = 13;
  // Formats that scenes fit in, mostly. Without it their signs change too: for benches that feed raw values.
  bool for_scenes = true;
  // Further rules, of engines that hold less; throws InputError for what is to be drawn again. May be empty.
  std::function<void(const Config&)> check;
};

// One draw, made from one of `bases` (at least one) by changing every key: mostly little, so that scenes can
// be drawn with it, and rarely to anything. Rules between keys may refuse it (check_config). Formats may
// overflow on the scenes drawn with it, and say so (overflow_expected).
Config draw_config(std::uint64_t seed, std::span<const Config> bases,
                   const RandomConfigOptions& options = {});

// Draws until check_config accepts. The same seed, bases and options give the same configuration. Its name is
// "random-SEED". bases: each legal.
Config random_config(std::uint64_t seed, std::span<const Config> bases,
                     const RandomConfigOptions& options = {});

}  // namespace bitspan
