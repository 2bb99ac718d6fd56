// SPDX-License-Identifier: Apache-2.0
// The sources of the RTL, as the lists in rtl/ name them below data_folder().
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bitspan {

// rtl/span_interpolator.f: the sources below the package, in the order of reading.
std::vector<std::filesystem::path> rtl_sources();
// rtl/pixel_pipe.f: those of the pixel stages.
std::vector<std::filesystem::path> pixel_sources();
// rtl/project.f: those of project.
std::vector<std::filesystem::path> project_sources();
// rtl/light.f: those of light.
std::vector<std::filesystem::path> light_sources();
// rtl/forward_difference.f: those of forward_difference.
std::vector<std::filesystem::path> curve_sources();
// rtl/rotate.f: those of rotate.
std::vector<std::filesystem::path> rotate_sources();
// 32 hexadecimal digits over the names and texts of rtl_sources() and pixel_sources(): which RTL is under
// test. Throws InputError where a source cannot be read.
std::string rtl_sources_hash();

// Returns a package (engine/emit_sv) without its comment, which names the configuration.
std::string without_comments(const std::string& package);

}  // namespace bitspan
