// SPDX-License-Identifier: Apache-2.0
// Scenes that are drawn with a shadow map, as oracles see them: the picture's pass alone, and whether each
// pixel is lit. docs/verify.md, "Shadows".
//
// X, Y and W of the vertices say where the light sees them, and how near they are for the comparison: a bias
// is part of them. So the judge needs neither the light's place nor the program that made the stream.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/frame.hpp"
#include "golden/oracle.hpp"
#include "report/visibility.hpp"
#include "scene/draw_state.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct ShadowPlan {
  Scene picture;                      // the last pass: its triangles, its states without the map
  std::size_t first = 0;              // triangle of the scene that is the picture's first
  View light;                         // of the map's pass
  std::vector<Triangle> casters;      // of that pass
  int map = 0;                        // the texture that its depth becomes
  std::vector<DrawState> states;      // of the picture's pass
  std::vector<std::size_t> state_of;  // per triangle of the picture, into `states`
  Scene mask;                         // the whole scene, white where it is lit and black where it is dark
};
// None where the scene is no such plan: one pass on another target with a view of its own, whose depth is
// copied to a texture once, and one on target 0, which compares with it by lequal where it is projected. None
// where vertices give their depth apart from the distance.
std::optional<ShadowPlan> shadow_plan_of(const Config& config, const Scene& scene);

// The winners of a frame of the whole scene, by the picture's own indices.
Frame frame_of_picture(const ShadowPlan& plan, Frame frame);

// The map's pass alone.
Scene map_scene(const ShadowPlan& plan);

// What rays from the light find of an engine's shadows, per pixel. bounds: for each caster, by how many codes
// its stored depth may be off (stored_depth_bounds of map_scene). picture: of an oracle of plan.picture;
// seen: its report on the same engine; mask: the engine's frame of plan.mask. Pixels are judged where the
// report has them equal, their triangle takes the map, and they lie within it.
std::vector<PixelFinding> shadow_findings(const Config& config, const ShadowPlan& plan,
                                          std::span<const double> bounds, std::span<const Visible> picture,
                                          const VisibilityReport& seen, const Frame& mask);
// The same as a report, beside the one of what is seen.
VisibilityReport shadow_report(const VisibilityReport& seen, std::span<const PixelFinding> findings);

}  // namespace bitspan
