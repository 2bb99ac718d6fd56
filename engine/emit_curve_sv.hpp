// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_curve_pkg: what rtl/forward_difference.sv takes from a configuration.
#pragma once

#include <string>

#include "config/config.hpp"

namespace bitspan {

// The package's text: the formats of curve.d0 to curve.d3. The same configuration gives the same text, byte
// for byte.
std::string emit_curve_sv(const Config& config);

}  // namespace bitspan
