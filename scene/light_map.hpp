// SPDX-License-Identifier: Apache-2.0
// Light as a texture [L7]: what a light at a point leaves on any flat face is one picture, moved and scaled.
// docs/light.md.
#pragma once

#include <span>
#include <string>

#include "scene/light.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct LightMapOptions {
  Vec3 place{};      // of the light, in the coordinates of the mesh
  double reach = 1;  // the distance at which a face that is turned to it is as bright as its colour
  int side = 256;    // of the texture
};

// Throws InputError, whose text begins with `name`, where an option is not legal.
void check_light_map(const LightMapOptions& options, const std::string& name = "light map");

// A face that is lit 2^this times as much is as bright as one that is lit more.
inline constexpr int light_map_octaves = 2;

// eta(x, y) = G^3 / (x^2 + y^2 + G^2)^(3/2) of 255, x and y from the middle. G is so many texels that eta is
// one code at the nearest points of the border.
Texture light_texture(int side);

// How the second texture unit takes it.
StateChange light_map_state();

// Gives corners their texels in that texture: the foot of the light on the face's plane is in its middle, and
// its height is G. Colours are multiplied by (reach / height)^2 2^-light_map_octaves; those of faces that
// the light does not see, or too much aslant for half a code, are black. Throws as check_light_map.
void map_light(std::span<Face> faces, const LightMapOptions& options);

}  // namespace bitspan
