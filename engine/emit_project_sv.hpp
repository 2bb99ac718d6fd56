// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_project_pkg: what rtl/project.sv takes from a configuration.
#pragma once

#include <bit>
#include <string>

#include "config/config.hpp"
#include "scene/texture.hpp"

namespace bitspan {

// Bits of a texture's side.
inline constexpr int texture_side_bits = std::bit_width(static_cast<unsigned>(texture_size_limit));

// The package's text: formats, the reciprocal unit and the latencies of config/pixel_timing. The same
// configuration gives the same text, byte for byte. Throws InputError where the configuration has no
// project.unit, or R_pixel is not pipelined.
std::string emit_project_sv(const Config& config);

}  // namespace bitspan
