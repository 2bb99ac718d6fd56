// SPDX-License-Identifier: Apache-2.0
// Random numbers and random scenes; a seed gives the same ones on every machine.
#pragma once

#include <cstdint>
#include <string_view>

#include "scene/scene.hpp"

namespace bitspan {

// xoshiro256** seeded by splitmix64. All derived numbers come from integer arithmetic or exact scaling, so a
// seed gives the same bits on every platform.
class Random {
 public:
  explicit Random(std::uint64_t seed);
  std::uint64_t bits();
  // Uniform over low..high, both included.
  std::int64_t integer(std::int64_t low, std::int64_t high);
  // Uniform over [0, 1), a multiple of 2^-53.
  double unit();
  double uniform(double low, double high);
  // In low..high, 0 < low <= high; every octave is about equally likely.
  double log_uniform(double low, double high);
  bool chance(double probability);

 private:
  std::uint64_t state_[4];
};

struct RandomOptions {
  int width = 256, height = 192;  // pixels
  int triangles = 64;
  double size_min = 1;  // extent of a triangle, pixels
  double size_max = 256;
  double depth_ratio_max = 1000;        // s_max / s_min; each scene draws its own up to this
  double uv_limit = 1024;               // |u|, |v| of a vertex, texels
  int textures = 3;                     // at most
  int texture_size_max = 64;            // texels
  bool mip_chains = false;              // textures have sides that are powers of two
  double power_of_two_probability = 0;  // of another texture to have such sides
  double fog_probability = 0.5;
  double translucent_probability = 0.3;  // of a triangle to have alpha below 1
  double stacked_probability = 0;        // of a triangle to cover the pixels of the one in front of it
  double command_probability = 0;        // of a triangle to have a change of draw state or a clear in front
  bool late_tests = true;                // depth.when may be `late`, and stencil.test on
  bool targets = true;                   // registers of the target and of the chroma range may change
  bool second_texture = true;            // registers of the second texture unit may change
  bool later_registers = true;  // those that scenes of before do not have may change, and clears be masked
  bool weighed_texels = true;   // filters of the draw state may weigh texels
  bool every_wrap = true;       // its wrap modes may be any; else those of the RTL
  bool level_registers = true;  // those that choose a level may change
  bool several_targets = true;  // with commands: triangles may go to other targets than 0
};

// Returns a scene that a stream can hold: no triangle has zero area, and s is within its range. The same seed
// and options give the same scene.
Scene random_scene(std::uint64_t seed, const RandomOptions& options = {});

// Whether a register came later than the scenes of seeds, and the digests, that are kept. A generator of its
// own draws it, so that a seed of before gives the scene of before, and it besides.
bool is_later_register(std::string_view key);

// Gives the textures of a scene texel formats, each of its own with that probability: the image converted,
// any bits with a random table, or a procedural texture.
void draw_texel_formats(Random& random, Scene& scene, double probability);

// Sends some triangles in a row of a scene to a target of their own, of a texture's size and with a view of
// its own, and makes a plane of it that texture's texels. Nothing where a scene has no texture, or too few
// triangles.
void draw_pass(Random& random, Scene& scene);

// Throws a texture of the scene on it from somewhere, as a slide or a shadow map, with registers that change.
// Nothing where it has no texture.
void draw_projection(Random& random, Scene& scene);

// Lets a scene hold translucent fragments as candidates, and resolve them, now and then.
void draw_translucency(Random& random, Scene& scene);

// Makes triangles of a scene lines between two of their vertices, each with that probability.
void draw_lines(Random& random, Scene& scene, double probability);

// Which lights a configuration takes besides those that are far away, do not fall and scatter by Lambert.
struct LightTaken {
  bool point = false, lunar = false, fall = false, map = false, shadow = false;
};
LightTaken light_taken(const Config& config);
// Gives a scene such a light, and most of its triangles normals.
void draw_light(Random& random, Scene& scene, const LightTaken& takes);

// Lets triangles of a scene give each of given_attributes but those of projector and light with that
// probability.
void draw_given_attributes(Random& random, Scene& scene, double probability);

}  // namespace bitspan
