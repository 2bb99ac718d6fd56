#include "model/simd/triangles.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/simd/triangles.cpp"
#include "hwy/foreach_target.h"
#include "model/numeric/ramp-inl.hpp"
#include "model/stages/edge_walk-inl.hpp"
#include "model/stages/setup-inl.hpp"
#include "model/stages/span_setup-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

constexpr std::size_t lane_count = Lanes::count;

// ---------------------------------------------------------------- observers

// Watch: NoObserve, or Plain where every register is.
template <class Watch>
struct Unwatched {
  static constexpr bool enabled = false;
  HWY_INLINE Watch on(Lanes::Mask /*active*/) const { return {}; }
};
struct Watched {
  static constexpr bool enabled = true;
  LaneStatistics* lanes;
  Statistics* statistics;
  HWY_INLINE ObserveLanes on(Lanes::Mask active) const { return {lanes, active}; }
};

// ---------------------------------------------------------------- stages

struct Stages {
  const SetupStage& setup;
  const EdgeWalkStage& walk;
  const SpanSetupStage& span;
};

// Whether every register that setup, edge_walk and span_setup quantise into rounds by adding a constant, and
// saturates.
bool all_plain(const Pipeline& pipeline) {
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
      &c.h_step.r,
      &c.f_step.r,
      &c.shade_step.r,
      &c.f_diff.r,
      &c.h_start.r,
      &c.f_start.r,
      &c.shade_start.r,
  };
  // What Plain shifts a unit's result by.
  const auto shifts = [](const ReciprocalUnit& unit) {
    const Reciprocal& r = unit.config();
    return std::max(r.table_bits, r.internal_bits) - unit.output().fraction <= 62;
  };
  if (!shifts(a.dy.unit) || !shifts(b.reciprocal) || !shifts(c.length.unit)) return false;
  return std::all_of(std::begin(registers), std::end(registers),
                     [](const Register* r) { return is_plain(*r); });
}

// ---------------------------------------------------------------- columns of row ends

constexpr std::size_t accumulators = 7;  // h, fu, fv, r, g, b, a
template <class R>
using Member = std::int64_t R::*;

struct SideColumns {
  Member<RowRecord> edge, x_acc, x, h, recip_m, recip_e, u, v;
  std::array<Member<RowRecord>, accumulators> acc;
  std::array<Member<RowRecord>, 4> shade;
  Member<RowSource> x0, x1, x2, u1, v1;
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
    &RowSource::l_v1};
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
    &RowSource::r_v1};

// ---------------------------------------------------------------- triangles to edges

// One of the three edges of each triangle of a group, as it stands on its first row.
struct EdgeGroup {
  static constexpr std::size_t sequences = accumulators + 1;  // the last one: x
  static constexpr std::size_t constants = 4;                 // u1, v1 and two of x
  HWY_ALIGN std::int64_t start[sequences][lane_count];
  HWY_ALIGN std::int64_t step[sequences][lane_count];
  HWY_ALIGN std::int64_t increment[sequences][lane_count];
  HWY_ALIGN std::int64_t walked[lane_count];  // bit i: sequence i is no ramp
  HWY_ALIGN std::int64_t constant[constants][lane_count];
  HWY_ALIGN std::int64_t first[lane_count];  // rows of the triangle: first, and one past the last
  HWY_ALIGN std::int64_t end[lane_count];
};
struct TriangleGroup {
  std::array<EdgeGroup, 3> edges;
  std::int64_t index[lane_count];           // of the input
  HWY_ALIGN std::int64_t y[lane_count];     // first row
  HWY_ALIGN std::int64_t skip[lane_count];  // rows before the first that is wanted
  HWY_ALIGN std::int64_t rows[lane_count];  // up to the last that is wanted; 0 where nothing is drawn
  HWY_ALIGN std::int64_t mid_right[lane_count];
};

