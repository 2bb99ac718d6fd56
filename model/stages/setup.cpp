// SPDX-License-Identifier: Apache-2.0
#include "model/stages/setup.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/stages/setup-inl.hpp"

namespace bitspan::model {
namespace {

using Member = std::int64_t SetupRecord::*;
constexpr int vertex_fields = 9;
constexpr std::array<std::array<Member, vertex_fields>, 3> vertex_members{{
    {&SetupRecord::x0, &SetupRecord::y0, &SetupRecord::h0, &SetupRecord::u0, &SetupRecord::v0,
     &SetupRecord::r0, &SetupRecord::g0, &SetupRecord::b0, &SetupRecord::a0},
    {&SetupRecord::x1, &SetupRecord::y1, &SetupRecord::h1, &SetupRecord::u1, &SetupRecord::v1,
     &SetupRecord::r1, &SetupRecord::g1, &SetupRecord::b1, &SetupRecord::a1},
    {&SetupRecord::x2, &SetupRecord::y2, &SetupRecord::h2, &SetupRecord::u2, &SetupRecord::v2,
     &SetupRecord::r2, &SetupRecord::g2, &SetupRecord::b2, &SetupRecord::a2},
}};

template <class Watch>
SetupVertex quantize_vertex(const SetupStage& stage, const Vertex& in, Watch watch) {
  return HWY_NAMESPACE::setup_vertex<std::int64_t>(
      stage, HWY_NAMESPACE::RealVertex<double>{in.x, in.y, in.s, in.u, in.v, in.c}, watch);
}

// The slope of an edge that has a position alone.
template <class Watch>
void put_x_step(const SetupStage& stage, const SetupVertex& a, const SetupVertex& b, EdgeRecord& out,
                Watch watch) {
  const auto dy = HWY_NAMESPACE::make_length<std::int64_t>(stage.dy, int128{b.y} - a.y, watch);
  out.recip_m = dy.inverse.m;
  out.recip_e = dy.inverse.e;
  out.x_step = HWY_NAMESPACE::slope<std::int64_t>(stage.x_step, stage.dy, int128{b.x} - a.x, dy, watch);
}

}  // namespace

SetupStage prepare_setup(const Config& config, const Constants& constants) {
  SetupStage s;
  const Exact b = b_of(config, constants.record);
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  s.exponent = constants.exponent;
  s.b = static_cast<std::int64_t>(b.raw);
  s.linear_edges = has_linear_edges(config.perspective);
  s.has_x_step = has_x_step(config);
  s.coordinate = make_register(config.coordinate_format(), RegisterId::coordinate);
  s.s = reg(FormatId::setup_s);
  s.s_max = value_of(constants.record.s_max, s.s);
  s.h = reg(FormatId::setup_h);
  s.uv = reg(FormatId::setup_uv);
  s.shade = reg(FormatId::setup_shade);
  s.h_scale = -b.fraction;  // s_max' - s' and s' are on one grid
  const Grid above = magnitude_of(s.s) + magnitude_of(s.s);
  s.h_fits_int64 = (magnitude_of(b) * above).bits() <= term_bits;
  const Grid dy = magnitude_of(s.coordinate) + magnitude_of(s.coordinate);
  s.area_fits_int64 = 2 * dy.bits() + 1 <= term_bits;
  s.depth = make_depth_sum(s.h, b, config.pixel_reciprocal);
  s.dy = make_length_form(config.edge_slope,
                          ReciprocalUnit(config.edge_reciprocal, RegisterId::edge_reciprocal), dy);
  const Grid uv = magnitude_of(s.uv) + magnitude_of(s.uv);
  s.x_step = make_slope(reg(FormatId::edge_x_step), dy, s.dy);
  s.h_step = make_slope(reg(FormatId::edge_h_step), magnitude_of(s.h) + magnitude_of(s.h), s.dy);
  s.f_diff = make_product(reg(FormatId::edge_f_diff), uv, s.linear_edges ? Grid{1, 0} : s.depth.magnitude);
  s.f_step = make_slope(reg(FormatId::edge_f_step), magnitude_of(s.f_diff.r), s.dy);
  s.shade_step =
      make_slope(reg(FormatId::edge_shade_step), magnitude_of(s.shade) + magnitude_of(s.shade), s.dy);
  s.fits_lanes = lanes_hold(dy) && lanes_hold(above) && lanes_hold(magnitude_of(b)) &&
                 (magnitude_of(b) * above).bits() <= 126 && s.h_step.fits_lanes && s.f_diff.fits_lanes &&
                 s.f_step.fits_lanes && s.shade_step.fits_lanes && (!s.has_x_step || s.x_step.fits_lanes);
  s.by_plane = has_setup_plane(config);
  const int slopes = (s.by_plane ? 0 : 7) + (s.has_x_step ? 1 : 0);
  s.divides_per_edge = shares_reciprocal(config.edge_slope) ? std::min(1, slopes) : slopes;
  return s;
}

SetupVertex vertex_of(const SetupRecord& record, int i) {
  const auto& m = vertex_members[static_cast<std::size_t>(i)];
  return {record.*m[0], record.*m[1], record.*m[2],
          record.*m[3], record.*m[4], {record.*m[5], record.*m[6], record.*m[7], record.*m[8]}};
}

void put_vertex(SetupRecord& record, int i, const SetupVertex& v) {
  const auto& m = vertex_members[static_cast<std::size_t>(i)];
  record.*m[0] = v.x;
  record.*m[1] = v.y;
  record.*m[2] = v.h;
  record.*m[3] = v.u;
  record.*m[4] = v.v;
  for (std::size_t c = 0; c < channel_count; ++c) {
    record.*m[5 + c] = v.c[c];
  }
}

template <class Watch>
bool setup(const SetupStage& stage, const Triangle& triangle, std::int64_t index, SetupRecord& out,
           Watch watch) {
  std::array<SetupVertex, 3> v;
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = quantize_vertex(stage, triangle.v[i], watch);
  }
  HWY_NAMESPACE::sort_vertices(v);
  const auto turn = HWY_NAMESPACE::turn(stage, v);
  if (turn.none && !triangle.is_line) {
    return false;
  }
  out.triangle = index;
  out.mid_right = turn.positive ? 1 : 0;
  for (std::size_t i = 0; i < 3; ++i) {
    put_vertex(out, static_cast<int>(i), v[i]);
  }
  return true;
}

