// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_pixel_pkg: what the pixel stages in RTL take from a configuration.
#pragma once

#include <bit>
#include <span>
#include <string>

#include "config/config.hpp"
#include "scene/draw_state.hpp"
#include "scene/texture.hpp"

namespace bitspan {

// Bits of an index along a texture's row or column, and of a texel's address, which counts texels.
inline constexpr int texel_index_bits = std::bit_width(static_cast<unsigned>(texture_size_limit - 1));
inline constexpr int texel_address_bits = 32;

// Whether the pixel stages of a configuration exist in RTL, in its modes. Where one takes R_pixel, that must
// be pipelined, and its operand must fit the unit.
bool has_pixel_rtl(const Config& config);

// Whether the pixel stages in RTL draw in a draw state, where they are built for the state's order of tests.
// They have colours that are mixed by the fragment's alpha, or replaced; with rtl.blend = equation any blend
// and logic operation.
bool pixel_rtl_takes(const Config& config, const DrawState& state);
// The same for every state that a scene's commands make.
bool pixel_rtl_takes(const Config& config, std::span<const DrawCommand> commands);
// Whether a draw state mixes colours as the first state does.
bool mixes_by_alpha(const DrawState& state);

// The package's text: formats, the depth code, reciprocal unit and the latencies of config/pixel_timing. What
// may change between triangles or scenes is not in it: comparison, filter, wrap, blend and so on are ports.
// `when`: the order of tests that the chain is built for; it draws in no state of the other order. The
// stencil test is in the late one alone. The same configuration and order give the same text, byte for byte.
// Throws InputError where there is no such RTL.
std::string emit_pixel_sv(const Config& config, DepthWhen when = DepthWhen::early);

}  // namespace bitspan
