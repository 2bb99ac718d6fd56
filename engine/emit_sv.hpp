// SPDX-License-Identifier: Apache-2.0
// The SystemVerilog package bitspan_cfg_pkg: everything the RTL takes from a configuration.
#pragma once

#include <string>

#include "config/config.hpp"

namespace bitspan {

// The package's text: formats, mode, reciprocal units with their tables as exact integers, start offsets and
// the latencies of config/rtl_timing. The same configuration gives the same text, byte for byte. Throws
// InputError where the configuration has no RTL, or where a value does not fit the RTL's fixed ports.
std::string emit_sv(const Config& config);

}  // namespace bitspan
