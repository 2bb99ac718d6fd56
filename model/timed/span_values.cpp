// SPDX-License-Identifier: Apache-2.0
#include "model/timed/span_values.hpp"

#include <stdexcept>
#include <string>

namespace bitspan::timed {
namespace {

void start_channels(Run& run, RowItem& item) {
  const bool has_ends = !run.pipeline.const_depth_rows && !run.pipeline.by_plane;
  const model::PlaneGeometry* geometry = geometry_of(run, item);
  // Rows come in the order of their triangles.
  while (run.channels.front().setup.triangle < item.span.triangle) run.channels.pop_front();
  const model::SpanChannels start =
      model::span_channels(run.pipeline.channels, run.channels.front(), item.span,
                           has_ends ? &item.row : nullptr, has_ends ? &item.channels : nullptr, geometry);
  run.counters.divides_row += static_cast<std::uint64_t>(start.divides);
  model::deliver_channels(run.trace, run.pipeline.channels, start.record);
  item.channel_walk = {.geometry = geometry, .span = start.record};
}

}  // namespace

const model::PlaneGeometry* geometry_of(const Run& run, const RowItem& item) {
  return run.pipeline.const_depth_rows || item.is_line ? &item.geometry : nullptr;
}

void span_setup_values(Run& run, RowItem& item) {
  const auto& stage = run.pipeline.span_setup;
  int divides = 0;
  if (run.pipeline.const_depth_rows) {
    divides = model::span_setup(stage, item.plane_row, item.geometry, item.span);
  } else if (item.is_line) {
    divides = model::span_setup(stage, item.line, item.span);
  } else if (run.pipeline.by_plane) {
    // Rows come in the order of their triangles.
    while (run.planes.front().record.triangle < item.row.triangle) run.planes.pop_front();
    divides = model::span_setup(stage, item.row, run.planes.front(), item.span);
  } else {
    divides = model::span_setup(stage, item.row, item.span);
  }
  run.counters.divides_row += static_cast<std::uint64_t>(divides);
  deliver(run.trace, item.span);
  if (run.pipeline.channels.any()) start_channels(run, item);
  // The clocks go by the row's pixels, the values by the span's.
  if (item.span.count != item.count) {
    throw std::logic_error("span_setup made " + std::to_string(item.span.count) + " pixels of a row of " +
                           std::to_string(item.count));
  }
}

void span_values(Run& run, RowItem& row, model::SpanState& state, FragmentItem& item) {
  item.surface = row.surface;
  model::span(run.pipeline.span, state, item.fragment);
  Counters& counters = run.counters;
  ++counters.fragments;
  counters.covered += static_cast<std::uint64_t>(item.fragment.covered);
  counters.divides_pixel += static_cast<std::uint64_t>(state.divides);
  if (run.pipeline.const_depth_rows) counters.divides_saved += item.fragment.covered;
  deliver(run.trace, item.fragment);
  if (run.pipeline.channels.any()) {
    item.channels = model::fragment_channels(run.pipeline.channels, row.channel_walk, item.fragment);
    model::deliver_channels(run.trace, run.pipeline.channels, item.channels);
  }
}

}  // namespace bitspan::timed
