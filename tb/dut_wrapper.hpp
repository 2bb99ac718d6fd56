// SPDX-License-Identifier: Apache-2.0
// A design of the user's as a module of one shape: its ports as Verilator reads them, and the wrapper that
// has a port of 64 bits per field in their place.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tb/dut_map.hpp"
#include "tb/rtl_module.hpp"

namespace bitspan {

// A map with what `bitspan dut add` makes of it.
struct DutDesign {
  std::string name;  // without dut:
  DutMap map;
  std::vector<std::filesystem::path> sources;  // whole paths; of a .f file Verilator reads what it lists
};

// One field at one port, in the order of the map. Wrapper port in<i>_i or out<i>_o is the i-th of its side.
struct DutLane {
  DutField field;
  std::string port;
  PortWord word;
  int bits = 0;  // at the port
};

struct DutWrapper {
  std::string text;     // the module bitspan_dut
  std::string package;  // of the configuration, where it has one
  std::vector<DutLane> inputs, outputs;
  std::vector<std::string> open_inputs;      // of the design, in no part of the map: 0
  std::vector<std::filesystem::path> files;  // read for the design, those that it includes too
  std::string hash;  // of the map and of the files' names and texts: which design is under test
};

inline constexpr const char* dut_top = "bitspan_dut";

// Reads the design with Verilator, and checks that each port of the map is there with the direction and the
// width that the map says. Throws InputError "file:line: key: what; expected ..."; for errors in the sources
// "file:line:column: Verilator's text"; ToolError where there is no Verilator.
DutWrapper wrap_dut(const DutDesign& design, const Config& config);
// Reads wrapper and design together, so that nothing is left for the first run to find. Throws as wrap_dut.
void lint_dut(const DutDesign& design, const DutWrapper& wrapper);
// The hash over what the files hold now. Throws InputError where one cannot be read.
std::string dut_hash(const DutDesign& design, const std::vector<std::filesystem::path>& files);

// The wrapped design for RtlModule: in_valid_i, out_ready_i and the inputs; in_ready_o, out_valid_o and the
// outputs.
RtlModuleDesign module_of(const DutDesign& design, const DutWrapper& wrapper, const std::string& config);

}  // namespace bitspan
