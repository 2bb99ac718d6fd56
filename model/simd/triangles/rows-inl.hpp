// SPDX-License-Identifier: Apache-2.0
// Edges to rows: the accumulators of every edge, row by row, into columns. The lanes are rows of one edge.
#include <algorithm>
#include <array>

#include "model/simd/triangles/edges-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_TRIANGLES_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_TRIANGLES_ROWS_INL
#undef BITSPAN_MODEL_SIMD_TRIANGLES_ROWS_INL
#else
#define BITSPAN_MODEL_SIMD_TRIANGLES_ROWS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

template <class R>
using Member = std::int64_t R::*;

struct SideColumns {
  Member<RowRecord> edge, x_acc, x, h, recip_m, recip_e, u, v;
  std::array<Member<RowRecord>, accumulators> acc;
  std::array<Member<RowRecord>, 4> shade;
  Member<RowSource> x0, x1, x2, u1, v1;
  Member<RowChannelRecord> channel_acc;
};
constexpr SideColumns left_columns{
    &RowRecord::l_edge,
    &RowRecord::l_x_acc,
    &RowRecord::l_x,
    &RowRecord::l_h,
    &RowRecord::l_recip_m,
    &RowRecord::l_recip_e,
    &RowRecord::l_u,
    &RowRecord::l_v,
    {&RowRecord::l_h_acc, &RowRecord::l_fu, &RowRecord::l_fv, &RowRecord::l_r_acc, &RowRecord::l_g_acc,
     &RowRecord::l_b_acc, &RowRecord::l_a_acc},
    {&RowRecord::l_r, &RowRecord::l_g, &RowRecord::l_b, &RowRecord::l_a},
    &RowSource::l_x0,
    &RowSource::l_x1,
    &RowSource::l_x2,
    &RowSource::l_u1,
    &RowSource::l_v1,
    &RowChannelRecord::l_acc};
constexpr SideColumns right_columns{
    &RowRecord::r_edge,
    &RowRecord::r_x_acc,
    &RowRecord::r_x,
    &RowRecord::r_h,
    &RowRecord::r_recip_m,
    &RowRecord::r_recip_e,
    &RowRecord::r_u,
    &RowRecord::r_v,
    {&RowRecord::r_h_acc, &RowRecord::r_fu, &RowRecord::r_fv, &RowRecord::r_r_acc, &RowRecord::r_g_acc,
     &RowRecord::r_b_acc, &RowRecord::r_a_acc},
    {&RowRecord::r_r, &RowRecord::r_g, &RowRecord::r_b, &RowRecord::r_a},
    &RowSource::r_x0,
    &RowSource::r_x1,
    &RowSource::r_x2,
    &RowSource::r_u1,
    &RowSource::r_v1,
    &RowChannelRecord::r_acc};

// Where the rows of a batch go: the columns of both ends.
struct RowColumns {
  struct Side {
    std::array<std::int64_t*, EdgeGroup::with_channels> sequence;
    std::array<std::int64_t*, EdgeGroup::constants> constant;  // null where nobody reads it
    std::int64_t* edge;
  };
  std::int64_t* triangle;
  std::int64_t* y;
  Side left, right;
};
RowColumns row_columns(const EdgeWalkStage& stage, TriangleBatch& batch, std::size_t channels, bool trace) {
  const auto side_of = [&](const SideColumns& c) {
    RowColumns::Side side{};
    for (std::size_t i = 0; i < channels; ++i) {
      side.sequence[EdgeGroup::sequences + i] = batch.row_channels[i][c.channel_acc];
    }
    for (std::size_t s = 0; s < accumulators; ++s) side.sequence[s] = batch.rows[c.acc[s]];
    side.sequence[accumulators] = has_x_step(stage.edge_x) ? batch.rows[c.x_acc] : batch.sources[c.x0];
    side.constant = {stage.linear_edges ? nullptr : batch.sources[c.u1],
                     stage.linear_edges ? nullptr : batch.sources[c.v1], nullptr, nullptr};
    switch (stage.edge_x) {
      case EdgeX::quotient:
        side.constant[2] = batch.sources[c.x1];
        break;
      case EdgeX::summed:
        break;
      case EdgeX::multiplied:
        side.constant[2] = batch.sources[c.x1];
        side.constant[3] = batch.sources[c.x2];
        break;
    }
    side.edge = trace ? batch.rows[c.edge] : nullptr;
    return side;
  };
  return {batch.rows[&RowRecord::triangle], batch.rows[&RowRecord::y], side_of(left_columns),
          side_of(right_columns)};
}

// n values from start on, and past them to the end of a vector.
HWY_INLINE void store_ramp(std::int64_t* to, std::int64_t start, std::int64_t increment, std::size_t n) {
  const Lanes each(increment);
  Lanes value = Lanes(start) + each * Lanes::iota(0);
  value.store(to);
  for (std::size_t i = lane_count; i < n; i += lane_count) {
    value = value + each * Lanes(static_cast<std::int64_t>(lane_count));
    value.store(to + i);
  }
}
HWY_INLINE void fill(std::int64_t* to, std::int64_t value, std::size_t n) {
  const Lanes x(value);
  x.store(to);
  for (std::size_t i = lane_count; i < n; i += lane_count) x.store(to + i);
}

