// SPDX-License-Identifier: Apache-2.0
// Two pictures for two eyes [ST1, ST2, ST3]. docs/stereo.md.
//
// A point at the distance s is p pixels to the right of its place for the left eye, and as far to the left
// for the right one: p = parallax h / hmax, where h is the depth code D1 of s. So what is as far as s_max
// lies in the screen, and what is nearer stands in front of it; or, where the zero is near, p is less by the
// parallax.
#pragma once

#include <cstdint>
#include <vector>

#include "config/config.hpp"
#include "config/names.hpp"
#include "engine/frame.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// What lies in the screen: s_max, or s_min.
BITSPAN_ENUM(StereoZero, far, near);
// How the two pictures become one: side by side, or the left one's red and the right one's green and blue.
BITSPAN_ENUM(StereoLayout, pair, anaglyph);
// Where they come from: the scene is drawn from two places, or one picture's pixels move by their depth.
BITSPAN_ENUM(StereoBy, cameras, depth);
enum class Eye : std::uint8_t { left, right };

struct StereoOptions {
  double parallax = 0;  // half of the largest one, in pixels
  StereoZero zero = StereoZero::far;
};

struct EyePicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

// ST1: one eye's picture from a frame, each pixel moved by its parallax. Where several come to one place, the
// nearest is seen. Where none does there is a hole, which is then filled from the farther one of its two
// ends.
struct Warped {
  EyePicture picture;
  std::uint64_t holes = 0;
};
Warped warped(const Config& config, const Scene& scene, const Frame& frame, const StereoOptions& options,
              Eye eye);

// ST2: the scene as one of two cameras sees it, whose distance is 2 parallax s_max s_min / (F (s_max -
// s_min)). Their planes are shifted, so that each vertex moves by its parallax. Throws InputError for a scene
// in passes, or where a vertex leaves the coordinates of a stream.
Scene seen_by(Scene scene, const StereoOptions& options, Eye eye);

// ST3: both have one size.
EyePicture joined(const EyePicture& left, const EyePicture& right, StereoLayout layout);

}  // namespace bitspan
