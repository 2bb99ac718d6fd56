// SPDX-License-Identifier: Apache-2.0
// What the program computes, as named texts. Each function stands for one kind of quantity.
#pragma once

#include "config/config.hpp"
#include "engine/counters.hpp"
#include "scene/scene.hpp"
#include "tests/frozen/digest_lines.hpp"

namespace bitspan::frozen {

// The hash, the canonical text, and the RTL's package where there is one.
Computed config_quantities(const Config& config);
// The triangles and textures, so that a scene made differently is not taken for a pipeline that changed.
Computed scene_quantities(const Scene& scene);
// The records, frame and counters of `model`, what its registers saw, and the frame of `ideal`. `golden`, and
// `model` without a trace, must be equal to that.
Computed value_quantities(const Config& config, const Scene& scene);

// The counters that all engines compare.
Quantities counter_quantities(const Counters& counters);

// What the timed model is run by: the modes of TimedMode.
enum class ClockedBy { span, both };
// The clocks of the frame drawn by one call, and those of each stage; with both modes the interpolator's
// handshake too. The modes must be equal, and their frame and counters those of `model`.
Computed clock_quantities(const Config& config, const Scene& scene, ClockedBy by);

}  // namespace bitspan::frozen
