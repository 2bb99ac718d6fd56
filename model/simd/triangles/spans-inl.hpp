// SPDX-License-Identifier: Apache-2.0
// Rows to spans: row ends and span starts. The lanes are rows of any triangles.
#include <algorithm>
#include <array>

#include "model/numeric/ratio-inl.hpp"
#include "model/simd/triangles/rows-inl.hpp"
#include "model/stages/span_setup-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_TRIANGLES_SPANS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_TRIANGLES_SPANS_INL
#undef BITSPAN_MODEL_SIMD_TRIANGLES_SPANS_INL
#else
#define BITSPAN_MODEL_SIMD_TRIANGLES_SPANS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

// floor(x0 / x1) and whether there is a rest.
HWY_NOINLINE Position<Lanes> exact_position_rare(Lanes at, Lanes length) {
  const FloorQuotientLanes q = quotient(numerator(at), length, 0);
  if (all(q.ok)) return {q.floor, one_where(q.rest != Lanes(0))};
  const Lanes floor = by_lane([&](std::size_t i) {
    return static_cast<std::int64_t>(floor_divide(lane(at, i), lane(length, i)).floor);
  });
  return {floor, one_where(floor * length != at)};
}
HWY_INLINE Position<Lanes> exact_position(Lanes at, Lanes length) {
  const NearQuotient q = near_quotient(at, make_divisor(length), 0);
  if (!q.ok) [[unlikely]] {
    return exact_position_rare(at, length);
  }
  const hn::ScalableTag<double> d;
  const auto mask = [](auto m) HWY_ATTR { return Lanes::Mask{hn::RebindMask(Lanes::Tag(), m)}; };
  const auto zero = hn::Zero(d);
  return {to_int(q.whole) - one_where(mask(hn::Lt(q.rest, zero))), one_where(!mask(hn::Eq(q.rest, zero)))};
}

template <class Observer>
HWY_INLINE Position<Lanes> position_at(const EdgeWalkStage& stage, const RowColumns::Side& side,
                                       std::size_t i, Lanes y, Lanes::Mask active, const Observer& observer) {
  std::int64_t* const x = side.sequence[accumulators] + i;
  const auto source = [&](std::size_t c) HWY_ATTR { return Lanes::load(side.constant[c] + i); };
  Lanes acc = Lanes::load(x);
  switch (stage.edge_x) {
    case EdgeX::quotient:
      return exact_position(acc, source(2));
    case EdgeX::summed:
      break;
    case EdgeX::multiplied:
      acc = line_at(stage.x_start, acc, source(2), rows_from(stage, y, source(3)), observer.on(active));
      acc.store(x);
      break;
  }
  return {acc << stage.x_up, Lanes(0)};
}

// Moves the lanes of a mask side by side. Highway 1.0's Compress copies its table to the stack each time.
#if HWY_TARGET == HWY_AVX3
struct Packing {
  Lanes::Mask m;
  explicit Packing(Lanes::Mask mask) : m(mask) {}
  HWY_INLINE Lanes operator()(Lanes x) const {
    return Lanes::from(Lanes::Vector{_mm512_maskz_compress_epi64(m.m.raw, x.v.raw)});
  }
};
#else
constexpr auto make_orders() {
  std::array<std::array<std::int64_t, lane_count>, std::size_t{1} << lane_count> orders{};
  for (std::size_t bits = 0; bits < orders.size(); ++bits) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < lane_count; ++i) {
      if ((bits >> i & 1) != 0) orders[bits][to++] = static_cast<std::int64_t>(i);
    }
  }
  return orders;
}
constexpr auto orders = make_orders();
struct Packing {
  decltype(hn::SetTableIndices(Lanes::Tag(), orders[0].data())) order;
  HWY_INLINE explicit Packing(Lanes::Mask mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Lanes::Tag(), mask.m, bits);
    order = hn::SetTableIndices(Lanes::Tag(), orders[bits[0]].data());
  }
  HWY_INLINE Lanes operator()(Lanes x) const { return Lanes::from(hn::TableLookupLanes(x.v, order)); }
};
#endif

