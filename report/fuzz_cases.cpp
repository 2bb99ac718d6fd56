// SPDX-License-Identifier: Apache-2.0
#include "report/fuzz_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/modes.hpp"
#include "engine/range.hpp"
#include "report/random_config.hpp"
#include "scene/random.hpp"

namespace bitspan {
namespace {

constexpr std::uint64_t groups_per_design = 4;  // with FuzzDesigns::some
constexpr std::uint64_t configs_per_build = 16;
std::uint64_t groups_per_build(const FuzzPlan& plan) {
  return plan.designs == FuzzDesigns::some ? groups_per_design * configs_per_build : configs_per_build;
}

// Throws InputError where a configuration refuses too many draws of a case.
void check_takes(const FuzzPlan& plan, std::uint64_t index, const Config& config) {
  for (int draw = 0;; ++draw) {
    try {
      check_scene_range(config, fuzz_scene(plan, index, draw, config));
      return;
    } catch (const InputError&) {
      if (draw == fuzz_draws / 2) throw;
    }
  }
}

}  // namespace

std::uint64_t fuzz_seed(std::uint64_t seed, std::uint64_t index, std::uint64_t purpose) {
  return Random(Random(Random(seed).bits() ^ index).bits() + purpose).bits();
}

bool fuzz_takes_designs(const FuzzPlan& plan, std::uint64_t group) {
  switch (plan.designs) {
    case FuzzDesigns::none:
      return false;
    case FuzzDesigns::some:
      return group % groups_per_design == 0;
    case FuzzDesigns::all:
      return true;
  }
  unreachable();
}

std::uint64_t fuzz_build(const FuzzPlan& plan, std::uint64_t group) { return group / groups_per_build(plan); }

Config fuzz_config(const FuzzPlan& plan, std::uint64_t group, std::span<const Config> bases,
                   const std::function<void(const Config&)>& check) {
  const bool with_designs = fuzz_takes_designs(plan, group);
  const std::uint64_t first = with_designs ? group - group % groups_per_build(plan) : group;
  RandomConfigOptions options;
  options.even = true;
  options.check = [&](const Config& config) {
    if (check) check(config);
    check_takes(plan, first * plan.streams_per_config, config);
  };
  if (!with_designs) return random_config(fuzz_seed(plan.seed, group, 1), bases, options);
  const std::uint64_t build = fuzz_build(plan, group);
  options.rtl_only = true;
  options.pixel_rtl_turn = build;
  const Config built = random_config(fuzz_seed(plan.seed, build, 4), bases, options);
  options.check = check;
  return vary_beside_rtl(fuzz_seed(plan.seed, group, 1), built, options);
}

Scene fuzz_scene(const FuzzPlan& plan, std::uint64_t index, int draw, const Config& config) {
  Random random(fuzz_seed(plan.seed, index, 2));
  RandomOptions options;
  // On a few pixels, triangles meet at each while those in front are still on their way.
  const bool few_pixels = random.chance(0.25);
  options.width = static_cast<int>(random.log_uniform(1, few_pixels ? 12 : 400));
  options.height = static_cast<int>(random.log_uniform(1, few_pixels ? 12 : 300));
  options.triangles = static_cast<int>(random.integer(8, few_pixels ? 256 : 96));
  options.size_max = random.log_uniform(4, few_pixels ? 16 : 2000);
  options.stacked_probability = random.chance(0.5) ? 0.25 : 0;
  options.depth_ratio_max = std::max(1.5, 1000 / std::pow(3.0, draw));
  options.uv_limit = std::max(4.0, 1024 / std::pow(2.0, draw));
  options.texture_size_max = static_cast<int>(random.log_uniform(1, 64));
  options.textures = 4;
  options.power_of_two_probability = 0.4;
  options.mip_chains = has_lod(config);
  const bool with_designs = fuzz_takes_designs(plan, index / plan.streams_per_config);
  if (random.chance(with_designs ? 0.8 : 0.5)) options.command_probability = random.log_uniform(0.0625, 1);
  if (with_designs) {
    // The pixel stages in RTL have neither.
    options.targets = random.chance(0.25);
    options.second_texture = random.chance(0.25);
    options.every_wrap = index % 4 == 0;
    options.level_registers = index % 4 == 1;
  }
  options.weighed_texels = takes_filter(config, TextureFilter::bilinear);
  Scene scene = random_scene(fuzz_seed(plan.seed, index, 3 + static_cast<std::uint64_t>(draw)), options);
  Random formats(fuzz_seed(plan.seed, index, 100));
  draw_texel_formats(formats, scene, 0.5);
  Random pass(fuzz_seed(plan.seed, index, 102));
  if (pass.chance(0.125)) draw_pass(pass, scene);
  // Before triangles give anything, so that what they give stays as it was.
  Random projection(fuzz_seed(plan.seed, index, 103));
  if (has_project(config.project) && !with_designs) draw_projection(projection, scene);
  Random light(fuzz_seed(plan.seed, index, 104));
  if (has_light(config.light)) draw_light(light, scene, light_taken(config));
  Random translucency(fuzz_seed(plan.seed, index, 105));
  if (!with_designs && translucency.chance(0.125)) draw_translucency(translucency, scene);
  Random given(fuzz_seed(plan.seed, index, 101));
  draw_given_attributes(given, scene, 0.3);
  Random lines(fuzz_seed(plan.seed, index, 106));
  if (has_lines(config.line_walk)) draw_lines(lines, scene, lines.uniform(0, 0.6));
  scene.name = fmt::format("fuzz seed {} case {}", plan.seed, index);
  return scene;
}

}  // namespace bitspan
