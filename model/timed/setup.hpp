// setup, timed: a triangle in, the same with its vertices and edges out, or nothing where it has no area.
#pragma once

#include "model/timed/values.hpp"

namespace bitspan::timed {

class SetupStage : public PipeStage<TriangleItem> {
 public:
  SetupStage(Run& run, Fifo<TriangleItem*>& in, Fifo<TriangleItem*>& out)
      : PipeStage(to_string(Stage::setup), run.timing(Stage::setup), in, &out, run.triangles), run_(run) {}

 private:
  bool enters(TriangleItem& item) override { return setup_values(run_, item); }
  Run& run_;
};

}  // namespace bitspan::timed
