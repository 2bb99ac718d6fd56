// SPDX-License-Identifier: Apache-2.0
#include "golden/setup_plane.hpp"

#include <array>

#include "config/modes.hpp"
#include "golden/gradient.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class PlaneForming {
 public:
  PlaneForming(const Config& config, const Constants& constants)
      : perspective_(config.perspective),
        vertex_(config),
        q_uv_(config.format(FormatId::edge_uv)),
        q_g_(config.format(FormatId::plane_g)),
        q_h_grad_(config.format(FormatId::plane_h_grad)),
        q_g_grad_(config.format(FormatId::plane_g_grad)),
        q_shade_grad_(config.format(FormatId::plane_shade_grad)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        reciprocal_(shares_reciprocal(config.edge_slope)),
        unit_(config.edge_reciprocal, 2 * config.subpixel_bits) {}

  SetupPlaneRecord operator()(const SetupRecord& triangle) const {
    std::array<VertexValues<Real>, 3> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = vertex_.load(triangle, static_cast<int>(i));
    const PlaneShape<Real> shape(v);
    SetupPlaneRecord out;
    out.triangle = triangle.triangle;
    Inverse<Real> inverse;
    if (reciprocal_) {
      inverse = unit_(shape.area < 0 ? -shape.area : shape.area);
      out.recip_m = unit_.raw(inverse.m);
      out.recip_e = inverse.e;
    }
    // The numerators of u, or of v, at the vertices.
    const auto numerators = [&](std::array<Real, 3> w, std::int64_t& base) {
      Real from = 0;
      if (has_pixel_reciprocal(perspective_)) {
        from = q_uv_(w[0]);
        base = q_uv_.raw(from);
      }
      for (std::size_t i = 0; i < v.size(); ++i) {
        w[i] = has_linear_edges(perspective_) ? q_g_(w[i]) : q_g_.product(w[i] - from, v[i].h + b_);
      }
      return w;
    };
    const auto fu = numerators({v[0].u, v[1].u, v[2].u}, out.u1);
    const auto fv = numerators({v[0].v, v[1].v, v[2].v}, out.v1);
    out.fu0 = q_g_.raw(fu[0]);
    out.fu1 = q_g_.raw(fu[1]);
    out.fu2 = q_g_.raw(fu[2]);
    out.fv0 = q_g_.raw(fv[0]);
    out.fv1 = q_g_.raw(fv[1]);
    out.fv2 = q_g_.raw(fv[2]);

    const auto slope = [&](PairOf<Real> n, const Quantizer<Real>& q) {
      const typename RealTraits<Real>::Base sign = shape.area < 0 ? -1 : 1;
      if (!reciprocal_) return q.raw(q.quotient(n, PairOf<Real>{base_of(shape.area), 0}));
      n = n.scaled(sign);
      return q.raw(q.sum(inverse.times(Real(n.high)), inverse.times(Real(n.low))));
    };
    const auto gradient = [&](const std::array<Real, 3>& w, const Quantizer<Real>& q, std::int64_t& x,
                              std::int64_t& y) {
      x = slope(shape.nx(w[0], w[1], w[2]), q);
      y = slope(shape.ny(w[0], w[1], w[2]), q);
    };
    gradient({v[0].h, v[1].h, v[2].h}, q_h_grad_, out.h_x, out.h_y);
    gradient(fu, q_g_grad_, out.fu_x, out.fu_y);
    gradient(fv, q_g_grad_, out.fv_x, out.fv_y);
    gradient({v[0].c[0], v[1].c[0], v[2].c[0]}, q_shade_grad_, out.r_x, out.r_y);
    gradient({v[0].c[1], v[1].c[1], v[2].c[1]}, q_shade_grad_, out.g_x, out.g_y);
    gradient({v[0].c[2], v[1].c[2], v[2].c[2]}, q_shade_grad_, out.b_x, out.b_y);
    gradient({v[0].c[3], v[1].c[3], v[2].c[3]}, q_shade_grad_, out.a_x, out.a_y);
    return out;
  }

 private:
  Perspective perspective_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_uv_, q_g_, q_h_grad_, q_g_grad_, q_shade_grad_;
  Real b_;
  bool reciprocal_;
  ReciprocalUnit<Real> unit_;
};

}  // namespace

SetupPlaneStage make_setup_plane(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SetupPlaneStage { return PlaneForming<Real>(config, constants); });
}

}  // namespace bitspan::golden
