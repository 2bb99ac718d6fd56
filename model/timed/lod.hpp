// SPDX-License-Identifier: Apache-2.0
// lod, timed: works in the clock of depth.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

// The values of lod for a fragment that passed the depth test, for both modes.
inline void lod_values(Run& run, FragmentItem& item) {
  if (!run.pipeline.has_lod) return;
  const GradientRecord* gradient = nullptr;
  if (run.pipeline.has_gradients) {
    // Fragments come in the order of their triangles.
    while (run.gradients.front().triangle < item.fragment.triangle) run.gradients.pop_front();
    gradient = &run.gradients.front();
  }
  model::fragment_lod(run.pipeline, item.fragment, run.image(item), gradient, item.lod, run.trace);
}

}  // namespace bitspan::timed
