// SPDX-License-Identifier: Apache-2.0
// An engine that draws a plan while it is made, so that a counter can say which triangles a pass is repeated
// with.
#pragma once

#include "engine/engine.hpp"
#include "scene/plan.hpp"

namespace bitspan {

// The engine has begun with the scene that is flattened, and outlives what is returned. The counter is one of
// engine/counters.hpp. Throws InputError where there is no such counter.
DrawPass draw_pass(Engine& engine);

}  // namespace bitspan
