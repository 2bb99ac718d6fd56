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

// Triangles of one size, anywhere in the picture: every fragment of them lies inside it.
struct Cloud {
  std::string_view name;
  std::int64_t triangles = 0;
  double pixels = 0;  // area of each
};

// big, medium, small: 8 M fragments each over 1024x768.
std::span<const Cloud> clouds();

// A picture with a 256x256 texture and exponential fog, and no triangle yet. The viewer is so far behind the
// picture that distance to the eye and distance along the axis agree: the fog of bitspan goes by the first,
// that of OpenGL by the second.
Scene empty_scene(std::string_view name, int width, int height);

// Triangles of `pixels` area in empty_scene's picture, one after another. Depths are random planes, so that
// triangles cut through one another; s varies by up to two within a triangle; about a texel a pixel.
class CloudStream {
 public:
  CloudStream(std::uint64_t seed, const Scene& scene, double pixels);
  Triangle next();

 private:
  Random random_;
  double width_, height_, s_min_, s_max_, pixels_;
};

// `big`, `medium` or `small`: a third of the fragments pass the depth test. `big-back` and so on: the same
// triangles from the farthest to the nearest, nearly every fragment passes. `demo`, the embedded scene. Or
// else a mesh file, in `texture` where one is named. Throws InputError.
Scene frame_scene(const std::string& name, const std::string& texture = {});

}  // namespace bitspan::bench
