// SPDX-License-Identifier: Apache-2.0
// Stage `constants`: computed once per scene.
#pragma once

#include <vector>

#include "config/config.hpp"
#include "config/lines.hpp"
#include "engine/records.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

struct Constants {
  ConstantsRecord record;
  int s_exponent = 0;            // E: s is normalised by 2^-E
  std::vector<LineId> channels;  // those in use
  double fog_distance = 1;       // DT, where the scene has fog
};

// Throws InputError where the scene's range of s, or its fog distance, does not fit the formats.
Constants make_constants(const Config& config, const Scene& scene);

}  // namespace bitspan::golden
