// SPDX-License-Identifier: Apache-2.0
// Shadow volumes: each caster and the shadow behind it are a closed body, and the stencil plane counts how
// many of them a pixel's surface lies in. A pass plan without a map [SH2 names them]; docs/shadow.md.
#pragma once

#include <span>
#include <vector>

#include "scene/geometry.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// The bodies of the faces' shadows, as far as the eye at 0 may see them: from s_min on, and what lies beyond
// s_max flattened onto s_max. Each face that the light does not see edge on is a body's end towards the
// light; the other end lies infinitely far. Sides that two bodies share are left out. Corners run
// counter-clockwise seen from outside, whichever way the face's do. Faces and light are in the viewer's
// space.
std::vector<Face> shadow_volumes(std::span<const Face> faces, const Vec3& light, const View& view);

// The scene with the shadows that its casters throw onto all that it shows: a pass that draws it and marks
// its surfaces; one that draws the bodies without colour and depth, and counts those whose back, but not
// their front, lies behind the surface; and one that darkens such pixels once, to the share `dark`. More than
// 127 bodies around a point are counted modulo 128. All is in the viewer's space. Throws InputError for a
// scene with commands.
Scene with_shadow_volumes(Scene scene, std::span<const Face> casters, const Vec3& light, double dark);

}  // namespace bitspan
