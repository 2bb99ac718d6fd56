#include "model/timed/values.hpp"

#include <cmath>
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
  if (run.trace != nullptr) run.trace->setup.push_back(item.setup);
  if (run.pipeline.const_depth_rows) return true;
  item.edges = model::setup_edges(run.pipeline.setup, item.setup);
  counters.divides_edge += static_cast<std::uint64_t>(item.edges.count) *
                           static_cast<std::uint64_t>(run.pipeline.setup.divides_per_edge);
  if (run.trace != nullptr) {
    run.trace->edge.insert(run.trace->edge.end(), item.edges.edge.begin(),
                           item.edges.edge.begin() + item.edges.count);
  }
  return true;
}

void span_setup_values(Run& run, RowItem& item) {
  const auto& stage = run.pipeline.span_setup;
  const int divides = run.pipeline.const_depth_rows
                          ? model::span_setup(stage, item.plane_row, item.geometry, item.span)
                          : model::span_setup(stage, item.row, item.span);
  run.counters.divides_row += static_cast<std::uint64_t>(divides);
  if (run.trace != nullptr) run.trace->span.push_back(item.span);
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
  if (run.trace != nullptr) run.trace->fragment.push_back(item.fragment);
}

bool depth_values(Run& run, FragmentItem& item) {
  const std::uint32_t stored = run.frame.depth[run.pixel(item.fragment)];
  const bool passed = model::depth(run.pipeline.depth, item.fragment, stored, item.depth);
  if (run.trace != nullptr) run.trace->depth.push_back(item.depth);
  if (passed) ++run.counters.depth_passed;
  return passed;
}

bool texture_values(Run& run, FragmentItem& item) {
  const bool lives = model::texture(run.pipeline.texture, run.image(item), item.fragment, item.texel);
  if (run.trace != nullptr) run.trace->texture.push_back(item.texel);
  if (!lives) ++run.counters.killed;
  return lives;
}

void fog_values(Run& run, FragmentItem& item) {
  model::fog(run.pipeline.fog, item.fragment, item.texel, item.fog);
  if (run.trace != nullptr) run.trace->fog.push_back(item.fog);
}

void merge_values(Run& run, FragmentItem& item) {
  Frame& frame = run.frame;
  const std::size_t at = run.pixel(item.fragment);
  std::uint8_t* color = frame.color.data() + 4 * at;
  MergeRecord merged;
  model::merge(run.pipeline.merge, item.depth, item.texel, item.fog, {color[0], color[1], color[2]}, merged);
  color[0] = static_cast<std::uint8_t>(merged.r);
  color[1] = static_cast<std::uint8_t>(merged.g);
  color[2] = static_cast<std::uint8_t>(merged.b);
  frame.depth[at] = static_cast<std::uint32_t>(merged.z);
  const int uv_fraction = run.config.format(FormatId::span_uv).fraction();
  frame.u[at] = std::ldexp(static_cast<double>(item.fragment.u), -uv_fraction);
  frame.v[at] = std::ldexp(static_cast<double>(item.fragment.v), -uv_fraction);
  frame.triangle[at] = static_cast<std::int32_t>(item.fragment.triangle);
  ++run.counters.written;
  if (run.trace != nullptr) run.trace->merge.push_back(merged);
}

}  // namespace bitspan::timed
