// SPDX-License-Identifier: Apache-2.0
// Random configurations, drawn key by key from the table of config/keys.hpp: a new key is drawn by its row.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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
  // Keys that may be left out are drawn as often as the others, and every register takes every overflow: some
  // 200 draws have each name of each key.
  bool even = false;
  // With rtl_only: the RTL has the pixel stages, too. By turns, 0, 1, 2 and so on, they have each
  // perspective, texture.mip and rtl.blend, and registers of span with each rounding and overflow, so that a
  // few configurations, and as many builds, have all of these.
  std::optional<std::uint64_t> pixel_rtl_turn{};
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

// Draws keys again that the RTL of a configuration does not hang on: both configurations are built from the
// same packages. `config` has pixel stages in RTL, and `options` accept it.
Config vary_beside_rtl(std::uint64_t seed, const Config& config, const RandomConfigOptions& options);

}  // namespace bitspan