HWY_INLINE EndOf<Lanes> row_end_at(const EdgeWalkStage& stage, const RowColumns::Side& side, std::size_t i,
                                   auto watch) {
  const auto acc_at = [&](std::size_t s) HWY_ATTR { return Lanes::load(side.sequence[s] + i); };
  const EdgeAccumulators<Lanes> acc{
      acc_at(0), acc_at(1), acc_at(2), {acc_at(3), acc_at(4), acc_at(5), acc_at(6)}};
  const Lanes u1 = stage.linear_edges ? Lanes(0) : Lanes::load(side.constant[0] + i);
  const Lanes v1 = stage.linear_edges ? Lanes(0) : Lanes::load(side.constant[1] + i);
  return end_values(stage, acc, u1, v1, watch);
}

// What only the trace reads of a row.
void keep_end(const SideColumns& side, const EndOf<Lanes>& end, Columns<RowRecord>& rows, std::size_t i) {
  end.h.store(rows[side.h] + i);
  end.recip_m.store(rows[side.recip_m] + i);
  end.recip_e.store(rows[side.recip_e] + i);
  end.u.store(rows[side.u] + i);
  end.v.store(rows[side.v] + i);
  for (std::size_t c = 0; c < channel_count; ++c) end.shade[c].store(rows[side.shade[c]] + i);
}
// Appends the records of the lanes in `some`: their rows are at i and up, their spans at `to` and up.
void trace_rows(const EdgeWalkStage& stage, const Columns<RowRecord>& rows, const Columns<SpanRecord>& spans,
                std::size_t i, Lanes::Mask some, std::size_t to, Trace& trace) {
  const Lanes drawn = one_where(some);
  for (std::size_t k = 0; k < lane_count; ++k) {
    if (lane(drawn, k) == 0) continue;
    RowRecord row = rows.record(i + k);
    if (!has_x_step(stage.edge_x)) row.l_x_acc = row.r_x_acc = 0;
    trace.row.push_back(row);
    trace.span.push_back(spans.record(to++));
  }
}

// Lanes past a column's end hold what its last row holds: numbers that the formats allow.
HWY_INLINE void pad(std::int64_t* column, std::size_t n) { Lanes(column[n - 1]).store(column + n); }

// A channel on the first pixels of rows i and up; sequence: of its accumulators.
HWY_NOINLINE LineStart<Lanes> start_channel(const ChannelForm& form, const LengthForm& length,
                                            const SpanStart<Lanes>& row, const RowColumns& columns,
                                            std::size_t sequence, std::size_t i) {
  constexpr NoObserve watch;
  const auto kept = [&](const RowColumns::Side& side) HWY_ATTR {
    return narrowed<Lanes>(form.at_edge, Lanes::load(side.sequence[sequence] + i), watch);
  };
  return start_line(form.row, length, row, kept(columns.left), kept(columns.right), watch);
}

