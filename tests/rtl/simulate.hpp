// SPDX-License-Identifier: Apache-2.0
// A SystemVerilog bench of a test's own, run by a simulator; the bench has no inputs and prints what it
// finds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tb/programs.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {

// What the bench printed, its lines as they are. Throws std::runtime_error with the log where a tool refuses
// or the simulation ends with an error.
std::string run_icarus(const std::vector<std::filesystem::path>& sources, const std::string& top,
                       const std::vector<std::string>& arguments = {});
std::string run_verilator(const std::vector<std::filesystem::path>& sources, const std::string& top,
                          const std::vector<std::string>& flags = verilator_safe_flags());

}  // namespace bitspan
