// SPDX-License-Identifier: Apache-2.0
// distance and lod, timed: they work in the clock of the first test, or of texture where that stands in
// front.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

// The values of distance for a fragment that goes to texture, for both modes.
inline void distance_values(Run& run, FragmentItem& item) {
  if (!run.pipeline.has_distance) return;
  model::distance(run.pipeline.distance, item.fragment, item.distance);
  deliver(run.trace, item.distance);
}

// The same of lod.
inline void lod_values(Run& run, FragmentItem& item) {
  if (!run.pipeline.has_lod) return;
  const GradientRecord* gradient = run.lod_gradients.of(item.fragment);
  model::fragment_lod(run.pipeline, item.fragment, run.image(item), gradient, item.distance, item.lod);
  deliver(run.trace, item.lod);
}

}  // namespace bitspan::timed
