#include "model/timed/values.hpp"

#include <span>
#include <stdexcept>
#include <string>

namespace bitspan::timed {

bool setup_values(Run& run, TriangleItem& item) {
  Counters& counters = run.counters;
  ++counters.triangles;
  if (!model::setup(run.pipeline.setup, *item.triangle, item.index, item.setup)) {
    ++counters.degenerate;
    return false;
  }
  deliver(run.trace, item.setup);
  if (run.pipeline.const_depth_rows) return true;
  item.edges = model::setup_edges(run.pipeline.setup, item.setup);
  counters.divides_edge += static_cast<std::uint64_t>(item.edges.count) *
                           static_cast<std::uint64_t>(run.pipeline.setup.divides_per_edge);
  deliver_all(run.trace, std::span(item.edges.edge).first(static_cast<std::size_t>(item.edges.count)));
  return true;
}

void span_setup_values(Run& run, RowItem& item) {
  const auto& stage = run.pipeline.span_setup;
  const int divides = run.pipeline.const_depth_rows
                          ? model::span_setup(stage, item.plane_row, item.geometry, item.span)
                          : model::span_setup(stage, item.row, item.span);
  run.counters.divides_row += static_cast<std::uint64_t>(divides);
  deliver(run.trace, item.span);
  // The clocks go by the row's pixels, the values by the span's.
  if (item.span.count != item.count) {
    throw std::logic_error("span_setup made " + std::to_string(item.span.count) + " pixels of a row of " +
                           std::to_string(item.count));
  }
}

void span_values(Run& run, const RowItem& row, model::SpanState& state, FragmentItem& item) {
  item.texture = row.texture;
  model::span(run.pipeline.span, state, item.fragment);
  Counters& counters = run.counters;
  ++counters.fragments;
  counters.covered += static_cast<std::uint64_t>(item.fragment.covered);
  counters.divides_pixel += static_cast<std::uint64_t>(run.pipeline.span.divides_per_fragment);
  if (run.pipeline.const_depth_rows) counters.divides_saved += item.fragment.covered;
  deliver(run.trace, item.fragment);
}

bool depth_values(Run& run, FragmentItem& item) {
  const std::uint32_t stored = run.frame.depth[run.pixel(item.fragment)];
  const bool passed = model::depth(run.pipeline.depth, item.fragment, stored, item.depth);
  deliver(run.trace, item.depth);
  if (passed) ++run.counters.depth_passed;
  return passed;
}

bool texture_values(Run& run, FragmentItem& item) {
  const bool lives = model::texture(run.pipeline.texture, run.image(item), item.fragment, item.texel);
  deliver(run.trace, item.texel);
  if (!lives) ++run.counters.killed;
  return lives;
}

void fog_values(Run& run, FragmentItem& item) {
  model::fog(run.pipeline.fog, item.fragment, item.texel, item.fog);
  deliver(run.trace, item.fog);
}

void merge_values(Run& run, FragmentItem& item) {
  const std::uint8_t* color = run.frame.color.data() + 4 * run.pixel(item.fragment);
  MergeRecord merged;
  model::merge(run.pipeline.merge, item.depth, item.texel, item.fog, {color[0], color[1], color[2]}, merged);
  write_fragment(run.frame, item.fragment, merged, run.uv_ulp);
  ++run.counters.written;
  deliver(run.trace, merged);
}

}  // namespace bitspan::timed
