// SPDX-License-Identifier: Apache-2.0
// Coverage of the RTL while tests run: with $BITSPAN_RTL_COVERAGE set to a folder, libraries are Verilated
// with counters of lines, toggles and handshakes, and each simulation leaves a file with them in that folder.
// tests/rtl/coverage runs the tests so, and reports.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bitspan {

inline constexpr const char* coverage_variable = "BITSPAN_RTL_COVERAGE";

// Whether it is asked for.
bool coverage_wanted();
// Verilator's flags for it.
const std::vector<std::string>& coverage_flags();

// Returns a module for each module of these texts that has channels, bound into every instance of it. A
// channel is a pair of ports NAME_valid and NAME_ready. It has four cover points: transfer, stall (valid and
// not ready), idle (not valid), and back_to_back (transfers on two clocks in a row).
std::string handshake_covers(const std::vector<std::string>& texts);

}  // namespace bitspan
