// setup, timed: a triangle in, the same with its vertices and edges out, or nothing where it has no area.
#pragma once

#include "model/timed/run.hpp"

namespace bitspan::timed {

class SetupStage : public PipeStage<TriangleItem> {
 public:
  SetupStage(Run& run, Fifo<TriangleItem*>& in, Fifo<TriangleItem*>& out)
      : PipeStage("setup", run.timing(Stage::setup), in, &out, run.triangles), run_(run) {}

 private:
  bool enters(TriangleItem& item) override {
    Counters& counters = run_.counters;
    ++counters.triangles;
    if (!model::setup(run_.pipeline.setup, *item.triangle, item.index, item.setup)) {
      ++counters.degenerate;
      return false;
    }
    if (run_.trace != nullptr) run_.trace->setup.push_back(item.setup);
    if (run_.pipeline.const_depth_rows) return true;
    item.edges = model::setup_edges(run_.pipeline.setup, item.setup);
    counters.divides_edge += static_cast<std::uint64_t>(item.edges.count) *
                             static_cast<std::uint64_t>(run_.pipeline.setup.divides_per_edge);
    if (run_.trace != nullptr) {
      run_.trace->edge.insert(run_.trace->edge.end(), item.edges.edge.begin(),
                              item.edges.edge.begin() + item.edges.count);
    }
    return true;
  }
  Run& run_;
};

}  // namespace bitspan::timed
