// SPDX-License-Identifier: Apache-2.0
#include "golden/setup.hpp"

#include <cmath>

#include "config/modes.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Setup {
 public:
  Setup(const Config& config, const Constants& constants)
      : vertex_(config),
        q_s_(config.format(FormatId::setup_s)),
        s_max_(q_s_.value(constants.record.s_max)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        s_exponent_(constants.s_exponent),
        s_scale_(std::ldexp(1.0, -s_exponent_)) {}

  std::optional<SetupRecord> operator()(const Triangle& triangle, std::int64_t index) const {
    std::array<VertexValues<Real>, 3> v;
    for (std::size_t i = 0; i < 3; ++i) {
      // In its place behind those that do not come after it.
      const VertexValues<Real> vertex = quantise(triangle.v[i]);
      std::size_t at = i;
      for (; at > 0 && comes_before(vertex, v[at - 1]); --at) v[at] = v[at - 1];
      v[at] = vertex;
    }
    const Real area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[2].x - v[0].x) * (v[1].y - v[0].y);
    if (area == 0) return std::nullopt;
    SetupRecord out;
    out.triangle = index;
    out.mid_right = area > 0 ? 1 : 0;
    for (int i = 0; i < 3; ++i) vertex_.store(v[static_cast<std::size_t>(i)], out, i);
    return out;
  }

 private:
  static bool comes_before(const VertexValues<Real>& a, const VertexValues<Real>& b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
  }

  // Where an input is below every half ulp only its sign counts, and scaling it must not take that away.
  static Real input(double x) {
    constexpr double tiny = 0x1p-900;
    return Real(x != 0 && std::fabs(x) < tiny ? std::copysign(tiny, x) : x);
  }

  VertexValues<Real> quantise(const Vertex& in) const {
    VertexValues<Real> out;
    out.x = vertex_.xy(input(in.x));
    out.y = vertex_.xy(input(in.y));
    // s > 0: where 2^-E takes it below double's range, it is far below half an ulp.
    const bool moderate = s_exponent_ > -1000 && s_exponent_ < 1000;
    const Real s = q_s_(Real(moderate ? in.s * s_scale_ : std::ldexp(in.s, -s_exponent_)));
    if (s <= 0) throw InputError("setup.s: a vertex's s is not above 0 in this format");
    out.h = vertex_.h.quotient(exact_product(b_, s_max_ - s), PairOf<Real>{base_of(s), 0});
    out.u = vertex_.uv(input(in.u));
    out.v = vertex_.uv(input(in.v));
    for (std::size_t i = 0; i < channels; ++i) out.c[i] = vertex_.shade(input(in.c[i]));
    return out;
  }

  VertexFormats<Real> vertex_;
  Quantizer<Real> q_s_;
  Real s_max_, b_;
  int s_exponent_;
  double s_scale_;
};

template <class Real>
class EdgeSetup {
 public:
  EdgeSetup(const Config& config, const Constants& constants)
      : vertex_(config),
        q_x_step_(config.format(FormatId::edge_x_step)),
        q_h_step_(config.format(FormatId::edge_h_step)),
        q_f_diff_(config.format(FormatId::edge_f_diff)),
        q_f_step_(config.format(FormatId::edge_f_step)),
        q_shade_step_(config.format(FormatId::edge_shade_step)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        form_(config.edge_slope),
        unit_(config.edge_reciprocal, config.subpixel_bits),
        has_x_step_(has_x_step(config)),
        linear_(has_linear_edges(config.perspective)),
        by_plane_(has_setup_plane(config)) {}

  int operator()(const SetupRecord& triangle, std::array<EdgeRecord, 3>& out) const {
    constexpr std::array<std::array<std::size_t, 2>, 3> ends{{{0, 2}, {0, 1}, {1, 2}}};
    const std::array<VertexValues<Real>, 3> v{vertex_.load(triangle, 0), vertex_.load(triangle, 1),
                                              vertex_.load(triangle, 2)};
    int count = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const VertexValues<Real>& from = v[ends[edge][0]];
      const VertexValues<Real>& to = v[ends[edge][1]];
      if (from.y == to.y) continue;
      EdgeRecord& record = out[static_cast<std::size_t>(count++)];
      record = make(from, to);
      record.triangle = triangle.triangle;
      record.edge = static_cast<std::int64_t>(edge);
    }
    return count;
  }

 private:
  EdgeRecord make(const VertexValues<Real>& from, const VertexValues<Real>& to) const {
    if (by_plane_ && !has_x_step_) return {};
    const Divisor<Real> rows(to.y - from.y, form_, unit_);
    EdgeRecord out;
    if (rows.reciprocal) {
      out.recip_m = unit_.raw(rows.inverse.m);
      out.recip_e = rows.inverse.e;
    }
    if (has_x_step_) out.x_step = q_x_step_.raw(rows.slope(to.x - from.x, q_x_step_));
    if (by_plane_) return out;
    const Real scale = linear_ ? Real(1) : to.h + b_;
    const Real fu_diff = q_f_diff_.product(to.u - from.u, scale);
    const Real fv_diff = q_f_diff_.product(to.v - from.v, scale);
    out.h_step = q_h_step_.raw(rows.slope(to.h - from.h, q_h_step_));
    out.fu_diff = q_f_diff_.raw(fu_diff);
    out.fv_diff = q_f_diff_.raw(fv_diff);
    out.fu_step = q_f_step_.raw(rows.slope(fu_diff, q_f_step_));
    out.fv_step = q_f_step_.raw(rows.slope(fv_diff, q_f_step_));
    Shades<Real> step;
    for (std::size_t i = 0; i < channels; ++i) step[i] = rows.slope(to.c[i] - from.c[i], q_shade_step_);
    store_shades(q_shade_step_, step, out.r_step, out.g_step, out.b_step, out.a_step);
    return out;
  }

  VertexFormats<Real> vertex_;
  Quantizer<Real> q_x_step_, q_h_step_, q_f_diff_, q_f_step_, q_shade_step_;
  Real b_;
  SlopeForm form_;
  ReciprocalUnit<Real> unit_;
  bool has_x_step_, linear_, by_plane_;
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
