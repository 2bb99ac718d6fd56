// SPDX-License-Identifier: Apache-2.0
// edge_walk, timed: the adapter of the stage function for WalkStage.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/walk.hpp"

namespace bitspan::timed {

class EdgeWalk {
 public:
  explicit EdgeWalk(Run& run) : run_(run) {}

  void start(TriangleItem& item) {
    surface_ = model::surface_of(run_.pipeline, *item.triangle);
    state_ = model::start_edge_walk(run_.pipeline.edge_walk, item.setup, item.edges);
  }
  bool finished() const { return model::finished(state_); }
  bool row(RowItem& item) {
    if (!model::edge_walk(run_.pipeline.edge_walk, state_, item.row)) return false;
    item.surface = surface_;
    item.count = item.row.x_last - item.row.x_first + 1;
    ++run_.counters.rows;
    run_.counters.divides_edge += static_cast<std::uint64_t>(run_.pipeline.edge_walk.divides_per_row);
    deliver(run_.trace, item.row);
    if (run_.pipeline.channels.any() && !run_.pipeline.by_plane) {
      item.channels =
          model::row_channels(run_.pipeline.channels, run_.channels_of(item.row.triangle), item.row);
      model::deliver_channels(run_.trace, run_.pipeline.channels, item.channels);
    }
    return true;
  }

 private:
  Run& run_;
  model::Surface surface_;
  model::EdgeWalkState state_;
};

}  // namespace bitspan::timed
