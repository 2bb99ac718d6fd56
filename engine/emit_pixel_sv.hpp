// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_pixel_pkg: what the pixel stages in RTL take from a configuration.
#pragma once

#include <bit>
#include <string>

#include "config/config.hpp"
#include "scene/texture.hpp"

namespace bitspan {

// Bits of an index along a texture's row or column, and of a texel's address, which counts texels.
inline constexpr int texel_index_bits = std::bit_width(static_cast<unsigned>(texture_size_limit - 1));
inline constexpr int texel_address_bits = 32;

// Whether the pixel stages of a configuration exist in RTL, in its modes. Where one takes R_pixel, that must
// be pipelined, and its operand must fit the unit.
bool has_pixel_rtl(const Config& config);

// The package's text: formats, the depth code, reciprocal unit and the latencies of config/pixel_timing. What
// may change between triangles or scenes is not in it: comparison, filter, wrap, blend and so on are ports.
// The same configuration gives the same text, byte for byte. Throws InputError where there is no such RTL.
std::string emit_pixel_sv(const Config& config);

}  // namespace bitspan
