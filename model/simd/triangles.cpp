// SPDX-License-Identifier: Apache-2.0
#include "model/simd/triangles.hpp"

#include <algorithm>
#include <bit>

#include "model/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/simd/triangles.cpp"
#include "hwy/foreach_target.h"
#include "model/simd/triangles/spans-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// Whether every register that setup, edge_walk and span_setup quantise into rounds by adding a constant, and
// saturates.
bool all_branch_free(const Pipeline& pipeline) {
  const SetupStage& a = pipeline.setup;
  const EdgeWalkStage& b = pipeline.edge_walk;
  const SpanSetupStage& c = pipeline.span_setup;
  const Register* const registers[] = {
      &a.coordinate,
      &a.s,
      &a.h,
      &a.uv,
      &a.shade,
      &a.dy.unit.output(),
      &a.x_step.r,
      &a.h_step.r,
      &a.f_step.r,
      &a.shade_step.r,
      &a.f_diff.r,
      &b.x_start.r,
      &b.h_start.r,
      &b.f_start.r,
      &b.shade_start.r,
      &b.x.r,
      &b.h.r,
      &b.shade.r,
      &b.reciprocal.output(),
      &b.uv.r,
      &b.linear_uv.r,
      &c.length.unit.output(),
      &c.h_line.step.r,
      &c.f_step.r,
      &c.shade_line.step.r,
      &c.f_diff.r,
      &c.h_line.start.r,
      &c.f_start.r,
      &c.shade_line.start.r,
  };
  // What BranchFree shifts a unit's result by.
  const auto shifts = [](const ReciprocalUnit& unit) {
    const Reciprocal& r = unit.config();
    return std::max(r.table_bits, r.internal_bits) - unit.output().fraction <= 62;
  };
  if (!shifts(a.dy.unit) || !shifts(b.reciprocal) || !shifts(c.length.unit)) return false;
  return std::all_of(std::begin(registers), std::end(registers),
                     [](const Register* r) { return is_branch_free(*r); });
}

// Rows of a group's triangles above `to`, of those that have some from there on and are counted here.
std::uint64_t rows_above(const TriangleRows& from, std::size_t first, std::size_t n,
                         const TriangleGroup& group, std::int64_t to) {
  std::int64_t out = 0;
  for (std::size_t j = 0; j < n; ++j) {
    const bool counted = (from.which[first + j] & TriangleRows::counted) != 0;
    if (!counted && group.end[j] > to) out += std::max<std::int64_t>(0, to - group.y[j]);
  }
  return static_cast<std::uint64_t>(out);
}

template <class Observer>
HWY_NOINLINE std::size_t in_lanes(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                                  Columns<SpanRecord>& spans, Counters& counters, Trace* trace,
                                  const Observer& observer) {
  const SetupStage setup = pipeline.setup;  // copies: no store can change them
  const EdgeWalkStage walk = pipeline.edge_walk;
  const Stages stages{setup, walk, pipeline.span_setup, pipeline.channels};
  const Adders adders = adders_of(walk, pipeline.channels);
  batch.prepare(pipeline.channels.in_use.size());
  const RowColumns columns = row_columns(walk, batch, pipeline.channels.in_use.size(), trace != nullptr);
  constexpr auto capacity = static_cast<std::int64_t>(TriangleBatch::row_capacity);
  TriangleGroup group;
  std::int64_t size = 0;  // rows waiting
  std::int64_t all = 0;
  const auto finish = [&] {
    finish_rows(stages, columns, static_cast<std::size_t>(size), batch, spans, counters, trace, observer);
    size = 0;
  };
  std::size_t first = 0;
  for (std::size_t n; first < from.which.size() && all < capacity; first += n) {
    n = std::min(lane_count, from.which.size() - first);
    set_up(stages, adders, from, first, n, group, counters, trace, observer);
    if (pipeline.rows.first > 0) batch.rows_above += rows_above(from, first, n, group, pipeline.rows.first);
    for (std::size_t j = 0; j < n; ++j) {
      const std::int64_t rows = group.rows[j];
      if (rows <= group.skip[j]) continue;
      for (EdgeGroup& e : group.edges) {
        if constexpr (Observer::enabled) note_ramps(adders, e, j, *observer.statistics);
        if (e.walked[j] != 0) [[unlikely]] {
          skip_rows(adders, e, j, std::min(group.skip[j], e.end[j]) - e.first[j], observer);
        }
      }
      all += rows - group.skip[j];
      for (std::int64_t done = group.skip[j]; done < rows;) {
        if (size == capacity) finish();
        const std::int64_t some = std::min(capacity - size, rows - done);
        append_rows(adders, group, j, group.index[j], done, some, columns, static_cast<std::size_t>(size),
                    observer);
        size += some;
        done += some;
      }
    }
  }
  finish();
  return first;
}

