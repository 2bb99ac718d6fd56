// SPDX-License-Identifier: Apache-2.0
// fog, timed.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

// The values of fog, for both modes; and those of light, which works in its clock.
inline void fog_values(Run& run, FragmentItem& item) {
  if (run.pipeline.light.is_on) {
    LightRecord shone;
    model::light(run.pipeline.light, item.fragment, item.distance,
                 model::light_channels(run.pipeline.channels, item.fragment, &item.channels), item.texel,
                 shone);
    deliver(run.trace, shone);
    item.texel = model::lit(item.texel, shone);
  }
  model::fog(run.pipeline.fog, item.fragment, item.distance, item.texel, item.fog, model::NoObserve{},
             &item.channels);
  deliver(run.trace, item.fog);
}

class FogStage : public PipeStage<FragmentItem> {
 public:
  FogStage(Run& run, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage(to_string(Stage::fog), run.timing(Stage::fog), in, &out, run.fragments), run_(run) {}

 private:
  bool enters(FragmentItem& item) override {
    fog_values(run_, item);
    return true;
  }
  Run& run_;
};

}  // namespace bitspan::timed
