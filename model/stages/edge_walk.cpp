#include "model/stages/edge_walk.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

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

// First row whose centre is at or below y; last row whose centre is at or above it.
std::int64_t first_row(Exact y) { return static_cast<std::int64_t>(ceil_of(y - Exact{1, 1})); }
std::int64_t last_row(Exact y) { return static_cast<std::int64_t>(floor_of(y - Exact{1, 1})); }

Exact coordinate(const EdgeWalkStage& stage, std::int64_t raw) { return {raw, stage.subpixel_bits}; }

// y + 1/2 - y1e of the row the walk stands on.
Exact rows_from_start(const EdgeWalkStage& stage, const EdgeState& e, std::int64_t y) {
  return Exact{2 * int128{y} + 1, 1} - coordinate(stage, e.start.y);
}

template <class Watch>
void set_dda_x(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  e.x_acc =
      quantize(coordinate(stage, e.start.x) +
                   value_of(e.edge.x_step, stage.x_step) * rows_from_start(stage, e, y) + stage.x_offset,
               stage.x_acc, watch);
}

// x1 + (x2 - x1) t / dy as floor and rest on the walk's grid, and the same of one row's step.
void start_exact_x(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y) {
  const Exact t = rows_from_start(stage, e, y);
  const int128 dx = int128{e.end.x} - e.start.x;
  const int128 dy = int128{e.end.y} - e.start.y;
  // Both numerators over dy, on 2^-(t.fraction): the vertices' grid and a half.
  const int128 at = on_grid(coordinate(stage, e.start.x), t.fraction) * dy + dx * t.raw;
  const int128 step = dx << t.fraction;
  const int up = stage.x_fraction - t.fraction;
  e.x_length = up < 0 ? dy << -up : dy;
  const auto place = floor_divide(up > 0 ? at << up : at, e.x_length);
  const auto move = floor_divide(up > 0 ? step << up : step, e.x_length);
  e.x_floor = place.floor;
  e.x_rest = place.rest;
  e.x_step_floor = move.floor;
  e.x_step_rest = move.rest;
}

template <class Watch>
void start_edge(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  const Exact t = rows_from_start(stage, e, y);
  if (stage.walk == EdgeWalk::exact) {
    start_exact_x(stage, e, y);
  } else {
    set_dda_x(stage, e, y, watch);
  }
  e.h_acc = quantize(
      value_of(e.start.h, stage.vertex_h) + value_of(e.edge.h_step, stage.h_step) * t + stage.h_offset,
      stage.h_acc, watch);
  const auto numerator = [&](std::int64_t texel, std::int64_t step) {
    Exact f = value_of(step, stage.f_step) * t + stage.f_offset;
    if (stage.affine) {
      f = f + value_of(texel, stage.vertex_uv);
    }
    return quantize(f, stage.f, watch);
  };
  e.fu = numerator(e.start.u, e.edge.fu_step);
  e.fv = numerator(e.start.v, e.edge.fv_step);
  const std::array steps{e.edge.r_step, e.edge.g_step, e.edge.b_step, e.edge.a_step};
  for (std::size_t c = 0; c < steps.size(); ++c) {
    e.shade_acc[c] = quantize(value_of(e.start.c[c], stage.vertex_shade) +
                                  value_of(steps[c], stage.shade_step) * t + stage.shade_offset,
                              stage.shade_acc, watch);
  }
  e.started = true;
}

