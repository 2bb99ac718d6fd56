// SPDX-License-Identifier: Apache-2.0
// A mesh on a turntable, turned by the unit rotate. [B10]
#pragma once

#include <string>

#include "config/rotate.hpp"
#include "scene/mesh.hpp"

namespace bitspan {

// Picture `number` of `count`: the mesh is turned by number / count of a full turn.
struct Turn {
  int number = 0, count = 1;
};
// A turn has 8 steps per picture.
inline constexpr int turn_pictures_limit = turn_limit / 8;

// Turns positions and normals about the vertical line through the camera's target, which the middle of the
// mesh becomes where there is none. Seen from above, the mesh turns counter-clockwise. Coordinates take the
// registers `formats`, scaled by a power of two so that they fit. Throws InputError as check_rotate.
void turn_mesh(Mesh& mesh, Camera& camera, const Turn& turn, const RotateFormats& formats);

// "pot.png" as "pot-07.png", with as many digits as the last number has.
std::string numbered_output(const std::string& path, const Turn& turn);

}  // namespace bitspan
