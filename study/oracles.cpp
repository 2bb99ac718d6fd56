// SPDX-License-Identifier: Apache-2.0
#include "study/oracles.hpp"

#include <cmath>

#include "study/bounds/bounds.hpp"

namespace bitspan {

namespace {

// As stored_depth_bounds, of scenes whose vertices give their depth, too. That depth goes through all
// registers of h, and so the bounds of h hold. Only at a vertex it is rounded on the other side, before it is
// taken from the greatest code: there it may be off from h by an ulp the other way.
std::vector<double> depth_bounds(const Config& config, const Scene& scene) {
  const std::optional<Scene> own = by_distance(config, scene);
  std::vector<double> out = stored_depth_bounds(config, own ? *own : scene);
  if (!own) return out;
  const double other_side = 2 * std::ldexp(1.0, -config.format(FormatId::setup_h).fraction());
  for (double& bound : out) bound += other_side + distance_rounding(config, scene);
  return out;
}

}  // namespace

std::optional<Visibility> visibility_of(const Config& config, const Scene& scene, std::string& why) {
  why = visibility_refusal(config, scene);
  if (!why.empty()) return std::nullopt;
  try {
    return Visibility(config, scene, depth_bounds(config, scene));
  } catch (const InputError& error) {  // no bound is known
    why = error.what();
    return std::nullopt;
  }
}

std::string own_refusal(const Oracle& oracle, const Config& config, const Scene& scene) {
  if (oracle.refuses == nullptr) return "";
  const std::optional<Scene> own = by_distance(config, scene);
  return oracle.refuses(config, own ? *own : scene);
}

std::vector<PixelFinding> shadows_of(const Config& config, const ShadowPlan& plan,
                                     std::span<const Visible> picture, const VisibilityReport& seen,
                                     const EngineOptions& options) {
  const auto engine = make_engine(seen.engine, config, options);
  engine->begin(plan.mask);
  draw_scene(*engine, plan.mask, 0, plan.mask.triangles.size(), nullptr);
  return shadow_findings(config, plan, stored_depth_bounds(config, map_scene(plan)), picture, seen,
                         engine->frame());
}

VisibilityReport judged_shadows(const Config& config, const ShadowPlan& plan, const Frame& frame,
                                std::string_view engine) {
  const Oracle& ray = *parse_oracles("ray").front();
  std::string why;
  const std::optional<Visibility> visibility = visibility_of(config, plan.picture, why);
  if (!visibility) throw InputError(why);
  const std::vector<Visible> picture = visibility->picture(ray);
  const VisibilityReport seen = visibility->compare(ray, picture, frame_of_picture(plan, frame), engine);
  return shadow_report(seen, shadows_of(config, plan, picture, seen, {}));
}

}  // namespace bitspan