// What walks a sequence; null where it is an exact ramp.
using Adders = std::array<const Adder*, EdgeGroup::sequences>;
Adders adders_of(const EdgeWalkStage& stage) {
  const auto x_adder = [&]() -> const Adder* {
    switch (stage.edge_x) {
      case EdgeX::summed:
        return &stage.x_acc;
      case EdgeX::quotient:
      case EdgeX::multiplied:
        return nullptr;
    }
    unreachable();
  };
  return {&stage.h_acc,     &stage.f,         &stage.f,         &stage.shade_acc,
          &stage.shade_acc, &stage.shade_acc, &stage.shade_acc, x_adder()};
}

HWY_INLINE const Triangle& triangle_at(const TriangleRows& from, std::size_t i) {
  return from.triangles[from.which[i] & ~TriangleRows::counted];
}
// Triangles `first` and up of the selection, n of them.
HWY_INLINE std::array<RealVertex<Doubles>, 3> load_vertices(const TriangleRows& from, std::size_t first,
                                                            std::size_t n) {
  constexpr std::size_t fields = 9;
  constexpr std::size_t line = 64;
  // The group after the next one.
  const std::size_t ahead = first + 2 * lane_count;
  for (std::size_t i = ahead; i < std::min(ahead + lane_count, from.which.size()); ++i) {
    const auto* const bytes = reinterpret_cast<const char*>(&triangle_at(from, i));
    for (std::size_t at = 0; at < sizeof(Triangle); at += line) __builtin_prefetch(bytes + at);
  }
  HWY_ALIGN double columns[3][fields][lane_count];
  for (std::size_t i = 0; i < lane_count; ++i) {
    const Triangle& t = triangle_at(from, first + std::min(i, n - 1));
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& v = t.v[k];
      columns[k][0][i] = v.x;
      columns[k][1][i] = v.y;
      columns[k][2][i] = v.s;
      columns[k][3][i] = v.u;
      columns[k][4][i] = v.v;
      for (std::size_t c = 0; c < 4; ++c) columns[k][5 + c][i] = v.c[c];
    }
  }
  const hn::ScalableTag<double> d;
  std::array<RealVertex<Doubles>, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = [&](std::size_t f) HWY_ATTR { return hn::Load(d, columns[k][f]); };
    out[k] = {at(0), at(1), at(2), at(3), at(4), {at(5), at(6), at(7), at(8)}};
  }
  return out;
}

void trace_setup(const std::array<VertexOf<Lanes>, 3>& v, Lanes::Mask active, Lanes mid_right,
                 const std::int64_t* index, Trace& trace) {
  const Lanes drawn = one_where(active);
  for (std::size_t i = 0; i < lane_count; ++i) {
    if (lane(drawn, i) == 0) continue;
    SetupRecord r;
    r.triangle = index[i];
    r.mid_right = lane(mid_right, i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& c = v[k].c;
      put_vertex(r, static_cast<int>(k),
                 {lane(v[k].x, i),
                  lane(v[k].y, i),
                  lane(v[k].h, i),
                  lane(v[k].u, i),
                  lane(v[k].v, i),
                  {lane(c[0], i), lane(c[1], i), lane(c[2], i), lane(c[3], i)}});
    }
    trace.setup.push_back(r);
  }
}

void trace_edges(const std::array<EdgeOf<Lanes>, 3>& edges, const std::array<Lanes::Mask, 3>& has,
                 const std::int64_t* index, Trace& trace) {
  for (std::size_t i = 0; i < lane_count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (lane(one_where(has[k]), i) == 0) continue;
      const EdgeOf<Lanes>& e = edges[k];
      EdgeRecord r;
      r.triangle = index[i];
      r.edge = static_cast<std::int64_t>(k);
      r.recip_m = lane(e.recip_m, i);
      r.recip_e = lane(e.recip_e, i);
      r.x_step = lane(e.x_step, i);
      r.h_step = lane(e.h_step, i);
      r.fu_diff = lane(e.fu_diff, i);
      r.fv_diff = lane(e.fv_diff, i);
      r.fu_step = lane(e.fu_step, i);
      r.fv_step = lane(e.fv_step, i);
      for (std::size_t c = 0; c < channel_count; ++c) r.*edge_steps[c] = lane(e.shade_step[c], i);
      trace.edge.push_back(r);
    }
  }
}

