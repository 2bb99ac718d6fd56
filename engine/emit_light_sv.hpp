// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_light_pkg: what rtl/light.sv takes from a configuration.
#pragma once

#include <string>

#include "config/config.hpp"
#include "scene/view.hpp"

namespace bitspan {

// 1 / F is a scale times 2^-e: the exponents of rtl/light.sv, of focal lengths from 2^-8 to 2^23 pixels.
inline constexpr int light_scale_exponent_min = -8, light_scale_exponent_max = 23;
// Of a reach of 2^-reach_octaves to 2^reach_octaves times the farthest s.
inline constexpr int light_reach_exponent_min = -reach_octaves - 1,
                     light_reach_exponent_max = reach_octaves + 1;

// The package's text: formats, the root's table and the latencies of config/pixel_timing. The same
// configuration gives the same text, byte for byte. Throws InputError where light.at is not pixel, and where
// a register of a vector or a cosine has no sign.
std::string emit_light_sv(const Config& config);

}  // namespace bitspan
