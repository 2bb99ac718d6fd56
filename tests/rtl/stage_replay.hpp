// SPDX-License-Identifier: Apache-2.0
// The clocks of a stage's bench once more under Icarus, on the sources or on the netlist that Yosys makes of
// them.
#pragma once

#include <filesystem>
#include <vector>

#include "tests/rtl/stage_bench.hpp"

namespace bitspan {

// Drives the inputs of a trace that began with a reset module, and compares handshakes on each clock and a
// channel's values where they are valid. Returns the number of values compared; throws std::runtime_error
// where one differs, or where Icarus refuses. `sources`: the package is put in front of them where
// with_package is set.
std::size_t replay_under_icarus(const StageDesign& design, const StageTrace& trace,
                                const std::vector<std::filesystem::path>& sources, bool with_package);

// Verilator's lint is silent, and what Icarus makes of the sources, and of the netlist that Yosys understood,
// is what the trace has. The trace is changed at the end, which must show.
void expect_tools_agree(const StageDesign& design, StageTrace& trace);

}  // namespace bitspan
