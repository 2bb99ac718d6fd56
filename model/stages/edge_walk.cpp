// SPDX-License-Identifier: Apache-2.0
#include "model/stages/edge_walk.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "config/modes.hpp"
#include "model/stages/edge_walk-inl.hpp"

namespace bitspan::model {
namespace {

// The ends of a record are two runs of fields in RowEnd's order.
static_assert(sizeof(RowRecord) == 4 * sizeof(std::int64_t) + 2 * sizeof(RowEnd));
static_assert(offsetof(RowRecord, r_edge) == offsetof(RowRecord, l_edge) + sizeof(RowEnd));
static_assert(offsetof(RowRecord, l_a) + sizeof(std::int64_t) == offsetof(RowRecord, r_edge));
static_assert(offsetof(RowRecord, l_u) - offsetof(RowRecord, l_edge) == offsetof(RowEnd, u));
static_assert(offsetof(RowRecord, l_r) - offsetof(RowRecord, l_edge) == offsetof(RowEnd, shade));

constexpr std::size_t side_offset(Side side) {
  return side == Side::left ? offsetof(RowRecord, l_edge) : offsetof(RowRecord, r_edge);
}

void put_row_end(RowRecord& row, Side side, const RowEnd& end) {
  std::memcpy(reinterpret_cast<char*>(&row) + side_offset(side), &end, sizeof end);
}

using HWY_NAMESPACE::Position;

// y + 1/2 - y1e of the row the walk stands on.
std::int64_t rows_from_start(const EdgeWalkStage& stage, const EdgeState& e, std::int64_t y) {
  return HWY_NAMESPACE::rows_from(stage, y, e.start.y);
}

template <class Watch>
void set_dda_x(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  e.x_acc =
      HWY_NAMESPACE::line_at(stage.x_start, e.start.x, e.edge.x_step, rows_from_start(stage, e, y), watch);
}

// Floor and rest of X and of one row's step.
template <class Int>
void start_exact_x(const EdgeWalkStage& stage, EdgeState& e, std::int64_t t) {
  const auto divide = [](Int n, Int d) {
    const Int floor = n / d - (n % d < 0 ? 1 : 0);
    return FloorQuotient{floor, n - floor * d};
  };
  const auto x = HWY_NAMESPACE::exact_x<Int>(stage, e.start, e.end, t);
  const FloorQuotient place = divide(x.at, x.length);
  const FloorQuotient move = divide(x.step, x.length);
  e.x_length = x.length;
  e.x_floor = place.floor;
  e.x_rest = place.rest;
  e.x_step_floor = move.floor;
  e.x_step_rest = move.rest;
}

template <class Watch>
void start_edge(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  const std::int64_t t = rows_from_start(stage, e, y);
  switch (stage.edge_x) {
    case EdgeX::quotient:
      stage.x_fits_int64 ? start_exact_x<std::int64_t>(stage, e, t) : start_exact_x<int128>(stage, e, t);
      break;
    case EdgeX::summed:
    case EdgeX::multiplied:
      set_dda_x(stage, e, y, watch);
      break;
  }
  e.started = true;
  if (stage.by_plane) return;
  const EdgeRecord& edge = e.edge;
  e.acc = HWY_NAMESPACE::start_accumulators(stage, e.start, edge.h_step, edge.fu_step, edge.fv_step,
                                            {edge.r_step, edge.g_step, edge.b_step, edge.a_step}, t, watch);
}

template <class Watch>
void step_edge(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  const auto advance = [&](std::int64_t& acc, const Adder& adder, std::int64_t step) {
    acc = HWY_NAMESPACE::stepped(adder, acc, step, watch);
  };
  switch (stage.edge_x) {
    case EdgeX::quotient:
      e.x_floor += e.x_step_floor;
      e.x_rest += e.x_step_rest;
      if (e.x_rest >= e.x_length) {
        e.x_rest -= e.x_length;
        ++e.x_floor;
      }
      break;
    case EdgeX::summed:
      advance(e.x_acc, stage.x_acc, e.edge.x_step);
      break;
    case EdgeX::multiplied:
      set_dda_x(stage, e, y, watch);
      break;
  }
  if (stage.by_plane) return;
  advance(e.acc.h, stage.h_acc, e.edge.h_step);
  advance(e.acc.fu, stage.f, e.edge.fu_step);
  advance(e.acc.fv, stage.f, e.edge.fv_step);
  const std::array steps{e.edge.r_step, e.edge.g_step, e.edge.b_step, e.edge.a_step};
  for (std::size_t c = 0; c < steps.size(); ++c) {
    advance(e.acc.shade[c], stage.shade_acc, steps[c]);
  }
}

Position<int128> position(const EdgeWalkStage& stage, const EdgeState& e) {
  switch (stage.edge_x) {
    case EdgeX::quotient:
      return {e.x_floor, e.x_rest != 0 ? 1 : 0};
    case EdgeX::summed:
    case EdgeX::multiplied:
      return {int128{e.x_acc} << stage.x_up, 0};
  }
  unreachable();
}

template <class Watch>
RowEnd make_end(const EdgeWalkStage& stage, const EdgeState& e, Watch watch) {
  RowEnd out{};
  out.edge = e.edge.edge;
  switch (stage.edge_x) {
    case EdgeX::quotient:
      out.x = HWY_NAMESPACE::exact_row_x<std::int64_t>(stage, position(stage, e), watch);
      break;
    case EdgeX::summed:
    case EdgeX::multiplied:
      out.x_acc = e.x_acc;
      out.x = HWY_NAMESPACE::narrowed<std::int64_t>(stage.x, e.x_acc, watch);
      break;
  }
  if (stage.by_plane) return out;
  const auto end = HWY_NAMESPACE::end_values(stage, e.acc, e.start.u, e.start.v, watch);
  out.h_acc = e.acc.h;
  out.h = end.h;
  out.fu = e.acc.fu;
  out.fv = e.acc.fv;
  out.recip_m = end.recip_m;
  out.recip_e = end.recip_e;
  out.u = end.u;
  out.v = end.v;
  out.shade_acc = e.acc.shade;
  out.shade = end.shade;
  return out;
}

}  // namespace

EdgeWalkStage prepare_edge_walk(const Config& config, const Constants& constants, int width, int height) {
  EdgeWalkStage s;
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  s.width = width;
  s.height = height;
  s.owns_every_edge = owns_every_edge(config.fill_rule);
  s.edge_x = edge_x_of(config);
  s.linear_edges = has_linear_edges(config.perspective);
  s.by_plane = has_setup_plane(config);
  s.subpixel_bits = config.subpixel_bits;
  s.t_fraction = std::max(1, config.subpixel_bits);
  const Register coordinate = make_register(config.coordinate_format());
  const Grid t = magnitude_of(coordinate) + Grid{bit_length(static_cast<std::uint64_t>(height)), 1};
  const Register x = reg(FormatId::edge_x);
  const Grid dx = magnitude_of(coordinate) + magnitude_of(coordinate);
  bool x_fits_lanes = true;
  switch (s.edge_x) {
    case EdgeX::quotient: {
      s.x_fraction = std::max(1, x.fraction + 1);
      s.x_up = s.x_fraction - s.t_fraction;
      // at, step and length, and a row past the edge's end.
      const Grid at = magnitude_of(coordinate) * dx + dx * t;
      s.x_fits_int64 = at.bits() + 1 + s.t_fraction + std::max(0, s.x_up) <= term_bits &&
                       dx.bits() + std::max(0, -s.x_up) <= term_bits;
      s.x = make_narrowing(x, {coordinate.word - s.subpixel_bits + 1, s.x_fraction + 1});
      x_fits_lanes = s.x_fits_int64 && s.x.fits;
      break;
    }
    case EdgeX::summed:
    case EdgeX::multiplied:
      s.x_acc = make_adder(reg(FormatId::edge_x_acc), reg(FormatId::edge_x_step));
      s.x_fraction = std::max(1, s.x_acc.acc.fraction);
      s.x_up = s.x_fraction - s.x_acc.acc.fraction;
      s.x_start = make_line(s.x_acc.acc, &coordinate, reg(FormatId::edge_x_step), t,
                            offset_value(config.start_offset.edge_x, config.format(FormatId::edge_x)));
      s.x = make_narrowing(x, magnitude_of(s.x_acc.acc));
      x_fits_lanes = s.x_start.fits_lanes && s.x.fits_lanes &&
                     aligned(magnitude_of(s.x_acc.acc), s.x_fraction).bits() <= term_bits;
      break;
  }
  // Of a line: what adds its steps up, where that starts, and what is kept of it.
  const auto walk = [&](LineId id, bool from_vertex, Adder& acc, Line& start, Narrowing& kept) {
    const bitspan::Line line = line_of(id, config.perspective);
    const Register vertex = reg(line.vertex);
    const Register step = reg(line.edge.step);
    acc = make_adder(reg(line.edge.acc), step);
    start = make_line(acc.acc, from_vertex ? &vertex : nullptr, step, t, offset_value(config, line.edge));
    kept = make_narrowing(reg(line.edge.kept), magnitude_of(acc.acc));
  };
  walk(LineId::h, true, s.h_acc, s.h_start, s.h);
  walk(LineId::fu, s.linear_edges, s.f, s.f_start, s.linear_uv);
  walk(LineId::r, true, s.shade_acc, s.shade_start, s.shade);
  s.depth = make_depth_sum(s.h.r, b_of(config, constants.record), config.pixel_reciprocal);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.uv = make_perspective_point(s.linear_uv.r, reg(FormatId::setup_uv), s.f.acc, s.reciprocal.output(),
                                s.depth.e);
  s.divides_per_row = s.by_plane || s.linear_edges ? 0 : 2;
  s.fits_lanes = x_fits_lanes && lanes_hold(t) && s.h_start.fits_lanes && s.f_start.fits_lanes &&
                 s.shade_start.fits_lanes && s.h.fits_lanes && s.shade.fits_lanes &&
                 (s.linear_edges ? s.linear_uv.fits_lanes : lanes_hold(s.depth.magnitude) && s.uv.fits_lanes);
  return s;
}

EdgeWalkState start_edge_walk(const EdgeWalkStage& stage, const SetupRecord& setup, const Edges& edges) {
  constexpr std::array<std::array<int, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
  EdgeWalkState s;
  s.triangle = setup.triangle;
  s.mid_right = setup.mid_right != 0;
  s.y = std::max<std::int64_t>(0, HWY_NAMESPACE::first_row(stage, setup.y0));
  s.y_end = std::min<std::int64_t>(stage.height, HWY_NAMESPACE::end_row(stage, setup.y2));
  s.y_second = HWY_NAMESPACE::first_row(stage, setup.y1);
  for (int i = 0; i < edges.count; ++i) {
    const EdgeRecord& record = edges.edge[static_cast<std::size_t>(i)];
    const auto n = static_cast<std::size_t>(record.edge);
    EdgeState& e = s.edges[n];
    e.edge = record;
    e.start = vertex_of(setup, ends[n][0]);
    e.end = vertex_of(setup, ends[n][1]);
    e.present = true;
  }
  return s;
}

namespace {

// Brings both edges of the next row to it, and returns the one that may end above the triangle's last row.
template <class Watch>
EdgeState& move_edges(const EdgeWalkStage& stage, EdgeWalkState& state, Watch watch) {
  const std::int64_t y = state.y++;
  EdgeState& half = y >= state.y_second && state.edges[2].present ? state.edges[2] : state.edges[1];
  for (EdgeState* e : {&state.edges[0], &half}) {
    if (e->started) {
      step_edge(stage, *e, y, watch);
    } else {
      start_edge(stage, *e, y, watch);
    }
  }
  return half;
}

}  // namespace

template <class Watch>
std::uint64_t pass_rows(const EdgeWalkStage& stage, EdgeWalkState& state, std::int64_t to, Watch watch) {
  const std::int64_t from = state.y;
  while (state.y < std::min(to, state.y_end)) move_edges(stage, state, watch);
  return static_cast<std::uint64_t>(state.y - from);
}

template <class Watch>
bool edge_walk(const EdgeWalkStage& stage, EdgeWalkState& state, RowRecord& out, Watch watch) {
  const std::int64_t y = state.y;
  EdgeState& half = move_edges(stage, state, watch);
  EdgeState& whole = state.edges[0];
  const EdgeState& left = state.mid_right ? whole : half;
  const EdgeState& right = state.mid_right ? half : whole;
  const auto pixels =
      HWY_NAMESPACE::pixels_between<std::int64_t>(stage, position(stage, left), position(stage, right));
  if (pixels.first > pixels.last) {
    return false;
  }
  out.triangle = state.triangle;
  out.y = y;
  out.x_first = pixels.first;
  out.x_last = pixels.last;
  put_row_end(out, Side::left, make_end(stage, left, watch));
  put_row_end(out, Side::right, make_end(stage, right, watch));
  return true;
}

RowEnd row_end(const RowRecord& row, Side side) {
  RowEnd end;
  std::memcpy(&end, reinterpret_cast<const char*>(&row) + side_offset(side), sizeof end);
  return end;
}

template std::uint64_t pass_rows(const EdgeWalkStage&, EdgeWalkState&, std::int64_t, NoObserve);
template std::uint64_t pass_rows(const EdgeWalkStage&, EdgeWalkState&, std::int64_t, Observe);
template bool edge_walk(const EdgeWalkStage&, EdgeWalkState&, RowRecord&, NoObserve);
template bool edge_walk(const EdgeWalkStage&, EdgeWalkState&, RowRecord&, Observe);

}  // namespace bitspan::model
