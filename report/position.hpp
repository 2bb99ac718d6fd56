// SPDX-License-Identifier: Apache-2.0
// The depth buffer read back: the distance that a stored code stands for, and the point that the pixel shows.
// [T13, H7] docs/numeric-spec.md, "position".
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "engine/frame.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// One value per pixel, rows from the top; NaN where the code is that of the cleared buffer.
struct Positions {
  std::vector<double> s;       // distance along the view axis, in the scene's unit
  std::vector<double> points;  // three per pixel: x to the right, y downward, s
};
Positions positions_of(const Config& config, const Scene& scene, const Frame& frame);

// The distance of one code, which need not be stored anywhere.
class DistanceOfCode {
 public:
  DistanceOfCode(const Config& config, const Scene& scene);
  double operator()(std::uint32_t code) const;

 private:
  DepthCode depth_code_;
  double largest_ = 0;      // the largest code
  double a_ = 0, b_ = 0;    // A and B of D1
  double c1_ = 1, c0_ = 0;  // of the linear code
  double w_step_ = 1;       // of w_float: codes per octave
  int w_top_ = 0;           // and K
  int bits_ = 0;            // depth.bits
};

}  // namespace bitspan
