// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_rotate_pkg: what rtl/rotate.sv takes from a configuration.
#pragma once

#include <string>

#include "config/config.hpp"

namespace bitspan {

// Clocks from a vector's acceptance by rtl/rotate.sv until it is valid at the output.
int rotate_clocks(const Config& config);

// The package's text: the formats of rotate.t, rotate.s and rotate.xy, and the clocks of a product. The same
// configuration gives the same text, byte for byte. Throws InputError as check_rotate.
std::string emit_rotate_sv(const Config& config);

}  // namespace bitspan
