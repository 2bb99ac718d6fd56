// SPDX-License-Identifier: Apache-2.0
// edge_walk, timed: the adapter of the stage functions for WalkStage; line_walk takes its place for a line,
// which is one row at most.
#pragma once

#include "model/timed/run.hpp"
#include "model/timed/walk.hpp"

namespace bitspan::timed {

class EdgeWalk {
 public:
  explicit EdgeWalk(Run& run) : run_(run) {}

  void start(TriangleItem& item) {
    surface_ = model::surface_of(run_.pipeline, *item.triangle);
    is_line_ = item.triangle->is_line;
    if (is_line_) {
      vertices_ = item.setup;
      return;
    }
    state_ = model::start_edge_walk(run_.pipeline.edge_walk, item.setup, item.edges);
  }
  bool finished() const { return !is_line_ && model::finished(state_); }
  bool row(RowItem& item) {
    item.is_line = is_line_;
    if (is_line_) return line_row(item);
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
  bool line_row(RowItem& item) {
    model::WalkedLine line;
    is_line_ = false;  // it has no row more
    state_ = {};
    const bool has_record = model::line_walk(run_.pipeline.line_walk, vertices_, line);
    if (!has_record) return false;
    item.surface = surface_;
    item.line = line.record;
    item.geometry = line.geometry;
    item.count = line.record.count;
    ++run_.counters.rows;
    run_.counters.divides_edge += run_.pipeline.line_walk.divides_per_line;
    deliver(run_.trace, item.line);
    return true;
  }

  Run& run_;
  model::Surface surface_;
  bool is_line_ = false;  // what is walked
  SetupRecord vertices_;  // of a line
  model::EdgeWalkState state_;
};

}  // namespace bitspan::timed
