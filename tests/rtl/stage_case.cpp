// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/stage_case.hpp"

#include <cstdlib>

#include "config/pixel_timing.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "report/random_config.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {

std::vector<std::uint64_t> stage_seeds(int count) {
  const char* wanted = std::getenv("BITSPAN_RTL_CONFIGS");
  const char* first = std::getenv("BITSPAN_RTL_SEED");
  const std::uint64_t from = first == nullptr ? 1 : std::strtoull(first, nullptr, 10);
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(wanted == nullptr ? count : std::atoi(wanted)));
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = from + i;
  return seeds;
}

std::string stage_seed_text(std::uint64_t seed) {
  return "BITSPAN_RTL_CONFIGS=1 BITSPAN_RTL_SEED=" + std::to_string(seed);
}

Config random_stage_config(std::uint64_t seed) {
  return random_config(seed, shipped_configs(), {.for_scenes = false, .check = [](const Config& c) {
                                                   static_cast<void>(emit_pixel_sv(c));
                                                 }});
}

std::vector<Config> level_configs() {
  std::vector<Config> configs(4, shipped_config("depth16"));
  for (Config& c : configs) {
    c.lod_bias = 3;
    c.lod_first = 300;
    c.filter = TextureFilter::bilinear;
    c.mip = MipMode::linear;
  }
  configs[0].mip = MipMode::nearest;
  configs[0].lod = LodMode::gradient;
  configs[0].filter = TextureFilter::nearest;
  configs[1].lod = LodMode::zone_s;
  configs[2].lod = LodMode::gradient;
  configs[3].lod = LodMode::none;
  configs[3].lod_bias = 21;
  return configs;
}

void await_sweep(StageBench& bench, const Config& config) {
  for (int i = 0; i < 1 << pixel_timing(config).place_bits; ++i) bench.clock();
}

}  // namespace bitspan
