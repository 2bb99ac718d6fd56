// SPDX-License-Identifier: Apache-2.0
#include "report/shadow_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

#include "config/modes.hpp"
#include "golden/shadow_rays.hpp"
#include "scene/plan.hpp"
#include "scene/shadow.hpp"

namespace bitspan {
namespace {

// Of the red code of the mask.
constexpr int least_lit = 240, most_dark = 15;
// From the point, each way: what a lookup takes, and half a texel more.
constexpr double reach = 1.5;

bool takes_map(const DrawState& state, int map) {
  return is_projected(state) && state.texture1 == map && state.texture1_compare;
}

constexpr PassingDistances nearer_or_equal{.nearer = true, .equal = true};

std::string place_text(std::int64_t at, int width) {
  return fmt::format("pixel ({}, {})", at % width, at / width);
}

}  // namespace

std::optional<ShadowPlan> shadow_plan_of(const Config& config, const Scene& scene) {
  if (!scene.projector || !has_project(config.project)) return std::nullopt;
  if (goes_by_given_depth(config, scene)) return std::nullopt;  // a ray needs the distance
  ShadowPlan plan;
  const std::vector<DrawState> states = states_of(config, scene.commands);
  std::size_t change = 0;
  std::optional<std::size_t> copied;
  std::optional<int> light_target;
  Views views(scene);
  Scene picture = scene;
  picture.commands.clear();
  picture.projector.reset();
  Scene mask = scene;
  DrawState state = first_state(config);
  plan.states.push_back(state);
  std::size_t command = 0;
  for (std::size_t i = 0; i <= scene.triangles.size(); ++i) {
    for (; command < scene.commands.size() && scene.commands[command].before == i; ++command) {
      const DrawCommand& here = scene.commands[command];
      views.execute(here);
      if (const auto* set = std::get_if<StateChange>(&here.what)) {
        state = states[change++];
        StateChange alone = *set;
        alone.settings.push_back(state_setting("texture1", -1));
        alone.settings.push_back(state_setting("color.write", 1));
        picture.commands.push_back({.before = i, .what = std::move(alone)});
        if (copied) plan.states.push_back(state);
      } else if (const auto* copy = std::get_if<Copy>(&here.what)) {
        if (copied || copy->plane != CopyPlane::depth || !light_target || copy->target != *light_target) {
          return std::nullopt;
        }
        copied = i;
        plan.map = copy->texture;
        plan.states.back() = state;
      } else if (std::holds_alternative<Clear>(here.what)) {
        return std::nullopt;
      }
    }
    if (i == scene.triangles.size()) break;
    if (views.target() == 0) {
      // Behind the copy, in the view of the scene's start.
      if (!copied || !(views.now() == static_cast<const View&>(scene))) return std::nullopt;
      const bool is_judged = takes_map(state, plan.map);
      // The picture below has colours written in every state.
      if (!state.color_write || (has_second_texture(state) && !is_judged)) return std::nullopt;
      if (is_judged && passing_distances(state.texture1_func) != nearer_or_equal) return std::nullopt;
      plan.state_of.push_back(plan.states.size() - 1);
    } else {
      if (copied || (light_target && *light_target != views.target())) return std::nullopt;
      if (light_target && !(plan.light == views.now())) return std::nullopt;
      light_target = views.target();
      plan.light = views.now();
      const PassingDistances passing = passing_distances(state.depth_func);
      if (!passing.nearer || passing.farther || !state.depth_write || state.depth_bias != 0 ||
          masks_pixels(state) || state.stencil_test || state.alpha_func != CompareFunc::always ||
          state.translucency_pass != TranslucencyPass::all) {
        return std::nullopt;
      }
      plan.casters.push_back(scene.triangles[i]);
    }
  }
  if (!copied || !light_target || plan.casters.empty()) return std::nullopt;
  if (target_at(scene.commands, scene.triangles.size()) != 0) return std::nullopt;
  plan.first = *copied;
  if (plan.first + plan.state_of.size() != scene.triangles.size()) return std::nullopt;
  erase_triangles(picture, 0, plan.first);
  for (std::size_t i = plan.first; i < mask.triangles.size(); ++i) {
    mask.triangles[i].texture = -1;
    for (Vertex& v : mask.triangles[i].v) v.c = {1, 1, 1, 1};
  }
  mask.fog.reset();
  for (DrawCommand& c : mask.commands) {
    if (auto* view = std::get_if<ViewChange>(&c.what)) view->fog = std::optional<Fog>{};
    auto* const set = std::get_if<StateChange>(&c.what);
    if (set == nullptr) continue;
    for (const std::string_view key : {"texture1.red", "texture1.green", "texture1.blue"}) {
      set->settings.push_back(state_setting(key, 0));
    }
    set->settings.push_back(state_setting("texture1.op", TextureOp::modulate));
  }
  plan.picture = std::move(picture);
  plan.mask = std::move(mask);
  return plan;
}

Frame frame_of_picture(const ShadowPlan& plan, Frame frame) {
  for (std::int32_t& triangle : frame.triangle) {
    if (triangle >= 0) triangle -= static_cast<std::int32_t>(plan.first);
  }
  return frame;
}

Scene map_scene(const ShadowPlan& plan) {
  Scene scene;
  static_cast<View&>(scene) = plan.light;
  scene.textures = plan.picture.textures;
  scene.triangles = plan.casters;
  return scene;
}

std::vector<PixelFinding> shadow_findings(const Config& config, const ShadowPlan& plan,
                                          std::span<const double> bounds, std::span<const Visible> picture,
                                          const VisibilityReport& seen, const Frame& mask) {
  const Projector range{plan.light.s_min, plan.light.s_max};
  const double code = code_step(range, config.depth_bits);
  std::vector<golden::Caster> casters;
  const std::vector<bool> vanishes = vanishing_triangles(config, plan.picture, plan.casters);
  for (std::size_t i = 0; i < plan.casters.size(); ++i) {
    casters.push_back(golden::caster_of(plan.casters[i]));
    casters.back().vanishes = vanishes[i];
    casters.back().excess = std::max(0.0, bounds[i] - codes_lost) * code;
  }
  const golden::ShadowRays rays(casters);
  const auto judge = [&](std::size_t at) -> PixelFinding {
    if (seen.pixels[at] == PixelVerdict::background) return {PixelVerdict::background};
    if (seen.pixels[at] != PixelVerdict::equal) return {PixelVerdict::left_out};
    const Visible& here = picture[at];
    const auto index = static_cast<std::size_t>(here.triangle);
    const DrawState& state = plan.states[plan.state_of[index]];
    if (!takes_map(state, plan.map)) return {PixelVerdict::left_out};
    const auto shape = ideal_triangle(config, plan.picture.triangles[index]);
    std::array<std::array<double, 3>, 3> xyw{};
    std::array<double, 3> weights{};
    double sum = 0;
    double w = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const IdealTriangle::Corner& c = shape->v[i];
      xyw[i] = {c.given.project_x, c.given.project_y, c.given.project_w};
      weights[i] = static_cast<double>(static_cast<long double>(here.q.part[i]) / here.q.s[i]);
      sum += weights[i];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      weights[i] /= sum;
      w += weights[i] * xyw[i][2];
    }
    if (!(w > 0)) return {PixelVerdict::left_out};
    golden::Receiver point = golden::receiver_at(xyw, weights);
    if (!std::isfinite(point.q_0) || !(point.x >= 0 && point.x < plan.light.width) ||
        !(point.y >= 0 && point.y < plan.light.height)) {
      return {PixelVerdict::left_out};
    }
    const double nearer = nearer_is_larger(config.depth_code) ? 1 : -1;
    point.shift = nearer * static_cast<double>(state.texture1_bias) * code;
    const golden::Lit lit = rays.at(point, reach, lost_by_registers(range, config.depth_bits, w));
    if (lit == golden::Lit::unknown) return {PixelVerdict::left_out};
    if (lit == golden::Lit::open) return {PixelVerdict::edge};
    const int share = mask.color[4 * at];
    if (lit == golden::Lit::lit ? share >= least_lit : share <= most_dark) return {PixelVerdict::equal};
    return {PixelVerdict::unexplained,
            fmt::format(
                "{}: the light {} triangle {} at texel ({:.2f}, {:.2f}), W {:.6g}; {} has {} of 255 there",
                place_text(static_cast<std::int64_t>(at), seen.width),
                lit == golden::Lit::lit ? "sees" : "does not see", plan.first + index, point.x, point.y, w,
                seen.engine, share)};
  };
  std::vector<PixelFinding> out;
  for (std::size_t at = 0; at < picture.size(); ++at) out.push_back(judge(at));
  return out;
}

VisibilityReport shadow_report(const VisibilityReport& seen, std::span<const PixelFinding> findings) {
  VisibilityReport out;
  out.oracle = seen.oracle + "_shadows";
  out.engine = seen.engine;
  out.left_out_as = "beside the map, or near what may be killed";
  out.width = seen.width;
  out.height = seen.height;
  for (const PixelFinding& found : findings) out.add(found);
  return out;
}

}  // namespace bitspan
