#include "model/stages/setup.hpp"

#include <algorithm>
#include <tuple>

#include "model/channels.hpp"
#include "model/numeric/from_double.hpp"
#include "model/numeric/ratio.hpp"
#include "model/numeric/slope.hpp"

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

void put_vertex(SetupRecord& record, std::size_t i, const SetupVertex& v) {
  const auto& m = vertex_members[i];
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
SetupVertex quantize_vertex(const SetupStage& stage, const Vertex& in, Watch watch) {
  SetupVertex v;
  v.x = quantize(exact_of(in.x), stage.coordinate, watch);
  v.y = quantize(exact_of(in.y), stage.coordinate, watch);
  const Exact s = value_of(quantize(scaled(exact_of(in.s), stage.exponent), stage.s, watch), stage.s);
  v.h = quantize_ratio(stage.b * (stage.s_max - s), s, stage.h, watch);
  v.u = quantize(exact_of(in.u), stage.uv, watch);
  v.v = quantize(exact_of(in.v), stage.uv, watch);
  for (std::size_t c = 0; c < channel_count; ++c) {
    v.c[c] = quantize(exact_of(in.c[c]), stage.shade, watch);
  }
  return v;
}

}  // namespace

SetupStage prepare_setup(const Config& config, const Constants& constants) {
  SetupStage s;
  s.exponent = constants.exponent;
  s.b = b_of(config, constants.record);
  s.perspective = config.perspective;
  s.walk = config.edge_walk;
  s.form = config.edge_slope;
  s.reciprocal = ReciprocalUnit(config.edge_reciprocal, RegisterId::edge_reciprocal);
  s.coordinate = make_register(config.coordinate_format(), RegisterId::coordinate);
  s.s = make_register(config, FormatId::setup_s);
  s.s_max = value_of(constants.record.s_max, s.s);
  s.h = make_register(config, FormatId::setup_h);
  s.uv = make_register(config, FormatId::setup_uv);
  s.shade = make_register(config, FormatId::setup_shade);
  s.x_step = make_register(config, FormatId::edge_x_step);
  s.h_step = make_register(config, FormatId::edge_h_step);
  s.f_diff = make_register(config, FormatId::edge_f_diff);
  s.f_step = make_register(config, FormatId::edge_f_step);
  s.shade_step = make_register(config, FormatId::edge_shade_step);
  if (config.edge_slope == SlopeForm::reciprocal) {
    s.divides_per_edge = 1;
  } else {
    s.divides_per_edge = config.edge_walk == EdgeWalk::dda ? 8 : 7;
  }
  return s;
}

SetupVertex vertex_of(const SetupRecord& record, int i) {
  const auto& m = vertex_members[static_cast<std::size_t>(i)];
  return {record.*m[0], record.*m[1], record.*m[2],
          record.*m[3], record.*m[4], {record.*m[5], record.*m[6], record.*m[7], record.*m[8]}};
}

template <class Watch>
bool setup(const SetupStage& stage, const Triangle& triangle, std::int64_t index, SetupRecord& out,
           Watch watch) {
  std::array<SetupVertex, 3> v;
  for (std::size_t i = 0; i < 3; ++i) {
    v[i] = quantize_vertex(stage, triangle.v[i], watch);
  }
  std::stable_sort(v.begin(), v.end(), [](const SetupVertex& a, const SetupVertex& b) {
    return std::tie(a.y, a.x) < std::tie(b.y, b.x);
  });
  const auto product = [](std::int64_t a, std::int64_t b) { return int128{a} * b; };
  const int128 area = product(v[1].x - v[0].x, v[2].y - v[0].y) - product(v[2].x - v[0].x, v[1].y - v[0].y);
  if (area == 0) {
    return false;
  }
  out.triangle = index;
  out.mid_right = area > 0 ? 1 : 0;
  for (std::size_t i = 0; i < 3; ++i) {
    put_vertex(out, i, v[i]);
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
    const Length dy = make_length(value_of(b.y - a.y, stage.coordinate), stage.form, stage.reciprocal, watch);
    e.recip_m = dy.inverse.m;
    e.recip_e = dy.inverse.e;
    if (stage.walk == EdgeWalk::dda) {
      e.x_step = slope(value_of(b.x - a.x, stage.coordinate), dy, stage.x_step, watch);
    }
    e.h_step = slope(value_of(b.h, stage.h) - value_of(a.h, stage.h), dy, stage.h_step, watch);
    const Exact q = stage.perspective == Perspective::affine ? Exact{1, 0} : value_of(b.h, stage.h) + stage.b;
    const auto texture = [&](std::int64_t from, std::int64_t to, std::int64_t& diff, std::int64_t& step) {
      diff = quantize((value_of(to, stage.uv) - value_of(from, stage.uv)) * q, stage.f_diff, watch);
      step = slope(value_of(diff, stage.f_diff), dy, stage.f_step, watch);
    };
    texture(a.u, b.u, e.fu_diff, e.fu_step);
    texture(a.v, b.v, e.fv_diff, e.fv_step);
    for (std::size_t c = 0; c < channel_count; ++c) {
      e.*edge_steps[c] =
          slope(value_of(b.c[c], stage.shade) - value_of(a.c[c], stage.shade), dy, stage.shade_step, watch);
    }
  }
  return edges;
}

template bool setup(const SetupStage&, const Triangle&, std::int64_t, SetupRecord&, NoObserve);
template bool setup(const SetupStage&, const Triangle&, std::int64_t, SetupRecord&, Observe);
template Edges setup_edges(const SetupStage&, const SetupRecord&, NoObserve);
template Edges setup_edges(const SetupStage&, const SetupRecord&, Observe);

}  // namespace bitspan::model
