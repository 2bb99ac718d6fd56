// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_values.hpp"

#include <stdexcept>
#include <string>

namespace bitspan::timed {

void span_setup_values(Run& run, RowItem& item) {
  const auto& stage = run.pipeline.span_setup;
  int divides = 0;
  if (run.pipeline.const_depth_rows) {
    divides = model::span_setup(stage, item.plane_row, item.geometry, item.span);
  } else if (run.pipeline.by_plane) {
    // Rows come in the order of their triangles.
    while (run.planes.front().record.triangle < item.row.triangle) run.planes.pop_front();
    divides = model::span_setup(stage, item.row, run.planes.front(), item.span);
  } else {
    divides = model::span_setup(stage, item.row, item.span);
  }
  run.counters.divides_row += static_cast<std::uint64_t>(divides);
  deliver(run.trace, item.span);
  // The clocks go by the row's pixels, the values by the span's.
  if (item.span.count != item.count) {
    throw std::logic_error("span_setup made " + std::to_string(item.span.count) + " pixels of a row of " +
                           std::to_string(item.count));
  }
}

void span_values(Run& run, const RowItem& row, model::SpanState& state, FragmentItem& item) {
  item.surface = row.surface;
  model::span(run.pipeline.span, state, item.fragment);
  Counters& counters = run.counters;
  ++counters.fragments;
  counters.covered += static_cast<std::uint64_t>(item.fragment.covered);
  counters.divides_pixel += static_cast<std::uint64_t>(state.divides);
  if (run.pipeline.const_depth_rows) counters.divides_saved += item.fragment.covered;
  deliver(run.trace, item.fragment);
}

}  // namespace bitspan::timed
