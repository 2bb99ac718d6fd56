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
  Real x_step = 0, x_acc = 0;
  std::array<Real, line_count> step{}, acc{};
};

template <class Real>
class EdgeWalker {
 public:
  EdgeWalker(const Config& config, const Constants& constants, int width, int height)
      : width_(width),
        height_(height),
        vertex_(config, constants.channels),
        q_x_step_(config.format(FormatId::edge_x_step)),
        q_x_acc_(config.format(FormatId::edge_x_acc)),
        q_x_(config.format(FormatId::edge_x)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        pixel_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::edge_h)),
        edge_x_(edge_x_of(config)),
        divides_(!has_linear_edges(config.perspective)),
        by_plane_(has_setup_plane(config)),
        fill_rule_(config.fill_rule),
        start_x_(start_offset<Real>(config.start_offset.edge_x, config.format(FormatId::edge_x))) {
    for (const Line& line : lines_of(config, constants.channels)) {
      EdgeLine& of = lines_.emplace_back();
      of.id = line.id;
      of.divides = is_divided(line);
      of.q_step = Quantizer<Real>(config.format(line.edge.step));
      of.q_acc = Quantizer<Real>(config.format(line.edge.acc));
      of.q_kept = Quantizer<Real>(config.format(line.edge.kept));
      of.start = Start(start_offset<Real>(config, line.edge));
    }
  }

  std::int64_t operator()(const SetupRecord& triangle, std::span<const EdgeRecord> records,
                          std::span<const SetupChannelRecord> channels, const RowRange& drawn,
                          std::vector<RowRecord>& rows, std::vector<RowChannelRecord>& row_channels) const {
    const std::array<VertexValues<Real>, 3> v = vertex_.load(triangle, channels);
    const std::int64_t first = first_row(v[0].y);
    const Whole<Real> end = whole_of(v[2].y);
    const std::int64_t last = std::min<std::int64_t>(height_ - 1, to_integer(last_before(end)));
    if (first > last || last < drawn.first) return 0;

    std::array<Edge<Real>, 3> edges;
    std::array<bool, 3> has_height{};
    std::array<std::int64_t, 3> start{};
    for (const EdgeRecord& record : records) {
      const auto i = static_cast<std::size_t>(record.edge);
      edges[i] = load(record, channels, v[i == 2 ? 1 : 0], v[i == 1 ? 1 : 2]);
      has_height[i] = true;
      start[i] = first_row(edges[i].from.y);
    }
    const std::int64_t second = has_height[2] ? start[2] : last + 1;  // edge 2 takes over from edge 1 here
    for (std::int64_t y = first; y <= last && y < drawn.end; ++y) {
      Edge<Real>& other = edges[y >= second ? 2 : 1];
      for (Edge<Real>* edge : {&edges[0], &other}) {
        if (y == start[static_cast<std::size_t>(edge->number)]) {
          begin(*edge, y);
        } else {
          step(*edge, y);
        }
      }
      if (y < drawn.first) continue;
      const bool edge0_left = triangle.mid_right == 1;
      row(triangle.triangle, y, edge0_left ? edges[0] : other, edge0_left ? other : edges[0], rows,
          row_channels);
    }
    return std::max<std::int64_t>(0, drawn.first - first);
  }

 private:
  using Start = PreStep<Real>;

  struct EdgeLine {
    LineId id{};
    bool divides = false;  // w = from.w + acc / (h + B); else acc is w itself
    Quantizer<Real> q_step, q_acc, q_kept;
    Start start;
  };

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

  Edge<Real> load(const EdgeRecord& record, std::span<const SetupChannelRecord> channels,
                  const VertexValues<Real>& from, const VertexValues<Real>& to) const {
    Edge<Real> out;
    out.number = record.edge;
    out.from = from;
    out.dx = to.x - from.x;
    out.dy = to.y - from.y;
    out.x_step = q_x_step_.value(record.x_step);
    for (const EdgeLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      if (is_channel(line.id)) {
        out.step[i] =
            line.q_step.value(channels.front().*channel_steps[static_cast<std::size_t>(record.edge)]);
        channels = channels.subspan(1);
      } else {
        out.step[i] = line.q_step.value(record.*edge_fields[i].step);
      }
    }
    return out;
  }

  void begin(Edge<Real>& edge, std::int64_t y) const {
    const Real t = below(edge, y);
    if (has_x_step(edge_x_)) edge.x_acc = start_x_(q_x_acc_, edge.from.x, edge.x_step, t);
    if (by_plane_) return;
    for (const EdgeLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      edge.acc[i] = line.start(line.q_acc, line.divides ? Real(0) : edge.from.line[i], edge.step[i], t);
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
    for (const EdgeLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      edge.acc[i] = line.q_acc.sum(edge.acc[i], edge.step[i]);
    }
  }

  // X dy of an exact edge: X is this over dy.
  static Real exact_numerator(const Edge<Real>& edge, std::int64_t y) {
    return edge.from.x * edge.dy + edge.dx * below(edge, y);
  }
  Whole<Real> position(const Edge<Real>& edge, std::int64_t y) const {
    return has_x_step(edge_x_) ? whole_of(edge.x_acc) : whole_of_quotient(exact_numerator(edge, y), edge.dy);
  }

  struct EndValues {
    Real x = 0;
    Inverse<Real> inverse;
    std::array<Real, line_count> line{};
  };
  EndValues end_values(const Edge<Real>& edge, std::int64_t y) const {
    EndValues out;
    out.x = has_x_step(edge_x_) ? q_x_(edge.x_acc) : q_x_.quotient(exact_numerator(edge, y), edge.dy);
    if (by_plane_) return out;
    for (const EdgeLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      out.line[i] = line.divides ? line.q_kept.sum(out.inverse.times(edge.acc[i]), edge.from.line[i])
                                 : line.q_kept(edge.acc[i]);
      if (line.id == LineId::h && divides_) out.inverse = pixel_(out.line[i] + b_);
    }
    return out;
  }

  void row(std::int64_t triangle, std::int64_t y, const Edge<Real>& left, const Edge<Real>& right,
           std::vector<RowRecord>& rows, std::vector<RowChannelRecord>& channels) const {
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
    out.l_recip_m = pixel_.raw(l.inverse.m);
    out.l_recip_e = l.inverse.e;
    out.r_edge = right.number;
    out.r_x_acc = q_x_acc_.raw(right.x_acc);
    out.r_x = q_x_.raw(r.x);
    out.r_recip_m = pixel_.raw(r.inverse.m);
    out.r_recip_e = r.inverse.e;
    for (const EdgeLine& line : lines_) {
      const std::size_t i = index_of(line.id);
      if (is_channel(line.id)) {
        if (by_plane_) continue;
        channels.push_back({.triangle = triangle,
                            .y = y,
                            .channel = channel_of(line.id),
                            .l_acc = line.q_acc.raw(left.acc[i]),
                            .l = line.q_kept.raw(l.line[i]),
                            .r_acc = line.q_acc.raw(right.acc[i]),
                            .r = line.q_kept.raw(r.line[i])});
        continue;
      }
      const RowFields& field = row_fields[i];
      out.*field.l_acc = line.q_acc.raw(left.acc[i]);
      out.*field.l = line.q_kept.raw(l.line[i]);
      out.*field.r_acc = line.q_acc.raw(right.acc[i]);
      out.*field.r = line.q_kept.raw(r.line[i]);
    }
    rows.push_back(out);
  }

  std::int64_t width_, height_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_x_step_, q_x_acc_, q_x_;
  Real b_;
  ReciprocalUnit<Real> pixel_;
  EdgeX edge_x_;
  bool divides_;   // a row's end takes R_pixel for u and v
  bool by_plane_;  // edges carry nothing but x
  FillRule fill_rule_;
  Start start_x_;
  std::vector<EdgeLine> lines_;  // h first
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
