// fog, timed.
#pragma once

#include "model/timed/values.hpp"

namespace bitspan::timed {

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
