// SPDX-License-Identifier: Apache-2.0
// The edges of a scene's triangles as lines (B1), with or without those that the triangles hide.
#pragma once

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// Every edge; or those that no triangle hides.
BITSPAN_ENUM(Wireframe, all, hidden);
constexpr bool hides_lines(Wireframe kind) {
  switch (kind) {
    case Wireframe::all:
      return false;
    case Wireframe::hidden:
      return true;
  }
  unreachable();
}

struct WireframeOptions {
  Wireframe kind = Wireframe::all;
  int bias = 0;  // hidden: of the lines' depth codes
};
// Codes that lines are nearer by where nothing else is said: 1/256 of all codes.
int wireframe_bias(int depth_bits);

// Returns the scene with a line per edge, from the end that was seen first, in the colours of its ends. Edges
// whose ends are the same, bit for bit, are one. With `hidden` the triangles are drawn in front of the lines,
// into the depth buffer alone. Throws InputError where the scene has commands other than changes of state in
// front of its first triangle.
Scene wireframe(Scene scene, const WireframeOptions& options);

}  // namespace bitspan
