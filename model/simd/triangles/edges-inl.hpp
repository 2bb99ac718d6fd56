// SPDX-License-Identifier: Apache-2.0
// Triangles to edges: setup, slopes and the first row of every edge. The lanes are triangles.
#include <algorithm>
#include <array>
#include <cstring>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/numeric/ramp-inl.hpp"
#include "model/simd/triangles.hpp"
#include "model/stages/edge_walk-inl.hpp"
#include "model/stages/setup-inl.hpp"

#if defined(BITSPAN_MODEL_SIMD_TRIANGLES_EDGES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef BITSPAN_MODEL_SIMD_TRIANGLES_EDGES_INL
#undef BITSPAN_MODEL_SIMD_TRIANGLES_EDGES_INL
#else
#define BITSPAN_MODEL_SIMD_TRIANGLES_EDGES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace bitspan::model::HWY_NAMESPACE {
namespace {

constexpr std::size_t lane_count = Lanes::count;
constexpr std::size_t accumulators = 7;  // h, fu, fv, r, g, b, a

// Watch: NoObserve, or BranchFree where every register is.
template <class Watch>
struct Unwatched {
  static constexpr bool enabled = false;
  HWY_INLINE Watch on(Lanes::Mask /*active*/) const { return {}; }
};
struct Watched {
  static constexpr bool enabled = true;
  LaneStatistics* lane_statistics;
  Statistics* statistics;  // of the adders
  HWY_INLINE ObserveLanes on(Lanes::Mask active) const { return {lane_statistics, active}; }
};

struct Stages {
  const SetupStage& setup;
  const EdgeWalkStage& walk;
  const SpanSetupStage& span;
  const ChannelStage& channels;
};

// One of the three edges of each triangle of a group, as it stands on its first row.
struct EdgeGroup {
  static constexpr std::size_t sequences = accumulators + 1;  // the last one: x
  static constexpr std::size_t with_channels = sequences + channel_limit;
  static constexpr std::size_t constants = 4;  // u1, v1 and two of x
  HWY_ALIGN std::int64_t start[with_channels][lane_count];
  HWY_ALIGN std::int64_t step[with_channels][lane_count];
  HWY_ALIGN std::int64_t increment[with_channels][lane_count];
  HWY_ALIGN std::int64_t walked[lane_count];  // bit i: sequence i is no ramp
  HWY_ALIGN std::int64_t constant[constants][lane_count];
  HWY_ALIGN std::int64_t first[lane_count];  // rows of the triangle: first, and one past the last
  HWY_ALIGN std::int64_t end[lane_count];
};
struct TriangleGroup {
  std::array<EdgeGroup, 3> edges;
  std::int64_t index[lane_count];           // of the input
  HWY_ALIGN std::int64_t y[lane_count];     // first row
  HWY_ALIGN std::int64_t end[lane_count];   // behind the last row of the picture's; 0 without an area
  HWY_ALIGN std::int64_t skip[lane_count];  // rows before the first that is wanted
  HWY_ALIGN std::int64_t rows[lane_count];  // up to the last that is wanted; 0 where nothing is drawn
  HWY_ALIGN std::int64_t mid_right[lane_count];
};

// What walks the sequences in use; null where one is an exact ramp.
struct Adders {
  std::array<const Adder*, EdgeGroup::with_channels> of{};
  std::size_t used = EdgeGroup::sequences;
};
Adders adders_of(const EdgeWalkStage& stage, const ChannelStage& channels) {
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
  Adders adders{{&stage.h_acc, &stage.f, &stage.f, &stage.shade_acc, &stage.shade_acc, &stage.shade_acc,
                 &stage.shade_acc, x_adder()}};
  for (const ChannelForm& form : channels.in_use) adders.of[adders.used++] = &form.along_edge;
  return adders;
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

// The record of lane i.
SetupRecord setup_record(const std::array<VertexOf<Lanes>, 3>& v, std::int64_t triangle,
                         std::int64_t mid_right, std::size_t i) {
  SetupRecord r;
  r.triangle = triangle;
  r.mid_right = mid_right;
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
  return r;
}

void trace_setup(const std::array<VertexOf<Lanes>, 3>& v, Lanes::Mask active, Lanes mid_right,
                 const std::int64_t* index, Trace& trace) {
  const Lanes drawn = one_where(active);
  for (std::size_t i = 0; i < lane_count; ++i) {
    if (lane(drawn, i) != 0) trace.setup.push_back(setup_record(v, index[i], lane(mid_right, i), i));
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
    const RampLanes ramp = make_ramp(*adders.of[i], start, step, steps, steps_bits);
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

// The edges' channels, of the triangles that have rows. A triangle's are set up by the scalar stage.
HWY_NOINLINE void start_channels(const Stages& stages, const Adders& adders, const TriangleRows& from,
                                 std::size_t first, std::size_t n, const std::array<VertexOf<Lanes>, 3>& v,
                                 const std::array<EdgeOf<Lanes>, 3>& edges,
                                 const std::array<Lanes::Mask, 3>& has, TriangleGroup& out) {
  constexpr std::size_t at = EdgeGroup::sequences;
  const std::size_t in_use = stages.channels.in_use.size();
  for (EdgeGroup& e : out.edges) {
    std::memset(e.start[at], 0, in_use * sizeof e.start[0]);
    std::memset(e.step[at], 0, in_use * sizeof e.step[0]);
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (out.rows[j] <= out.skip[j]) continue;
    Edges of_triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (lane(one_where(has[k]), j) == 0) continue;
      EdgeRecord& e = of_triangle.edge[static_cast<std::size_t>(of_triangle.count++)];
      e.edge = static_cast<std::int64_t>(k);
      e.recip_m = lane(edges[k].recip_m, j);
      e.recip_e = lane(edges[k].recip_e, j);
    }
    const TriangleChannels made =
        setup_channels(stages.channels, triangle_at(from, first + j),
                       setup_record(v, out.index[j], out.mid_right[j], j), &of_triangle, nullptr);
    for (std::size_t k = 0; k < 3; ++k) {
      EdgeGroup& e = out.edges[k];
      if (e.first[j] >= e.end[j]) continue;
      const auto edge = static_cast<std::int64_t>(k);
      for (std::size_t c = 0; c < in_use; ++c) {
        e.start[at + c][j] = start_edge(stages.channels, made, c, edge).acc;
        e.step[at + c][j] = edge_step(made.record[c], edge);
      }
    }
  }
  const int steps_bits = bit_length(static_cast<std::uint64_t>(stages.walk.height));
  for (EdgeGroup& e : out.edges) {
    const Lanes steps = max(Lanes::load(e.end) - Lanes::load(e.first) - Lanes(1), Lanes(0));
    Lanes walked = Lanes::load(e.walked);
    for (std::size_t s = at; s < adders.used; ++s) {
      const RampLanes ramp =
          make_ramp(*adders.of[s], Lanes::load(e.start[s]), Lanes::load(e.step[s]), steps, steps_bits);
      ramp.increment.store(e.increment[s]);
      walked = walked | select(ramp.linear, Lanes(0), Lanes(std::int64_t{1} << s));
    }
    walked.store(e.walked);
  }
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
    own[i] = (which & TriangleRows::counted) == 0 && !from.again ? 1 : 0;
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
  select(active, end, Lanes(0)).store(out.end);
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
    counters.divides_edge += set_in(has[k] & counts) * divides_of_edge(stages.channels);
  }
  if (stages.channels.any()) start_channels(stages, adders, from, first, n, v, edges, has, out);
  if (trace != nullptr && !from.again) {
    trace_setup(v, active, mid_right, out.index, *trace);
    trace_edges(edges, has, out.index, *trace);
  }
}

}  // namespace
}  // namespace bitspan::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
