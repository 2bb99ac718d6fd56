// SPDX-License-Identifier: Apache-2.0
// What a point looks like beside `ideal`: the pictures of its report.
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
  // ideal, model, difference (of colours, from black, its largest brightened to 255), u_error (texels, both
  // axes), depth_error (codes), dominant (whose quantisation errs most).
  std::string name;
  std::vector<std::uint8_t> png;
};

// What the colours of `dominant` mean, the most frequent cause first.
struct CauseColor {
  std::int16_t cause = 0;
  std::string name;
  std::array<std::uint8_t, 3> rgb{};
  std::size_t pixels = 0;
};
std::vector<CauseColor> cause_legend(const Budget& budget, const DominantMap& map);

// All of them for one scene. ideal: its picture. dominant: of the scene, with the budget that its indices
// count; null: left out.
std::vector<PointPicture> pictures_of(const Config& config, const Scene& scene, const Frame& ideal,
                                      const Budget* budget, const DominantMap* dominant);

}  // namespace bitspan
