// SPDX-License-Identifier: Apache-2.0
// Scenes that need no file.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.hpp"
#include "scene/shadow.hpp"

namespace bitspan {

// Returns the demo: a checkered floor running to the horizon (s from 1 to 1000, |u| and |v| below 4096), a
// box and a pyramid crossing one another, a sphere and a Gouraud coloured torus crossing one another, a
// grille with the transparent code (255, 0, 255), columns fading into the fog, and a pane of stained glass,
// drawn last. The scene is the same in every call. width and height: 1 to 16384, and the width at most 2.4
// times the height. shadow: in the coordinates of its world, where y points up and the viewer is at (0, 7,
// 0).
Scene demo_scene(int width, int height, const std::optional<ShadowOptions>& shadow = {});

// Returns the demo with a mirror behind its solids, in two passes: what the mirror shows is drawn on target 1
// and copied to a texture, which the picture on target 0 has. Sizes as for the demo.
Scene mirror_scene(int width, int height);

// Returns a floor of black and white squares, 8 texels each, from below the viewer to the horizon; its
// texture has a mip chain (64 x 64 texels). Sizes as for the demo. A picture of K times the size shows the
// same view, so that K x K of its pixels are samples of one pixel.
Scene floor_scene(int width, int height);

// Returns legal but extreme triangles. Each scene has one theme and is named after it: slivers, one-pixel
// triangles, outside the screen, touching s_min and s_max, 16384 pixels wide, closed fans that share edges,
// both windings, flat tops and bottoms, vertices on pixel centres.
std::vector<Scene> extreme_scenes();

// Returns triangles whose corners lie in squares of `size` pixels, 1 to 1024, strewn over the picture:
// together they have about as many pixels for every size, up to 40000 triangles. Each is a piece of a surface
// of its own, whose s changes by a quarter across it and whose texture has 1/4 to 4 texels per pixel; s from
// 1 to 1000. The scene is the same in every call. Sizes as for the demo.
Scene triangles_scene(int size, int width, int height);

}  // namespace bitspan
