// SPDX-License-Identifier: Apache-2.0
// Draws a point beside `ideal`: the pictures of its report.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "scene/scene.hpp"
#include "study/budget.hpp"

namespace bitspan {

struct PointPicture {
  std::string scene;
  // "ideal", "model", "difference", "u_error", "depth_error" or "dominant". The difference is that of the
  // colours, from black, with its largest brightened to 255. u_error is in texels of both axes, and
  // depth_error in codes. "dominant" shows whose quantisation errs most.
  std::string name;
  std::vector<std::uint8_t> png;
};

// What a colour of "dominant" means. cause_legend returns the most frequent cause first.
struct CauseColor {
  std::int16_t cause = 0;
  std::string name;
  std::array<std::uint8_t, 3> rgb{};
  std::size_t pixels = 0;
};
std::vector<CauseColor> cause_legend(const Budget& budget, const DominantMap& map);

// Returns all pictures of one scene; `ideal` is the scene's. `dominant` is the scene's map, and its indices
// count in `budget`. Where `dominant` is null, its picture is left out.
std::vector<PointPicture> pictures_of(const Config& config, const Scene& scene, const Frame& ideal,
                                      const Budget* budget, const DominantMap* dominant);

}  // namespace bitspan
