// SPDX-License-Identifier: Apache-2.0
// The scenes that the frame benchmark draws, the same on every machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/random.hpp"
#include "scene/scene.hpp"

namespace bitspan::bench {

// Triangles of one size, anywhere in the picture. Every fragment of them lies inside the picture.
struct Cloud {
  std::string_view name;
  std::int64_t triangles = 0;
  double pixels = 0;  // area of each
};

// Returns big, medium and small: 8 M fragments each over 1024x768.
std::span<const Cloud> clouds();

// Returns a picture with a 256x256 texture and exponential fog, and no triangle yet. The viewer is so far
// behind the picture that distance to the eye and distance along the axis agree: bitspan's fog goes by the
// first, OpenGL's by the second.
Scene empty_scene(std::string_view name, int width, int height);

// Gives triangles of `pixels` area in empty_scene's picture, one after another. Depths are random planes, so
// that triangles cut through one another. s varies by up to two within a triangle; there is about one texel
// per pixel.
class CloudStream {
 public:
  CloudStream(std::uint64_t seed, const Scene& scene, double pixels);
  Triangle next();

 private:
  Random random_;
  double width_, height_, s_min_, s_max_, pixels_;
};

// What is left of a colour in a shadow.
inline constexpr double shadow_dark = 0.35;

// Returns a scene by name. `big`, `medium` and `small` have random depths, so that most fragments fail the
// depth test. `big-back` and so on have the same triangles from the farthest to the nearest, and nearly every
// fragment passes. `big-mip` and so on have four texels per pixel on each axis, so that levels of the texture
// count. `big-blend` and so on are translucent; they come from the farthest to the nearest. `big-shadow` and
// so on are drawn in the light of a lamp, through a shadow map of 1024x1024 texels, and those of `big-phong`
// are lit by it per pixel besides, as its faces stand. `demo` is the embedded scene. Any other name is a mesh
// file, in `texture` where one is named. Throws InputError.
Scene frame_scene(const std::string& name, const std::string& texture = {});

}  // namespace bitspan::bench