template <class Observer>
HWY_INLINE std::int64_t next_row(const Adder& adder, std::int64_t value, std::int64_t step,
                                 const Observer& observer) {
  if constexpr (Observer::enabled) {
    return stepped(adder, value, step, Observe{observer.statistics});
  } else {
    static_cast<void>(observer);
    return stepped(adder, value, step, NoObserve{});
  }
}

// One by one, as the scalar stage does it; start is what the row before was left with.
template <class Observer>
HWY_NOINLINE void walk(const Adder& adder, EdgeGroup& e, std::size_t s, std::size_t j, std::int64_t first,
                       std::size_t n, std::int64_t* to, const Observer& observer) {
  std::int64_t value = e.start[s][j];
  for (std::size_t i = 0; i < n; ++i) {
    if (first != 0 || i != 0) value = next_row(adder, value, e.step[s][j], observer);
    to[i] = value;
  }
  e.start[s][j] = value;
}

// Rows first .. first + n - 1 of an edge's own, to the end of the last vector.
template <class Observer>
HWY_INLINE void emit(const Adders& adders, EdgeGroup& e, std::size_t j, std::int64_t first, std::size_t n,
                     const RowColumns::Side& side, std::size_t to, const Observer& observer) {
  if (e.walked[j] == 0 && first == 0 && n <= lane_count) [[likely]] {
    const Lanes iota = Lanes::iota(0);
    const auto put = [&](std::size_t s) HWY_ATTR {
      (Lanes(e.start[s][j]) + Lanes(e.increment[s][j]) * iota).store(side.sequence[s] + to);
    };
    for (std::size_t s = 0; s < EdgeGroup::sequences; ++s) put(s);
    for (std::size_t s = EdgeGroup::sequences; s < adders.used; ++s) put(s);
  } else {
    for (std::size_t s = 0; s < adders.used; ++s) {
      if ((e.walked[j] >> s & 1) == 0) {
        store_ramp(side.sequence[s] + to, e.start[s][j] + first * e.increment[s][j], e.increment[s][j], n);
      } else {
        walk(*adders.of[s], e, s, j, first, n, side.sequence[s] + to, observer);
      }
    }
  }
  for (std::size_t c = 0; c < EdgeGroup::constants; ++c) {
    if (side.constant[c] != nullptr) fill(side.constant[c] + to, e.constant[c][j], n);
  }
}

// What is no ramp, up to the row before `first`, which is not the first.
template <class Observer>
void skip_rows(const Adders& adders, EdgeGroup& e, std::size_t j, std::int64_t first,
               const Observer& observer) {
  for (std::size_t s = 0; s < adders.used; ++s) {
    if ((e.walked[j] >> s & 1) == 0) continue;
    for (std::int64_t i = 1; i < first; ++i) {
      e.start[s][j] = next_row(*adders.of[s], e.start[s][j], e.step[s][j], observer);
    }
  }
}

void note_ramps(const Adders& adders, const EdgeGroup& e, std::size_t j, Statistics& statistics) {
  for (std::size_t s = 0; s < adders.used; ++s) {
    if (adders.of[s] != nullptr && (e.walked[j] >> s & 1) == 0) {
      note_ramp(*adders.of[s], e.start[s][j], e.step[s][j], e.increment[s][j], e.end[j] - e.first[j] - 1,
                statistics);
    }
  }
}

// Rows done .. done + n - 1 of triangle j of the group, behind the `at` rows that are there.
template <class Observer>
HWY_INLINE void append_rows(const Adders& adders, TriangleGroup& group, std::size_t j, std::int64_t triangle,
                            std::int64_t done, std::int64_t n, const RowColumns& columns, std::size_t at,
                            const Observer& observer) {
  fill(columns.triangle + at, triangle, static_cast<std::size_t>(n));
  store_ramp(columns.y + at, group.y[j] + done, 1, static_cast<std::size_t>(n));
  // Edge 1 before edge 2, which writes over what vectors left behind it.
  for (std::size_t k = 0; k < 3; ++k) {
    EdgeGroup& e = group.edges[k];
    const std::int64_t begin = std::max(done, e.first[j]);
    const std::int64_t end = std::min(done + n, e.end[j]);
    if (begin >= end) continue;
    const RowColumns::Side& side = (group.mid_right[j] != 0) == (k == 0) ? columns.left : columns.right;
    const std::size_t to = at + static_cast<std::size_t>(begin - done);
    const auto count = static_cast<std::size_t>(end - begin);
    emit(adders, e, j, begin - e.first[j], count, side, to, observer);
    if (side.edge != nullptr) fill(side.edge + to, static_cast<std::int64_t>(k), count);
  }
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
