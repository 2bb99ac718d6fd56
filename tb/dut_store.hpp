// SPDX-License-Identifier: Apache-2.0
// The designs under test that `bitspan dut add` made known: a folder per name below $BITSPAN_DUTS, else
// $XDG_DATA_HOME/bitspan/duts, else ~/.local/share/bitspan/duts.
//
// A folder appears complete or not at all, and holds the map as it was read, the configuration, the wrapper,
// and the whole paths of the sources, which stay where they are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tb/dut_wrapper.hpp"

namespace bitspan {

struct StoredDut {
  DutDesign design;
  std::optional<Config> config;  // the one that the design is for; none: any
};

struct DutRequest {
  std::string map;                   // a file
  std::string top, name, config;     // in place of the map's, and of the map's file name; empty: as there
  std::vector<std::string> sources;  // in place of the map's
};

// Reads the map, and what it names. Paths in it are relative to its folder, those of the request to the
// current one. Throws InputError as parse_dut_map.
StoredDut read_dut(const DutRequest& request);

std::filesystem::path duts_folder();
// Writes the folder of a design; `replace`: also where there is one of this name. Throws InputError where
// there is one and it is not to be replaced, and where it cannot be written.
void store_dut(const StoredDut& dut, const DutRequest& request, const std::string& wrapper, bool replace);
// Throw InputError where there is no design of the name.
StoredDut load_dut(const std::string& name);
std::string stored_wrapper(const std::string& name);
void remove_dut(const std::string& name);
// In the order of the alphabet.
std::vector<std::string> dut_names();

}  // namespace bitspan
