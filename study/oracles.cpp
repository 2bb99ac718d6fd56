// SPDX-License-Identifier: Apache-2.0
#include "study/oracles.hpp"

#include "study/bounds/bounds.hpp"

namespace bitspan {

std::optional<Visibility> visibility_of(const Config& config, const Scene& scene, std::string& why) {
  why = visibility_refusal(config, scene);
  if (!why.empty()) return std::nullopt;
  try {
    return Visibility(config, scene, stored_depth_bounds(config, scene));
  } catch (const InputError& error) {  // no bound is known
    why = error.what();
    return std::nullopt;
  }
}

std::string own_refusal(const Oracle& oracle, const Config& config, const Scene& scene) {
  return oracle.refuses == nullptr ? "" : oracle.refuses(config, scene);
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
