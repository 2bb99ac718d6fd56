// SPDX-License-Identifier: Apache-2.0
// Files for tb/icarus_tb.sv: a case's records, and what the interpolator must make of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/rtl/interpolator_case.hpp"
#include "tests/support/files.hpp"

namespace bitspan {

struct IcarusRun {
  std::vector<std::filesystem::path> sources;
  std::vector<std::string> arguments;
  std::string expected;  // the line of success
};

// Writes the files into the folder; the sources are those of data_folder().
IcarusRun prepare_icarus(const TemporaryFolder& folder, const Config& config, const InterpolatorCase& given);

}  // namespace bitspan
