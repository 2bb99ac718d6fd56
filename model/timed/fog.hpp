// fog, timed.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

class FogStage : public PipeStage<FragmentItem> {
 public:
  FogStage(Run& run, Fifo<FragmentItem*>& in, Fifo<FragmentItem*>& out)
      : PipeStage("fog", run.timing(Stage::fog), in, &out, run.fragments), run_(run) {}

 private:
  bool enters(FragmentItem& item) override {
    model::fog(run_.pipeline.fog, item.fragment, item.texel, item.fog);
    if (run_.trace != nullptr) run_.trace->fog.push_back(item.fog);
    return true;
  }
  Run& run_;
};

}  // namespace bitspan::timed
