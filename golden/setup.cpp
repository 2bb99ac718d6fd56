// SPDX-License-Identifier: Apache-2.0
#include "golden/setup.hpp"

#include <cmath>

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Setup {
 public:
  Setup(const Config& config, const Constants& constants)
      : vertex_(config, constants.channels),
        q_s_(config.format(FormatId::setup_s)),
        s_max_(q_s_.value(constants.record.s_max)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        s_exponent_(constants.s_exponent),
        s_scale_(std::ldexp(1.0, -s_exponent_)),
        by_first_(lights_faces(config.light)),
        constants_(constants) {
    for (const LineId id : constants.channels) {
      const Line line = line_of(id, config.perspective);
      channels_.push_back({line, Quantizer<Quad>(config.format(line.vertex))});
    }
  }

  std::optional<SetupRecord> operator()(const Triangle& triangle, std::int64_t index,
                                        std::vector<SetupChannelRecord>& channels) const {
    std::array<VertexValues<Real>, 3> v;
    for (std::size_t i = 0; i < 3; ++i) {
      // In its place behind those that do not come after it.
      const VertexValues<Real> vertex = quantise(triangle.v[i], triangle.v[0]);
      std::size_t at = i;
      for (; at > 0 && comes_before(vertex, v[at - 1]); --at) v[at] = v[at - 1];
      v[at] = vertex;
    }
    const Real area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[2].x - v[0].x) * (v[1].y - v[0].y);
    if (area == 0 && !triangle.is_line) return std::nullopt;
    SetupRecord out;
    out.triangle = index;
    out.mid_right = area > 0 ? 1 : 0;
    for (std::size_t i = 0; i < 3; ++i) vertex_.store(v[i], out, i);
    for (const auto& [line, q_vertex] : channels_) {
      SetupChannelRecord& channel = channels.emplace_back();
      channel.triangle = index;
      channel.channel = channel_of(line.id);
      for (std::size_t i = 0; i < 3; ++i) {
        channel.*channel_vertices[i] = vertex_[line.id].raw(v[i][line.id]);
        if (!line.is_homogeneous()) continue;
        const Quantizer<Real>& q = vertex_.product[index_of(line.id)];
        channel.*channel_products[i] = q.raw(q.product(v[i][line.id], v[i][LineId::h] + b_));
      }
    }
    return out;
  }

 private:
  struct Channel {
    Line line;
    Quantizer<Quad> q_vertex;
  };

  static bool comes_before(const VertexValues<Real>& a, const VertexValues<Real>& b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
  }

  // Where an input is below every half ulp only its sign counts, and scaling it must not take that away.
  static Real input(double x) {
    constexpr double tiny = 0x1p-900;
    return Real(x != 0 && std::fabs(x) < tiny ? std::copysign(tiny, x) : x);
  }

  // first: the triangle's, whose brightness a face has.
  VertexValues<Real> quantise(const Vertex& in, const Vertex& first) const {
    VertexValues<Real> out;
    out.x = vertex_.xy(input(in.x));
    out.y = vertex_.xy(input(in.y));
    // s > 0: where 2^-E takes it below double's range, it is far below half an ulp.
    const bool moderate = s_exponent_ > -1000 && s_exponent_ < 1000;
    const Real s = q_s_(Real(moderate ? in.s * s_scale_ : std::ldexp(in.s, -s_exponent_)));
    if (s <= 0) throw InputError("setup.s: a vertex's s is not above 0 in this format");
    const Real h = vertex_[LineId::h].quotient(exact_product(b_, s_max_ - s), PairOf<Real>{base_of(s), 0});
    const auto narrowed = [&](LineId id, double w) { return vertex_[id](input(w)); };
    out.line = {h,
                narrowed(LineId::fu, in.u),
                narrowed(LineId::fv, in.v),
                narrowed(LineId::r, in.c[0]),
                narrowed(LineId::g, in.c[1]),
                narrowed(LineId::b, in.c[2]),
                narrowed(LineId::a, in.c[3])};
    for (const Channel& channel : channels_) {
      const LineId id = channel.line.id;
      const Vertex& from = by_first_ && id == LineId::light ? first : in;
      out.line[index_of(id)] =
          vertex_[id].value(channel_at(id, from, Quad(base_of(h)), constants_, channel.q_vertex));
    }
    return out;
  }

  VertexFormats<Real> vertex_;
  Quantizer<Real> q_s_;
  Real s_max_, b_;
  int s_exponent_;
  double s_scale_;
  bool by_first_;
  Constants constants_;
  std::vector<Channel> channels_;
};

