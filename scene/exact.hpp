// SPDX-License-Identifier: Apache-2.0
// Exact predicates on screen positions.
#pragma once

#include "scene/scene.hpp"

namespace bitspan {

// Returns the sign of (b - a) x (c - a), exactly, for any finite doubles: +1 where a, b, c run clockwise on
// the screen (y downward), -1 where they run counter-clockwise, 0 where they lie on one line.
int orientation(double ax, double ay, double bx, double by, double cx, double cy);

inline int orientation(const Triangle& t) {
  return orientation(t.v[0].x, t.v[0].y, t.v[1].x, t.v[1].y, t.v[2].x, t.v[2].y);
}

}  // namespace bitspan