template <class Watch>
void step_edge(const EdgeWalkStage& stage, EdgeState& e, std::int64_t y, Watch watch) {
  const auto advance = [&](std::int64_t& acc, const Register& r, std::int64_t step, const Register& step_r) {
    acc = quantize(value_of(acc, r) + value_of(step, step_r), r, watch);
  };
  if (stage.walk == EdgeWalk::exact) {
    e.x_floor += e.x_step_floor;
    e.x_rest += e.x_step_rest;
    if (e.x_rest >= e.x_length) {
      e.x_rest -= e.x_length;
      ++e.x_floor;
    }
  } else if (stage.update == DdaUpdate::accumulate) {
    advance(e.x_acc, stage.x_acc, e.edge.x_step, stage.x_step);
  } else {
    set_dda_x(stage, e, y, watch);
  }
  advance(e.h_acc, stage.h_acc, e.edge.h_step, stage.h_step);
  advance(e.fu, stage.f, e.edge.fu_step, stage.f_step);
  advance(e.fv, stage.f, e.edge.fv_step, stage.f_step);
  const std::array steps{e.edge.r_step, e.edge.g_step, e.edge.b_step, e.edge.a_step};
  for (std::size_t c = 0; c < steps.size(); ++c) {
    advance(e.shade_acc[c], stage.shade_acc, steps[c], stage.shade_step);
  }
}

// X on a grid, and whether X is above that by less than the grid.
struct Position {
  Exact floor;
  bool more;
};
Position position(const EdgeWalkStage& stage, const EdgeState& e) {
  return stage.walk == EdgeWalk::exact ? Position{{e.x_floor, stage.x_fraction}, e.x_rest != 0}
                                       : Position{value_of(e.x_acc, stage.x_acc), false};
}

// ceil(X - 1/2), floor(X - 1/2): the first centre at or right of X, the last at or left of it.
std::int64_t first_centre(Position x) {
  const Exact at = x.floor - Exact{1, 1};
  return static_cast<std::int64_t>(x.more ? floor_of(at) + 1 : ceil_of(at));
}
std::int64_t last_centre(Position x) { return static_cast<std::int64_t>(floor_of(x.floor - Exact{1, 1})); }

template <class Watch>
RowEnd make_end(const EdgeWalkStage& stage, const EdgeState& e, Watch watch) {
  RowEnd out{};
  out.edge = e.edge.edge;
  if (stage.walk == EdgeWalk::exact) {
    // The lowest bit of x_floor is a guard bit at most, so a rest is one more sticky bit below it.
    out.x = quantize((e.x_floor << 1) | (e.x_rest != 0 ? 1 : 0), stage.x_fraction + 1, stage.x, watch);
  } else {
    out.x_acc = e.x_acc;
    out.x = quantize(value_of(e.x_acc, stage.x_acc), stage.x, watch);
  }
  out.h_acc = e.h_acc;
  out.h = quantize(value_of(e.h_acc, stage.h_acc), stage.h, watch);
  out.fu = e.fu;
  out.fv = e.fv;
  if (stage.affine) {
    out.u = quantize(value_of(e.fu, stage.f), stage.uv, watch);
    out.v = quantize(value_of(e.fv, stage.f), stage.uv, watch);
  } else {
    const Inverse inverse = stage.reciprocal(value_of(out.h, stage.h) + stage.b, watch);
    const Exact r = stage.reciprocal.value(inverse);
    out.recip_m = inverse.m;
    out.recip_e = inverse.e;
    out.u = quantize(value_of(e.start.u, stage.vertex_uv) + value_of(e.fu, stage.f) * r, stage.uv, watch);
    out.v = quantize(value_of(e.start.v, stage.vertex_uv) + value_of(e.fv, stage.f) * r, stage.uv, watch);
  }
  out.shade_acc = e.shade_acc;
  for (std::size_t c = 0; c < out.shade.size(); ++c) {
    out.shade[c] = quantize(value_of(e.shade_acc[c], stage.shade_acc), stage.shade, watch);
  }
  return out;
}

}  // namespace