template <class Observer>
HWY_INLINE void start_edges(const EdgeWalkStage& stage, const Adders& adders, const VertexOf<Lanes>& from,
                            const VertexOf<Lanes>& to, const EdgeOf<Lanes>& edge, Lanes y, Lanes count,
                            EdgeGroup& out, const Observer& observer) {
  const auto used = count > Lanes(0);
  const auto watch = observer.on(used);
  const Lanes t = select(used, rows_from(stage, y, from.y), Lanes(0));
  const auto acc =
      start_accumulators(stage, from, edge.h_step, edge.fu_step, edge.fv_step, edge.shade_step, t, watch);
  const Lanes steps = max(count - Lanes(1), Lanes(0));
  const int steps_bits = bit_length(static_cast<std::uint64_t>(stage.height));
  Lanes walked(0);
  const auto put = [&](std::size_t i, Lanes start, Lanes step) HWY_ATTR {
    start.store(out.start[i]);
    step.store(out.step[i]);
    const RampLanes ramp = make_ramp(*adders[i], start, step, steps, steps_bits);
    ramp.increment.store(out.increment[i]);
    walked = walked | select(ramp.linear, Lanes(0), Lanes(std::int64_t{1} << i));
  };
  put(0, acc.h, edge.h_step);
  put(1, acc.fu, edge.fu_step);
  put(2, acc.fv, edge.fv_step);
  for (std::size_t c = 0; c < channel_count; ++c) put(3 + c, acc.shade[c], edge.shade_step[c]);
  Lanes x1(0);
  Lanes x2(0);
  switch (stage.edge_x) {
    case EdgeX::quotient: {
      const ExactX<Lanes> x = exact_x<Lanes>(stage, from, to, t);
      x.at.store(out.start[accumulators]);
      x.step.store(out.increment[accumulators]);
      x1 = max(x.length, Lanes(1));
      break;
    }
    case EdgeX::summed:
      put(accumulators, line_at(stage.x_start, from.x, edge.x_step, t, watch), edge.x_step);
      break;
    case EdgeX::multiplied:
      from.x.store(out.start[accumulators]);
      Lanes(0).store(out.increment[accumulators]);
      x1 = edge.x_step;
      x2 = from.y;
      break;
  }
  walked.store(out.walked);
  from.u.store(out.constant[0]);
  from.v.store(out.constant[1]);
  x1.store(out.constant[2]);
  x2.store(out.constant[3]);
}

