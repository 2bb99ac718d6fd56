// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_pixel_pkg: what the pixel stages in RTL take from a configuration.
#pragma once

#include <string>

#include "config/config.hpp"

namespace bitspan {

// The package's text: formats, the depth code, reciprocal unit and the latencies of config/pixel_timing. What
// may change between triangles or scenes is not in it: comparison, filter, wrap, blend and so on are ports.
// The same configuration gives the same text, byte for byte. Throws InputError where a value does not fit the
// RTL.
std::string emit_pixel_sv(const Config& config);

}  // namespace bitspan
