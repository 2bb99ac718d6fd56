// SPDX-License-Identifier: Apache-2.0
// stencil: a fragment against the plane's value, and what becomes of that. docs/numeric-spec.md, "stencil".
#pragma once

#include <array>
#include <cstdint>

#include "engine/records.hpp"
#include "model/stages/setup.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::model {

// What one side of a triangle takes.
struct StencilSide {
  CompareFunc func = CompareFunc::always;
  StencilOp fail = StencilOp::keep, zfail = StencilOp::keep, pass = StencilOp::keep;
  std::int64_t ref = 0, mask = 255, write = 255;
};
struct StencilStage {
  bool test = false;
  std::array<StencilSide, 2> side;  // front, back
};
StencilStage prepare_stencil(const DrawState& state);

// Whether the vertices run clockwise in the picture, as setup snaps them.
bool is_back_face(const SetupStage& stage, const Triangle& triangle);

// stored: the plane's value at the fragment's pixel; out.value is the new one. True where the fragment passes
// both tests.
bool stencil(const StencilStage& stage, bool back, const DepthRecord& depth, std::uint8_t stored,
             StencilRecord& out);

}  // namespace bitspan::model
