// SPDX-License-Identifier: Apache-2.0
// plane_walk, timed: takes edge_walk's place in const_depth_rows.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/walk.hpp"

namespace bitspan::timed {

class PlaneWalk {
 public:
  explicit PlaneWalk(Run& run) : run_(run) {}

  void start(TriangleItem& item) {
    surface_ = model::surface_of(run_.pipeline, *item.triangle);
    model::start_plane_walk(run_.pipeline.plane_walk, item.setup, state_);
    run_.counters.divides_edge += model::divides_per_plane;
    deliver(run_.trace, state_.record);
  }
  bool finished() const { return model::finished(state_); }
  bool row(RowItem& item) {
    if (!model::plane_walk(run_.pipeline.plane_walk, state_, item.plane_row)) return false;
    item.surface = surface_;
    item.count = item.plane_row.count;
    item.geometry = state_.geometry;
    ++run_.counters.rows;
    --run_.counters.divides_saved;
    deliver(run_.trace, item.plane_row);
    return true;
  }

 private:
  Run& run_;
  model::Surface surface_;
  model::PlaneWalkState state_;
};

}  // namespace bitspan::timed
