// SPDX-License-Identifier: Apache-2.0
// Checks that a recommended point is what the hardware would do: model = golden, and model = RTL.
#pragma once

#include <span>
#include <string>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct PointCheck {
  bool held = false;
  // "model = golden: 1,234,567 values equal; model = rtl: ...", the first difference, or why the RTL took no
  // part.
  std::string text;
};

// Compares all records and pictures of the scenes between golden and model. Where the mode has RTL, compares
// them between model and the Verilated RTL too. It builds the RTL of this configuration, which takes some ten
// seconds and is kept by tb/rtl_build. Throws InputError where a tool is missing.
PointCheck check_point(const Config& config, std::span<const Scene> scenes);

}  // namespace bitspan