EdgeWalkStage prepare_edge_walk(const Config& config, const Constants& constants, int width, int height) {
  EdgeWalkStage s;
  s.width = width;
  s.height = height;
  s.fill_rule = config.fill_rule;
  s.walk = config.edge_walk;
  s.update = config.dda_update;
  s.affine = config.perspective == Perspective::affine;
  s.subpixel_bits = config.subpixel_bits;
  s.x_fraction = std::max(1, config.format(FormatId::edge_x).fraction() + 1);
  s.b = b_of(config, constants.record);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.x_offset = offset_value(config.start_offset.edge_x, config.format(FormatId::edge_x));
  s.h_offset = offset_value(config.start_offset.edge_h, config.format(FormatId::edge_h));
  s.f_offset = offset_value(config.start_offset.edge_f, config.format(FormatId::edge_f));
  s.shade_offset = offset_value(config.start_offset.edge_shade, config.format(FormatId::edge_shade));
  s.vertex_h = make_register(config, FormatId::setup_h);
  s.vertex_uv = make_register(config, FormatId::setup_uv);
  s.vertex_shade = make_register(config, FormatId::setup_shade);
  s.x_step = make_register(config, FormatId::edge_x_step);
  s.x_acc = make_register(config, FormatId::edge_x_acc);
  s.x = make_register(config, FormatId::edge_x);
  s.h_step = make_register(config, FormatId::edge_h_step);
  s.h_acc = make_register(config, FormatId::edge_h_acc);
  s.h = make_register(config, FormatId::edge_h);
  s.f_step = make_register(config, FormatId::edge_f_step);
  s.f = make_register(config, FormatId::edge_f);
  s.uv = make_register(config, FormatId::edge_uv);
  s.shade_step = make_register(config, FormatId::edge_shade_step);
  s.shade_acc = make_register(config, FormatId::edge_shade_acc);
  s.shade = make_register(config, FormatId::edge_shade);
  s.divides_per_row = s.affine ? 0 : 2;
  return s;
}

EdgeWalkState start_edge_walk(const EdgeWalkStage& stage, const SetupRecord& setup, const Edges& edges) {
  constexpr std::array<std::array<int, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
  EdgeWalkState s;
  s.triangle = setup.triangle;
  s.mid_right = setup.mid_right != 0;
  const Exact top = coordinate(stage, setup.y0);
  const Exact bottom = coordinate(stage, setup.y2);
  s.y = std::max<std::int64_t>(0, first_row(top));
  s.y_end = std::min<std::int64_t>(
      stage.height, stage.fill_rule == FillRule::inclusive ? last_row(bottom) + 1 : first_row(bottom));
  s.y_second = first_row(coordinate(stage, setup.y1));
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

template <class Watch>
bool edge_walk(const EdgeWalkStage& stage, EdgeWalkState& state, RowRecord& out, Watch watch) {
  const std::int64_t y = state.y++;
  EdgeState& whole = state.edges[0];
  EdgeState& half = y >= state.y_second && state.edges[2].present ? state.edges[2] : state.edges[1];
  for (EdgeState* e : {&whole, &half}) {
    if (e->started) {
      step_edge(stage, *e, y, watch);
    } else {
      start_edge(stage, *e, y, watch);
    }
  }
  const EdgeState& left = state.mid_right ? whole : half;
  const EdgeState& right = state.mid_right ? half : whole;
  const Position x_right = position(stage, right);
  const std::int64_t first = std::max<std::int64_t>(0, first_centre(position(stage, left)));
  const std::int64_t last = std::min<std::int64_t>(stage.width - 1, stage.fill_rule == FillRule::inclusive
                                                                        ? last_centre(x_right)
                                                                        : first_centre(x_right) - 1);
  if (first > last) {
    return false;
  }
  out.triangle = state.triangle;
  out.y = y;
  out.x_first = first;
  out.x_last = last;
  put_row_end(out, Side::left, make_end(stage, left, watch));
  put_row_end(out, Side::right, make_end(stage, right, watch));
  return true;
}

RowEnd row_end(const RowRecord& row, Side side) {
  RowEnd end;
  std::memcpy(&end, reinterpret_cast<const char*>(&row) + side_offset(side), sizeof end);
  return end;
}

template bool edge_walk(const EdgeWalkStage&, EdgeWalkState&, RowRecord&, NoObserve);
template bool edge_walk(const EdgeWalkStage&, EdgeWalkState&, RowRecord&, Observe);

}  // namespace bitspan::model
