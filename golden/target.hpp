// SPDX-License-Identifier: Apache-2.0
// What a target holds of a colour; docs/numeric-spec.md, "merge", targets.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/frame.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::golden {

// The code 0..255 that the target's channel (0 red .. 3 alpha) holds at pixel (x, y) in place of `code`.
std::int64_t held(const DrawState& state, std::size_t channel, std::int64_t code, std::int64_t x,
                  std::int64_t y);
// The clear with the codes that the target holds.
Clear held(const DrawState& state, Clear clear);

// A masked clear of a frame, with the codes that the target holds. farthest: the depth buffer's clear code.
void clear_masked(Frame& frame, const DrawState& state, const Clear& clear, std::uint32_t farthest);

}  // namespace bitspan::golden
