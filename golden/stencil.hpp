// SPDX-License-Identifier: Apache-2.0
// Stage `stencil`: tests a fragment against the stencil plane, and says what the plane becomes.
#pragma once

#include <cstdint>

#include "engine/records.hpp"
#include "scene/draw_state.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Whether the triangle's vertices, snapped, run clockwise in the picture.
bool runs_clockwise(const Config& config, const Triangle& triangle);

// Takes the fragment's depth record and the plane's value at its pixel.
StencilRecord stencil(const DrawState& state, bool back, const DepthRecord& depth, std::uint8_t stored);

}  // namespace bitspan::golden