// Setup of up to a vector of triangles: `first` and up of the selection, n of them.
template <class Observer>
HWY_INLINE void set_up(const Stages& stages, const Adders& adders, const TriangleRows& from,
                       std::size_t first, std::size_t n, TriangleGroup& out, Counters& counters, Trace* trace,
                       const Observer& observer) {
  const SetupStage& setup = stages.setup;
  const EdgeWalkStage& walk = stages.walk;
  const auto given = first_lanes<std::int64_t>(n);
  const std::array<RealVertex<Doubles>, 3> in = load_vertices(from, first, n);
  HWY_ALIGN std::int64_t own[lane_count] = {};
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t which = from.which[first + i];
    out.index[i] = from.first_index + static_cast<std::int64_t>(which & ~TriangleRows::counted);
    own[i] = (which & TriangleRows::counted) == 0 ? 1 : 0;
  }
  const auto counts = Lanes::load(own) > Lanes(0);
  // Out of line: the compiler has three times the text to look at otherwise, and clears v first.
  const auto vertex = [&](std::size_t k) HWY_ATTR __attribute__((noinline)) {
    return setup_vertex<Lanes>(setup, in[k], observer.on(given));
  };
  std::array<VertexOf<Lanes>, 3> v{vertex(0), vertex(1), vertex(2)};
  sort_vertices(v);
  const Turn<Lanes> area = turn(setup, v);
  const auto active = given & !area.none;
  const Lanes mid_right = one_where(area.positive);
  mid_right.store(out.mid_right);
  counters.triangles += set_in(counts);
  counters.degenerate += set_in(counts & given & area.none);

  const Lanes y = max(first_row(walk, v[0].y), Lanes(0));
  const Lanes end = min(end_row(walk, v[2].y), Lanes(walk.height));
  const Lanes rows = select(active, max(end - y, Lanes(0)), Lanes(0));
  y.store(out.y);
  max(Lanes(from.first_row) - y, Lanes(0)).store(out.skip);
  min(rows, Lanes(from.end_row) - y).store(out.rows);
  // Where edge 2 takes over from edge 1.
  const Lanes second = select(v[2].y > v[1].y, min(max(first_row(walk, v[1].y) - y, Lanes(0)), rows), rows);

  constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
  const std::array<Lanes, 3> firsts{Lanes(0), Lanes(0), second};
  const std::array<Lanes, 3> lasts{rows, second, rows};
  std::array<EdgeOf<Lanes>, 3> edges;
  std::array<Lanes::Mask, 3> has;
  for (std::size_t k = 0; k < 3; ++k) {
    const VertexOf<Lanes>& a = v[ends[k][0]];
    const VertexOf<Lanes>& b = v[ends[k][1]];
    const Lanes height = b.y - a.y;
    has[k] = active & (height > Lanes(0));
    edges[k] = setup_edge(setup, a, b, max(height, Lanes(1)), observer.on(has[k]));
    counters.divides_edge += set_in(has[k] & counts) * static_cast<std::uint64_t>(setup.divides_per_edge);
    firsts[k].store(out.edges[k].first);
    lasts[k].store(out.edges[k].end);
    start_edges(walk, adders, a, b, edges[k], y + firsts[k], lasts[k] - firsts[k], out.edges[k], observer);
  }
  if (trace != nullptr) {
    trace_setup(v, active, mid_right, out.index, *trace);
    trace_edges(edges, has, out.index, *trace);
  }
}

// ---------------------------------------------------------------- edges to rows

