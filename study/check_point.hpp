// SPDX-License-Identifier: Apache-2.0
// Whether a point that is recommended is what the hardware would do: model = golden, and model = RTL.
#pragma once

#include <span>
#include <string>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct PointCheck {
  bool held = false;
  // "model = golden: 1,234,567 values equal; model = rtl: ..." or the first difference, or why the RTL took
  // no part.
  std::string text;
};

// All records and pictures of the scenes through golden and model, and through model and the Verilated RTL
// where the mode has one. Builds the RTL of this configuration (some ten seconds, kept by tb/rtl_build).
// Throws InputError where a tool is missing.
PointCheck check_point(const Config& config, std::span<const Scene> scenes);

}  // namespace bitspan
