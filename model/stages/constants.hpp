// SPDX-License-Identifier: Apache-2.0
// constants: the depth code's constants, once per scene. docs/numeric-spec.md, "Constants" (D1, H6, F3).
#pragma once

#include "config/config.hpp"
#include "config/lines.hpp"
#include "engine/records.hpp"
#include "model/numeric/quantize.hpp"
#include "scene/scene.hpp"

namespace bitspan::model {

struct Constants {
  int exponent = 0;  // E: distances are divided by 2^E
  ConstantsRecord record;
};

// Throws InputError where the scene's range does not fit the configuration (s_min' or B not positive,
// s_min' not below s_max').
template <class Watch = NoObserve>
Constants make_constants(const Config& config, const Scene& scene, Watch watch = {});

// Those of the scene's projector, as a view of its range has them. Throws InputError as make_constants does.
Constants projector_constants(const Config& config, const Scene& scene);

// A start offset in its accumulator's unit; `kept` is the format that half_ulp refers to.
Exact offset_value(const StartOffset& offset, const Format& kept);
// That of a line along an edge or a row; 0 where it has none.
Exact offset_value(const Config& config, const LineWalk& walk);

// B as an exact number.
Exact b_of(const Config& config, const ConstantsRecord& constants);

}  // namespace bitspan::model
