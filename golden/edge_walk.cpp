// SPDX-License-Identifier: Apache-2.0
#include "golden/edge_walk.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

// One edge on its way down: its constants, and the registers of the row it stands on.
template <class Real>
struct Edge {
  std::int64_t number = 0;
  VertexValues<Real> from;
  Real dx = 0, dy = 0;
  Real x_step = 0, h_step = 0, fu_step = 0, fv_step = 0;
  Shades<Real> step{};
  Real x_acc = 0, h_acc = 0, fu = 0, fv = 0;
  Shades<Real> acc{};
};

template <class Real>
class EdgeWalker {
 public:
  EdgeWalker(const Config& config, const Constants& constants, int width, int height)
      : width_(width),
        height_(height),
        vertex_(config),
        q_x_step_(config.format(FormatId::edge_x_step)),
        q_x_acc_(config.format(FormatId::edge_x_acc)),
        q_x_(config.format(FormatId::edge_x)),
        q_h_step_(config.format(FormatId::edge_h_step)),
        q_h_acc_(config.format(FormatId::edge_h_acc)),
        q_h_(config.format(FormatId::edge_h)),
        q_f_step_(config.format(FormatId::edge_f_step)),
        q_f_(config.format(FormatId::edge_f)),
        q_uv_(config.format(FormatId::edge_uv)),
        q_shade_step_(config.format(FormatId::edge_shade_step)),
        q_shade_acc_(config.format(FormatId::edge_shade_acc)),
        q_shade_(config.format(FormatId::edge_shade)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        pixel_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::edge_h)),
        edge_x_(edge_x_of(config)),
        linear_(has_linear_edges(config.perspective)),
        by_plane_(has_setup_plane(config)),
        fill_rule_(config.fill_rule) {
    const StartOffsets& offset = config.start_offset;
    const auto f = [&](FormatId id) { return config.format(id); };
    start_x_ = Start(offset.edge_x, f(FormatId::edge_x));
    start_h_ = Start(offset.edge_h, f(FormatId::edge_h));
    start_f_ = Start(offset.edge_f, f(FormatId::edge_f));
    start_shade_ = Start(offset.edge_shade, f(FormatId::edge_shade));
  }

  void operator()(const SetupRecord& triangle, std::span<const EdgeRecord> records,
                  std::vector<RowRecord>& rows) const {
    const std::array<VertexValues<Real>, 3> v{vertex_.load(triangle, 0), vertex_.load(triangle, 1),
                                              vertex_.load(triangle, 2)};
    const std::int64_t first = first_row(v[0].y);
    const Whole<Real> end = whole_of(v[2].y);
    const std::int64_t last = std::min<std::int64_t>(height_ - 1, to_integer(last_before(end)));
    if (first > last) return;

    std::array<Edge<Real>, 3> edges;
    std::array<bool, 3> has_height{};
    std::array<std::int64_t, 3> start{};
    for (const EdgeRecord& record : records) {
      const auto i = static_cast<std::size_t>(record.edge);
      edges[i] = load(record, v[i == 2 ? 1 : 0], v[i == 1 ? 1 : 2]);
      has_height[i] = true;
      start[i] = first_row(edges[i].from.y);
    }
    const std::int64_t second = has_height[2] ? start[2] : last + 1;  // edge 2 takes over from edge 1 here
    for (std::int64_t y = first; y <= last; ++y) {
      Edge<Real>& other = edges[y >= second ? 2 : 1];
      for (Edge<Real>* edge : {&edges[0], &other}) {
        if (y == start[static_cast<std::size_t>(edge->number)]) {
          begin(*edge, y);
        } else {
          step(*edge, y);
        }
      }
      const bool edge0_left = triangle.mid_right == 1;
      row(triangle.triangle, y, edge0_left ? edges[0] : other, edge0_left ? other : edges[0], rows);
    }
  }

 private:
  using Start = PreStep<Real>;

  // The first row, not above the picture, whose centre is at or below y.
  static std::int64_t first_row(Real y) {
    return std::max<std::int64_t>(0, to_integer(ceil_less_half(whole_of(y))));
  }
  // The last row or pixel whose centre is covered in front of an edge at `end`.
  Real last_before(const Whole<Real>& end) const {
    switch (fill_rule_) {
      case FillRule::top_left:
        return ceil_less_half(end) - 1;
      case FillRule::inclusive:
        return floor_less_half(end);
    }
    unreachable();
  }
  static Real below(const Edge<Real>& edge, std::int64_t y) { return (Real(y) + Real(0.5)) - edge.from.y; }

  Edge<Real> load(const EdgeRecord& record, const VertexValues<Real>& from,
                  const VertexValues<Real>& to) const {
    Edge<Real> out;
    out.number = record.edge;
    out.from = from;
    out.dx = to.x - from.x;
    out.dy = to.y - from.y;
    out.x_step = q_x_step_.value(record.x_step);
    out.h_step = q_h_step_.value(record.h_step);
    out.fu_step = q_f_step_.value(record.fu_step);
    out.fv_step = q_f_step_.value(record.fv_step);
    out.step = load_shades(q_shade_step_, record.r_step, record.g_step, record.b_step, record.a_step);
    return out;
  }

  void begin(Edge<Real>& edge, std::int64_t y) const {
    const Real t = below(edge, y);
    if (has_x_step(edge_x_)) edge.x_acc = start_x_(q_x_acc_, edge.from.x, edge.x_step, t);
    if (by_plane_) return;
    edge.h_acc = start_h_(q_h_acc_, edge.from.h, edge.h_step, t);
    edge.fu = start_f_(q_f_, linear_ ? edge.from.u : Real(0), edge.fu_step, t);
    edge.fv = start_f_(q_f_, linear_ ? edge.from.v : Real(0), edge.fv_step, t);
    for (std::size_t i = 0; i < channels; ++i) {
      edge.acc[i] = start_shade_(q_shade_acc_, edge.from.c[i], edge.step[i], t);
    }
  }

  void step(Edge<Real>& edge, std::int64_t y) const {
    switch (edge_x_) {
      case EdgeX::quotient:
        break;
      case EdgeX::summed:
        edge.x_acc = q_x_acc_.sum(edge.x_acc, edge.x_step);
        break;
      case EdgeX::multiplied:
        edge.x_acc = start_x_(q_x_acc_, edge.from.x, edge.x_step, below(edge, y));
        break;
    }
    if (by_plane_) return;
    edge.h_acc = q_h_acc_.sum(edge.h_acc, edge.h_step);
    edge.fu = q_f_.sum(edge.fu, edge.fu_step);
    edge.fv = q_f_.sum(edge.fv, edge.fv_step);
    for (std::size_t i = 0; i < channels; ++i) edge.acc[i] = q_shade_acc_.sum(edge.acc[i], edge.step[i]);
  }

  // X dy of an exact edge: X is this over dy.
  static Real exact_numerator(const Edge<Real>& edge, std::int64_t y) {
    return edge.from.x * edge.dy + edge.dx * below(edge, y);
  }
  Whole<Real> position(const Edge<Real>& edge, std::int64_t y) const {
    return has_x_step(edge_x_) ? whole_of(edge.x_acc) : whole_of_quotient(exact_numerator(edge, y), edge.dy);
  }

  struct EndValues {
    Real x = 0, h = 0, u = 0, v = 0;
    Inverse<Real> inverse;
    Shades<Real> c{};
  };
  EndValues end_values(const Edge<Real>& edge, std::int64_t y) const {
    EndValues out;
    out.x = has_x_step(edge_x_) ? q_x_(edge.x_acc) : q_x_.quotient(exact_numerator(edge, y), edge.dy);
    if (by_plane_) return out;
    out.h = q_h_(edge.h_acc);
    if (linear_) {
      out.u = q_uv_(edge.fu);
      out.v = q_uv_(edge.fv);
    } else {
      out.inverse = pixel_(out.h + b_);
      out.u = q_uv_.sum(out.inverse.times(edge.fu), edge.from.u);
      out.v = q_uv_.sum(out.inverse.times(edge.fv), edge.from.v);
    }
    for (std::size_t i = 0; i < channels; ++i) out.c[i] = q_shade_(edge.acc[i]);
    return out;
  }

  void row(std::int64_t triangle, std::int64_t y, const Edge<Real>& left, const Edge<Real>& right,
           std::vector<RowRecord>& rows) const {
    const Real last = last_before(position(right, y));
    const std::int64_t x_first = std::max<std::int64_t>(0, to_integer(ceil_less_half(position(left, y))));
    const std::int64_t x_last = std::min<std::int64_t>(width_ - 1, to_integer(last));
    if (x_first > x_last) return;

    const EndValues l = end_values(left, y);
    const EndValues r = end_values(right, y);
    RowRecord out;
    out.triangle = triangle;
    out.y = y;
    out.x_first = x_first;
    out.x_last = x_last;
    out.l_edge = left.number;
    out.l_x_acc = q_x_acc_.raw(left.x_acc);
    out.l_x = q_x_.raw(l.x);
    out.l_h_acc = q_h_acc_.raw(left.h_acc);
    out.l_h = q_h_.raw(l.h);
    out.l_fu = q_f_.raw(left.fu);
    out.l_fv = q_f_.raw(left.fv);
    out.l_recip_m = pixel_.raw(l.inverse.m);
    out.l_recip_e = l.inverse.e;
    out.l_u = q_uv_.raw(l.u);
    out.l_v = q_uv_.raw(l.v);
    store_shades(q_shade_acc_, left.acc, out.l_r_acc, out.l_g_acc, out.l_b_acc, out.l_a_acc);
    store_shades(q_shade_, l.c, out.l_r, out.l_g, out.l_b, out.l_a);
    out.r_edge = right.number;
    out.r_x_acc = q_x_acc_.raw(right.x_acc);
    out.r_x = q_x_.raw(r.x);
    out.r_h_acc = q_h_acc_.raw(right.h_acc);
    out.r_h = q_h_.raw(r.h);
    out.r_fu = q_f_.raw(right.fu);
    out.r_fv = q_f_.raw(right.fv);
    out.r_recip_m = pixel_.raw(r.inverse.m);
    out.r_recip_e = r.inverse.e;
    out.r_u = q_uv_.raw(r.u);
    out.r_v = q_uv_.raw(r.v);
    store_shades(q_shade_acc_, right.acc, out.r_r_acc, out.r_g_acc, out.r_b_acc, out.r_a_acc);
    store_shades(q_shade_, r.c, out.r_r, out.r_g, out.r_b, out.r_a);
    rows.push_back(out);
  }

  std::int64_t width_, height_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_x_step_, q_x_acc_, q_x_, q_h_step_, q_h_acc_, q_h_, q_f_step_, q_f_, q_uv_, q_shade_step_,
      q_shade_acc_, q_shade_;
  Real b_;
  ReciprocalUnit<Real> pixel_;
  EdgeX edge_x_;
  bool linear_;    // edges carry u and v themselves
  bool by_plane_;  // edges carry nothing but x
  FillRule fill_rule_;
  Start start_x_, start_h_, start_f_, start_shade_;
};

}  // namespace

EdgeWalkStage make_edge_walk(Arithmetic arithmetic, const Config& config, const Constants& constants,
                             int width, int height) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> EdgeWalkStage {
    return EdgeWalker<Real>(config, constants, width, height);
  });
}

}  // namespace bitspan::golden