// Where the rows of a batch go: the columns of both ends.
struct RowColumns {
  struct Side {
    std::array<std::int64_t*, EdgeGroup::sequences> sequence;
    std::array<std::int64_t*, EdgeGroup::constants> constant;  // null where nobody reads it
    std::int64_t* edge;
  };
  std::int64_t* triangle;
  std::int64_t* y;
  Side left, right;
};
RowColumns row_columns(const EdgeWalkStage& stage, TriangleBatch& batch, bool trace) {
  const auto side_of = [&](const SideColumns& c) {
    RowColumns::Side side;
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
    for (std::size_t s = 0; s < EdgeGroup::sequences; ++s) {
      (Lanes(e.start[s][j]) + Lanes(e.increment[s][j]) * iota).store(side.sequence[s] + to);
    }
  } else {
    for (std::size_t s = 0; s < EdgeGroup::sequences; ++s) {
      if ((e.walked[j] >> s & 1) == 0) {
        store_ramp(side.sequence[s] + to, e.start[s][j] + first * e.increment[s][j], e.increment[s][j], n);
      } else {
        walk(*adders[s], e, s, j, first, n, side.sequence[s] + to, observer);
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
  for (std::size_t s = 0; s < EdgeGroup::sequences; ++s) {
    if ((e.walked[j] >> s & 1) == 0) continue;
    for (std::int64_t i = 1; i < first; ++i) {
      e.start[s][j] = next_row(*adders[s], e.start[s][j], e.step[s][j], observer);
    }
  }
}

void note_ramps(const Adders& adders, const EdgeGroup& e, std::size_t j, Statistics& statistics) {
  for (std::size_t s = 0; s < adders.size(); ++s) {
    if (adders[s] != nullptr && (e.walked[j] >> s & 1) == 0) {
      note_ramp(*adders[s], e.start[s][j], e.step[s][j], e.increment[s][j], e.end[j] - e.first[j] - 1,
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

// ---------------------------------------------------------------- rows to spans

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
// Of the lanes in `some`: their rows from i on, their spans from `to` on.
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
  for (const RowColumns::Side* side : {&columns.left, &columns.right}) {
    for (std::int64_t* sequence : side->sequence) pad(sequence, n);
    for (std::int64_t* constant : side->constant) {
      if (constant != nullptr) pad(constant, n);
    }
  }
  if (spans.size + n > spans.capacity()) spans.reserve(std::max(2 * spans.capacity(), spans.size + n));
  const std::size_t had = spans.size;
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
  counters.divides_row += lengths * static_cast<std::uint64_t>(divides_of(stage));
  counters.divides_edge += (to - had) * static_cast<std::uint64_t>(walk.divides_per_row);
}

// ---------------------------------------------------------------- the kernels

template <class Observer>
HWY_NOINLINE std::size_t in_lanes(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                                  Columns<SpanRecord>& spans, Counters& counters, Trace* trace,
                                  const Observer& observer) {
  const SetupStage setup = pipeline.setup;  // copies: no store can change them
  const EdgeWalkStage walk = pipeline.edge_walk;
  const Stages stages{setup, walk, pipeline.span_setup};
  const Adders adders = adders_of(walk);
  const RowColumns columns = row_columns(walk, batch, trace != nullptr);
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

void append(Columns<SpanRecord>& spans, const SpanRecord& span) {
  if (spans.size == spans.capacity()) spans.reserve(2 * spans.size + 1);
  const auto raw = raw_values(span);
  for (std::size_t f = 0; f < raw.size(); ++f) {
    spans[std::bit_cast<Member<SpanRecord>>(f * sizeof(std::int64_t))][spans.size] = raw[f];
  }
  ++spans.size;
}

// The scalar stages, where lanes have no room.
template <class Watch>
std::size_t one_by_one(const Pipeline& pipeline, const TriangleRows& from, Columns<SpanRecord>& spans,
                       Counters& counters, Trace* trace, Watch watch) {
  Rows rows;
  PlaneWalkState walk;
  Counters elsewhere;
  std::size_t at = 0;
  for (const std::size_t had = spans.size;
       at < from.which.size() && spans.size - had < TriangleBatch::row_capacity; ++at) {
    const bool counted = (from.which[at] & TriangleRows::counted) != 0;
    const std::int64_t index = from.first_index + (from.which[at] & ~TriangleRows::counted);
    rows.clear();
    triangle_to_rows(pipeline, triangle_at(from, at), index, walk, rows, counted ? elsewhere : counters,
                     trace, watch);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::int64_t y = rows.rows[i].y;
      if (y < from.first_row || y >= from.end_row) continue;
      const SpanRecord span = row_to_span(pipeline, rows, i, counters, watch);
      append(spans, span);
      if (trace != nullptr) trace->span.push_back(span);
    }
  }
  return at;
}

std::size_t to_spans(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                     Columns<SpanRecord>& spans, Counters& counters, Trace* trace) {
  if (!triangles_in_lanes(pipeline)) return one_by_one(pipeline, from, spans, counters, trace, NoObserve{});
  return all_plain(pipeline)
             ? in_lanes(pipeline, from, batch, spans, counters, trace, Unwatched<Plain>{})
             : in_lanes(pipeline, from, batch, spans, counters, trace, Unwatched<NoObserve>{});
}

std::size_t to_spans_observed(const Pipeline& pipeline, const TriangleRows& from, TriangleBatch& batch,
                              Columns<SpanRecord>& spans, Counters& counters, Trace* trace,
                              Statistics& statistics) {
  if (!triangles_in_lanes(pipeline)) {
    return one_by_one(pipeline, from, spans, counters, trace, Observe{&statistics});
  }
  LaneStatistics lanes;
  const std::size_t done =
      in_lanes(pipeline, from, batch, spans, counters, trace, Watched{&lanes, &statistics});
  lanes.fold(statistics);
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
