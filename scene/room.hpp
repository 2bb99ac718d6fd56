// SPDX-License-Identifier: Apache-2.0
// A room with what a configuration can do: a lamp, shadows, a relief wall and a pane of glass.
#pragma once

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Which of them a configuration draws.
struct RoomOptions {
  bool lamp =
      false;  // by the unit light, per pixel or at vertices; else the corners are lit in double precision
  bool shadow = false;             // of the lamp, by a map of depth codes
  bool lamp_takes_shadow = false;  // all but its ambient share
  bool relief = false;             // the wall's normals are those of a map
  int depth_bits = 16;             // of the map of depth codes
  DepthCode depth_code = DepthCode::inverse;
};
RoomOptions room_options(const Config& config);

// Returns a room: a floor of boards, a wall of bricks, a ball, a box and a ring on the floor, and in front of
// them a pane of glass, drawn last. The lamp hangs at the viewer's right. The scene is the same in every
// call. Sizes as for the demo. Throws InputError for other ones.
Scene room_scene(const RoomOptions& options, int width, int height);

}  // namespace bitspan