template <class R>
void append(Columns<R>& records, const R& record) {
  if (records.size == records.capacity()) records.reserve(2 * records.size + 1);
  const auto raw = raw_values(record);
  for (std::size_t f = 0; f < raw.size(); ++f) {
    records[std::bit_cast<Member<R>>(f * sizeof(std::int64_t))][records.size] = raw[f];
  }
  ++records.size;
}

// The scalar stages, where lanes have no room.
template <class Watch>
std::size_t one_by_one(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                       Columns<SpanRecord>& spans, Counters& counters, Trace* trace, Watch watch) {
  const std::size_t in_use = pipeline.channels.in_use.size();
  Rows rows;
  PlaneWalkState walk;
  Counters elsewhere;
  const OncePerTriangle nowhere{elsewhere, nullptr};
  const OncePerTriangle here{counters, trace};
  std::size_t at = 0;
  for (const std::size_t had = spans.size;
       at < from.which.size() && spans.size - had < TriangleBatch::row_capacity; ++at) {
    const bool counted = (from.which[at] & TriangleRows::counted) != 0;
    const std::int64_t index = from.first_index + (from.which[at] & ~TriangleRows::counted);
    rows.clear();
    triangle_to_rows(pipeline, triangle_at(from, at), index, walk, rows,
                     counted || from.again ? nowhere : here, counted ? elsewhere : counters, trace, watch);
    if (!counted) batch.rows_above += rows.above;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::int64_t y = rows.rows[i].y;
      if (y < from.first_row || y >= from.end_row) continue;
      const SpanRecord span = row_to_span(pipeline, rows, i, counters, watch);
      append(spans, span);
      if (trace != nullptr) trace->span.push_back(span);
      if (in_use == 0) continue;
      const SpanChannels channels = row_to_channels(pipeline, rows, i, span, counters, nullptr, watch);
      for (std::size_t c = 0; c < in_use; ++c) {
        batch.channels[c].size = spans.size - 1;
        append(batch.channels[c], channels.record[c]);
      }
    }
  }
  return at;
}

std::size_t to_spans(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                     Columns<SpanRecord>& spans, Counters& counters, Trace* trace) {
  if (!triangles_in_lanes(pipeline) || (trace != nullptr && pipeline.channels.any())) {
    return one_by_one(pipeline, from, batch, spans, counters, trace, NoObserve{});
  }
  return all_branch_free(pipeline)
             ? in_lanes(pipeline, from, batch, spans, counters, trace, Unwatched<BranchFree>{})
             : in_lanes(pipeline, from, batch, spans, counters, trace, Unwatched<NoObserve>{});
}

std::size_t to_spans_observed(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                              Columns<SpanRecord>& spans, Counters& counters, Trace* trace,
                              Statistics& statistics) {
  if (!triangles_in_lanes(pipeline) || pipeline.channels.any()) {
    return one_by_one(pipeline, from, batch, spans, counters, trace, Observe{&statistics});
  }
  LaneStatistics lane_statistics;
  const std::size_t done =
      in_lanes(pipeline, from, batch, spans, counters, trace, Watched{&lane_statistics, &statistics});
  lane_statistics.fold(statistics);
  return done;
}

}  // namespace

TriangleKernels kernels() { return {to_spans, to_spans_observed}; }

}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bitspan::model {

HWY_EXPORT(kernels);

TriangleKernels triangle_kernels(VectorTarget target) {
  return on_target(target, [] { return HWY_DYNAMIC_DISPATCH(kernels)(); });
}

}  // namespace bitspan::model
#endif