template <class Watch>
Edges setup_edges(const SetupStage& stage, const SetupRecord& record, Watch watch) {
  constexpr std::array<std::array<int, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
  Edges edges;
  for (std::size_t i = 0; i < 3; ++i) {
    const SetupVertex a = vertex_of(record, ends[i][0]);
    const SetupVertex b = vertex_of(record, ends[i][1]);
    if (b.y <= a.y) {
      continue;
    }
    EdgeRecord& e = edges.edge[static_cast<std::size_t>(edges.count++)];
    e = {};
    e.triangle = record.triangle;
    e.edge = static_cast<std::int64_t>(i);
    if (stage.by_plane) {
      if (stage.has_x_step) put_x_step(stage, a, b, e, watch);
      continue;
    }
    const auto made = HWY_NAMESPACE::setup_edge(stage, a, b, int128{b.y} - a.y, watch);
    e.recip_m = made.recip_m;
    e.recip_e = made.recip_e;
    e.x_step = made.x_step;
    e.h_step = made.h_step;
    e.fu_diff = made.fu_diff;
    e.fv_diff = made.fv_diff;
    e.fu_step = made.fu_step;
    e.fv_step = made.fv_step;
    for (std::size_t c = 0; c < channel_count; ++c) {
      e.*edge_steps[c] = made.shade_step[c];
    }
  }
  return edges;
}

template bool setup(const SetupStage&, const Triangle&, std::int64_t, SetupRecord&, NoObserve);
template bool setup(const SetupStage&, const Triangle&, std::int64_t, SetupRecord&, Observe);
template Edges setup_edges(const SetupStage&, const SetupRecord&, NoObserve);
template Edges setup_edges(const SetupStage&, const SetupRecord&, Observe);

}  // namespace bitspan::model