template <class Real>
class EdgeSetup {
 public:
  EdgeSetup(const Config& config, const Constants& constants)
      : vertex_(config, constants.channels),
        q_x_step_(config.format(FormatId::edge_x_step)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        form_(config.edge_slope),
        unit_(config.edge_reciprocal, config.subpixel_bits),
        has_x_step_(has_x_step(config)),
        by_plane_(has_setup_plane(config)) {
    for (const Line& line : lines_of(config, constants.channels)) {
      SlopedLine& of = lines_.emplace_back();
      of.line = line;
      of.q_step = Quantizer<Real>(config.format(line.edge.step));
      if (line.edge.difference) of.q_difference = Quantizer<Real>(config.format(*line.edge.difference));
    }
  }

  int operator()(const SetupRecord& triangle, std::array<EdgeRecord, 3>& out,
                 std::span<SetupChannelRecord> channels) const {
    constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
    const std::array<VertexValues<Real>, 3> v = vertex_.load(triangle, channels);
    int count = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const VertexValues<Real>& from = v[ends[edge][0]];
      const VertexValues<Real>& to = v[ends[edge][1]];
      if (from.y == to.y) continue;
      EdgeRecord& record = out[static_cast<std::size_t>(count++)];
      record = make(from, to, edge, channels);
      record.triangle = triangle.triangle;
      record.edge = static_cast<std::int64_t>(edge);
    }
    return count;
  }

 private:
  EdgeRecord make(const VertexValues<Real>& from, const VertexValues<Real>& to, std::size_t edge,
                  std::span<SetupChannelRecord> channels) const {
    if (by_plane_ && !has_x_step_) return {};
    const Divisor<Real> rows(to.y - from.y, form_, unit_);
    EdgeRecord out;
    if (rows.reciprocal) {
      out.recip_m = unit_.raw(rows.inverse.m);
      out.recip_e = rows.inverse.e;
    }
    if (has_x_step_) out.x_step = q_x_step_.raw(rows.slope(to.x - from.x, q_x_step_));
    if (by_plane_) return out;
    for (const SlopedLine& of : lines_) {
      const LineId id = of.line.id;
      Real difference = to[id] - from[id];
      if (is_channel(id)) {
        channels.front().*channel_steps[edge] = of.q_step.raw(rows.slope(difference, of.q_step));
        channels = channels.subspan(1);
        continue;
      }
      const EdgeFields& field = edge_fields[index_of(id)];
      if (of.line.edge.difference) {
        const Real scale = of.line.is_homogeneous() ? to[LineId::h] + b_ : Real(1);
        difference = of.q_difference.product(difference, scale);
        out.*field.difference = of.q_difference.raw(difference);
      }
      out.*field.step = of.q_step.raw(rows.slope(difference, of.q_step));
    }
    return out;
  }

  struct SlopedLine {
    Line line;
    Quantizer<Real> q_step, q_difference;
  };

  VertexFormats<Real> vertex_;
  Quantizer<Real> q_x_step_;
  Real b_;
  SlopeForm form_;
  ReciprocalUnit<Real> unit_;
  bool has_x_step_, by_plane_;
  std::vector<SlopedLine> lines_;
};

}  // namespace

SetupStage make_setup(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> SetupStage { return Setup<Real>(config, constants); });
}

EdgeSetupStage make_edge_setup(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> EdgeSetupStage { return EdgeSetup<Real>(config, constants); });
}

}  // namespace bitspan::golden
