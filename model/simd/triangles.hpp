// SPDX-License-Identifier: Apache-2.0
// The vector form's first half: triangles to spans. Setup and slopes in lanes of triangles, accumulators as
// ramps (ramp-inl.hpp), row ends and span starts in lanes of rows of any triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/engine.hpp"
#include "model/engine_model.hpp"
#include "model/pipeline.hpp"
#include "model/simd/columns.hpp"
#include "model/simd/spans.hpp"

namespace bitspan::model {

// What an end of a row is computed from, beside its accumulators.
struct RowSource {
  // X: `exact`: x0 / x1; `dda` multiply: of x0 = x1, x1 = x_step, x2 = y1 of the edge; accumulate: none.
  std::int64_t l_x0, l_x1, l_x2, l_u1, l_v1;
  std::int64_t r_x0, r_x1, r_x2, r_u1, r_v1;
};

// What to_spans needs from call to call.
struct TriangleBatch {
  static constexpr std::size_t row_capacity = 512;
  std::uint64_t rows_above = 0;  // BandEngine::rows_above
  Columns<RowRecord> rows{row_capacity};
  Columns<RowSource> sources{row_capacity};
  // Of the channels in use: the accumulators of the rows, and of the spans, in their order, w and its step.
  PerChannel<Columns<RowChannelRecord>> row_channels;
  ChannelColumns channels;

  // Room for so many channels of a whole batch of rows.
  void prepare(std::size_t in_use) {
    for (std::size_t c = 0; c < in_use; ++c) row_channels[c].reserve(row_capacity);
  }
};

// Some of a list of triangles, in order, and which of their rows.
struct TriangleRows {
  // Set where another selection counts the triangle: one that crosses bands of rows is in several.
  static constexpr std::uint32_t counted = std::uint32_t{1} << 31;

  const Triangle* triangles = nullptr;     // of the list
  std::int64_t first_index = 0;            // input index of triangles[0]
  std::span<const std::uint32_t> which{};  // places in the list, some `counted`
  std::int64_t first_row = 0;
  std::int64_t end_row = INT64_MAX;
  bool again = false;  // as BandEngine::draw_again
};

struct TriangleKernels {
  // Triangles that check_triangle accepts to spans in order: appends one to `spans` per row that has pixels,
  // until about row_capacity rows are done, and returns how many triangles that took; all modes but
  // const_depth_rows. Counts triangles, degenerate, rows, divides_edge, divides_row; and rows_above in the
  // batch, of triangles that no other selection counts. Without a trace the
  // span's recip_m, recip_e, phase, fu_diff, fv_diff and step1 columns are not written; with one, appends the
  // records of setup, setup.edge, edge_walk and span_setup (of triangles with all their rows). The starts of
  // the channels in use are written to the batch, without a trace.
  std::size_t (*to_spans)(const Pipeline&, const TriangleRows&, TriangleBatch&, Columns<SpanRecord>& spans,
                          Counters&, Trace*);
  // The same with statistics of every register.
  std::size_t (*to_spans_observed)(const Pipeline&, const TriangleRows&, TriangleBatch&,
                                   Columns<SpanRecord>& spans, Counters&, Trace*, Statistics&);
};

// Throws InputError where the processor lacks the target.
TriangleKernels triangle_kernels(VectorTarget target);

// The first stage whose formats are wider than lanes hold (61 bits for a sum of two registers, 126 for what
// is rounded; forms.hpp); null where there is none. With one, the kernels do a triangle at a time by the
// scalar stages.
inline const char* stage_too_wide_for_lanes(const Pipeline& pipeline) {
  if (!pipeline.setup.fits_lanes) return "setup";
  if (!pipeline.edge_walk.fits_lanes) return "edge_walk";
  return pipeline.span_setup.fits_lanes ? nullptr : "span_setup";
}
// Channels are in lanes up to the start of a span, where nothing is traced or observed.
inline bool triangles_in_lanes(const Pipeline& pipeline) {
  return stage_too_wide_for_lanes(pipeline) == nullptr && pipeline.channels.rows_fit_lanes();
}

}  // namespace bitspan::model