// Rows to spans; rows that have no pixel are dropped.
template <class Observer>
HWY_NOINLINE void finish_rows(const Stages& stages, const RowColumns& columns, std::size_t n,
                              TriangleBatch& batch, Columns<SpanRecord>& spans, Counters& counters,
                              Trace* trace, const Observer& observer) {
  if (n == 0) return;
  const EdgeWalkStage walk = stages.walk;  // copies: no store can change them
  const SpanSetupStage stage = stages.span;
  Columns<RowRecord>& rows = batch.rows;
  pad(columns.triangle, n);
  pad(columns.y, n);
  const std::size_t in_use = stages.channels.in_use.size();
  for (const RowColumns::Side* side : {&columns.left, &columns.right}) {
    for (std::size_t s = 0; s < EdgeGroup::sequences + in_use; ++s) pad(side->sequence[s], n);
    for (std::int64_t* constant : side->constant) {
      if (constant != nullptr) pad(constant, n);
    }
  }
  if (spans.size + n > spans.capacity()) spans.reserve(std::max(2 * spans.capacity(), spans.size + n));
  const std::size_t had = spans.size;
  for (std::size_t c = 0; c < in_use; ++c) {
    batch.channels[c].size = had;
    batch.channels[c].reserve(spans.capacity());
  }
  std::size_t to = had;
  std::uint64_t lengths = 0;
  for (std::size_t i = 0; i < n; i += lane_count) {
    const auto active = first_lanes<std::int64_t>(std::min(lane_count, n - i));
    const Lanes y = Lanes::load(columns.y + i);
    const Position<Lanes> l_at = position_at(walk, columns.left, i, y, active, observer);
    const Position<Lanes> r_at = position_at(walk, columns.right, i, y, active, observer);
    const PixelsOf<Lanes> pixels = pixels_between<Lanes>(walk, l_at, r_at);
    const auto some = active & (pixels.first <= pixels.last);
    const std::size_t found = set_in(some);
    if (found == 0) continue;
    const auto watch = observer.on(some);
    const auto x_of = [&](const RowColumns::Side& side, const Position<Lanes>& p) HWY_ATTR {
      switch (walk.edge_x) {
        case EdgeX::quotient:
          return exact_row_x<Lanes>(walk, p, watch);
        case EdgeX::summed:
        case EdgeX::multiplied:
          return narrowed<Lanes>(walk.x, Lanes::load(side.sequence[accumulators] + i), watch);
      }
      unreachable();
    };
    const Lanes l_x = x_of(columns.left, l_at);
    const Lanes r_x = x_of(columns.right, r_at);
    const EndOf<Lanes> l = row_end_at(walk, columns.left, i, watch);
    const EndOf<Lanes> r = row_end_at(walk, columns.right, i, watch);
    const SpanStart<Lanes> s =
        start_span_at(stage, SpanEnd<Lanes>{l_x, l.h, l.u, l.v, l.shade},
                      SpanEnd<Lanes>{r_x, r.h, r.u, r.v, r.shade}, pixels.first, watch);
    lengths += set_in(s.has_length & some);

    const Packing pack(some);
    const auto put = [&](Member<SpanRecord> m, Lanes x) HWY_ATTR { pack(x).store(spans[m] + to); };
    put(&SpanRecord::triangle, Lanes::load(columns.triangle + i));
    put(&SpanRecord::x, pixels.first);
    put(&SpanRecord::y, y);
    put(&SpanRecord::count, pixels.last - pixels.first + Lanes(1));
    put(&SpanRecord::h, s.h);
    put(&SpanRecord::h_step, s.h_step);
    put(&SpanRecord::u1, s.u.base);
    put(&SpanRecord::v1, s.v.base);
    put(&SpanRecord::fu, s.u.start);
    put(&SpanRecord::fv, s.v.start);
    put(&SpanRecord::fu_step0, s.u.step);
    put(&SpanRecord::fv_step0, s.v.step);
    for (std::size_t c = 0; c < channel_count; ++c) {
      put(span_starts[c], s.shade[c]);
      put(span_steps0[c], s.shade_step[c]);
    }
    for (std::size_t c = 0; c < in_use; ++c) {
      const ChannelForm& form = stages.channels.in_use[c];
      const LineStart<Lanes> line =
          start_channel(form, stage.length, s, columns, EdgeGroup::sequences + c, i);
      pack(line.start).store(batch.channels[c][&SpanChannelRecord::w] + to);
      pack(line.step).store(batch.channels[c][&SpanChannelRecord::w_step0] + to);
    }
    if (trace != nullptr) {
      put(&SpanRecord::recip_m, s.recip_m);
      put(&SpanRecord::recip_e, s.recip_e);
      put(&SpanRecord::phase, Lanes(0));
      put(&SpanRecord::fu_diff, s.u.diff);
      put(&SpanRecord::fv_diff, s.v.diff);
      put(&SpanRecord::fu_step1, s.u.step);
      put(&SpanRecord::fv_step1, s.v.step);
      for (std::size_t c = 0; c < channel_count; ++c) put(span_steps1[c], s.shade_step[c]);
      pixels.first.store(rows[&RowRecord::x_first] + i);
      pixels.last.store(rows[&RowRecord::x_last] + i);
      l_x.store(rows[&RowRecord::l_x] + i);
      r_x.store(rows[&RowRecord::r_x] + i);
      keep_end(left_columns, l, rows, i);
      keep_end(right_columns, r, rows, i);
      trace_rows(walk, rows, spans, i, some, to, *trace);
    }
    to += found;
  }
  spans.size = to;
  counters.rows += to - had;
  counters.divides_row +=
      lengths * (static_cast<std::uint64_t>(divides_of(stage)) + divides_of_row(stages.channels));
  counters.divides_edge += (to - had) * static_cast<std::uint64_t>(walk.divides_per_row);
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
