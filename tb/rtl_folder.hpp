// SPDX-License-Identifier: Apache-2.0
// The RTL of a configuration for another project: its packages, or a folder with everything that is to be
// read, under names of that project's choice.
#pragma once

#include <string>

#include "config/config.hpp"
#include "scene/draw_state.hpp"

namespace bitspan {

struct RtlChoice {
  bool interpolator = true;           // rtl/span_interpolator.f and what it needs
  bool pixels = false;                // rtl/pixel_pipe.f and what it needs
  bool project = false;               // rtl/project.f and what it needs
  bool light = false;                 // rtl/light.f and what it needs
  bool curve = false;                 // rtl/forward_difference.f and what it needs
  bool rotate = false;                // rtl/rotate.f and what it needs
  DepthWhen when = DepthWhen::early;  // the order of tests that the pixel stages are built for
  std::string prefix;                 // in front of every module and package; empty: names as they are
};

// The packages' text. Throws InputError as emit_sv, emit_pixel_sv, emit_project_sv, emit_light_sv,
// emit_rotate_sv and check_prefix.
std::string rtl_packages(const Config& config, const RtlChoice& choice);

// Makes the folder with the packages, the sources and PREFIXbitspan.f, which lists them in the order of
// reading. A file is named after the module or the package in it. The folder appears complete or not at all.
// Returns the number of files. Throws InputError where it exists and is not empty, or cannot be written, and
// as rtl_packages.
int write_rtl_folder(const Config& config, const RtlChoice& choice, const std::string& path);

}  // namespace bitspan
