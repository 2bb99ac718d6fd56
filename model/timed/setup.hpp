// SPDX-License-Identifier: Apache-2.0
// setup, timed: a triangle in, the same with its vertices and edges out, or nothing where it has no area. A
// line is a triangle without edges.
#pragma once

#include <span>

#include "model/timed/run.hpp"

namespace bitspan::timed {

inline void setup_channels(Run& run, const TriangleItem& item, const model::Edges* edges) {
  if (!run.pipeline.channels.any()) return;
  run.channels.push_back(model::setup_channels(run.pipeline.channels, *item.triangle, item.setup, edges,
                                               run.pipeline.by_plane ? &run.planes.back() : nullptr));
  run.counters.divides_edge += static_cast<std::uint64_t>(run.channels.back().divides);
  model::deliver_channels(run.trace, run.pipeline.channels, run.channels.back().record);
}

// The values of setup, for both modes; false where the triangle has no area.
inline bool setup_values(Run& run, TriangleItem& item) {
  Counters& counters = run.counters;
  ++counters.triangles;
  if (!model::setup(run.pipeline.setup, *item.triangle, item.index, item.setup)) {
    ++counters.degenerate;
    return false;
  }
  deliver(run.trace, item.setup);
  if (item.triangle->is_line) return true;
  if (run.pipeline.has_gradients) {
    const GradientRecord gradient = model::setup_gradients(run.pipeline.plane_walk, item.setup);
    run.depth_gradients.put(gradient);
    run.lod_gradients.put(gradient);
    deliver(run.trace, gradient);
    if (!run.pipeline.const_depth_rows) counters.divides_edge += model::divides_per_gradients;
  }
  if (run.pipeline.const_depth_rows) {
    setup_channels(run, item, nullptr);
    return true;
  }
  item.edges = model::setup_edges(run.pipeline.setup, item.setup);
  counters.divides_edge += static_cast<std::uint64_t>(item.edges.count) *
                           static_cast<std::uint64_t>(run.pipeline.setup.divides_per_edge);
  if (run.pipeline.by_plane) {
    run.planes.push_back(model::setup_plane(run.pipeline.setup_plane, item.setup));
    counters.divides_edge += static_cast<std::uint64_t>(run.pipeline.setup_plane.divides_per_plane);
    deliver(run.trace, run.planes.back().record);
  }
  deliver_all(run.trace, std::span(item.edges.edge).first(static_cast<std::size_t>(item.edges.count)));
  setup_channels(run, item, &item.edges);
  return true;
}

class SetupStage : public PipeStage<TriangleItem> {
 public:
  SetupStage(Run& run, Fifo<TriangleItem*>& in, Fifo<TriangleItem*>& out)
      : PipeStage(to_string(Stage::setup), run.timing(Stage::setup), in, &out, run.triangles), run_(run) {}

 private:
  bool enters(TriangleItem& item) override { return setup_values(run_, item); }
  Run& run_;
};

}  // namespace bitspan::timed
