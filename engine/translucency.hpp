// SPDX-License-Identifier: Apache-2.0
// Translucent faces in any order: a plan of passes from back to front. [T6]
#pragma once

#include "engine/engine.hpp"

namespace bitspan {

// The translucent passes that a plan may take; each resolves one layer of every pixel.
inline constexpr int translucency_pass_limit = 255;

// Returns the scene as a plan that draws its opaque fragments first, and then the translucent ones from back
// to front, a layer of each pixel at a time: at most two passes more than a pixel has layers, as the
// engine finds them while it draws the plan. It makes passes of the triangles behind the last command. What
// was drawn on other targets in front of it, as a shadow map, stays, and the draw state holds in all passes.
// The engine is begun anew. Throws InputError where the target of these triangles was drawn on or cleared
// before, and where the passes do not suffice.
Scene in_translucency_passes(Scene scene, Engine& engine);

}  // namespace bitspan
