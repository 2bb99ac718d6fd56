// SPDX-License-Identifier: Apache-2.0
#include "model/stages/setup_plane.hpp"

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/gradient.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

// The numerators of u, or of v, at the vertices: from it, and as registers.
struct Numerators {
  std::int64_t base = 0;
  std::array<std::int64_t, 3> f{};
};

template <class Watch>
Numerators numerators(const SetupPlaneStage& stage, const std::array<SetupVertex, 3>& v,
                      std::int64_t SetupVertex::*w, Watch watch) {
  Numerators out;
  const auto vertex = [&](std::size_t i) { return value_of(v[i].*w, stage.vertex_uv); };
  const auto q = [&](std::size_t i) { return value_of(v[i].h, stage.vertex_h) + stage.b; };
  switch (stage.perspective) {
    case Perspective::delta_f: {
      out.base = quantize(vertex(0), stage.uv, watch);
      const Exact base = value_of(out.base, stage.uv);
      for (std::size_t i = 0; i < 3; ++i) out.f[i] = quantize((vertex(i) - base) * q(i), stage.g, watch);
      break;
    }
    case Perspective::hyperbolic:
      for (std::size_t i = 0; i < 3; ++i) out.f[i] = quantize(vertex(i) * q(i), stage.g, watch);
      break;
    case Perspective::affine:
      for (std::size_t i = 0; i < 3; ++i) out.f[i] = quantize(vertex(i), stage.g, watch);
      break;
    case Perspective::const_depth_rows:  // has no horizontal rows
      unreachable();
  }
  return out;
}

}  // namespace

SetupPlaneStage prepare_setup_plane(const Config& config, const Constants& constants) {
  SetupPlaneStage s;
  const auto reg = [&](FormatId id) { return make_register(config, id); };
  s.perspective = config.perspective;
  s.form = config.edge_slope;
  s.reciprocal = ReciprocalUnit(config.edge_reciprocal, RegisterId::edge_reciprocal);
  s.subpixel_bits = config.subpixel_bits;
  s.b = b_of(config, constants.record);
  s.vertex_h = reg(FormatId::setup_h);
  s.vertex_uv = reg(FormatId::setup_uv);
  s.vertex_shade = reg(FormatId::setup_shade);
  s.uv = reg(FormatId::edge_uv);
  s.g = reg(FormatId::plane_g);
  s.h_grad = reg(FormatId::plane_h_grad);
  s.g_grad = reg(FormatId::plane_g_grad);
  s.shade_grad = reg(FormatId::plane_shade_grad);
  s.divides_per_plane = shares_reciprocal(s.form) ? 1 : 14;
  return s;
}

template <class Watch>
TrianglePlane setup_plane(const SetupPlaneStage& stage, const SetupRecord& setup, Watch watch) {
  const std::array<SetupVertex, 3> v{vertex_of(setup, 0), vertex_of(setup, 1), vertex_of(setup, 2)};
  TrianglePlane plane;
  plane.origin = v[0];
  SetupPlaneRecord& out = plane.record;
  out.triangle = setup.triangle;
  const TriangleShape shape = shape_of(v, stage.subpixel_bits);
  const bool turned = shape.area.raw < 0;
  Exact inverse;
  if (shares_reciprocal(stage.form)) {
    const Inverse r = stage.reciprocal(turned ? -shape.area : shape.area, watch);
    out.recip_m = r.m;
    out.recip_e = r.e;
    inverse = stage.reciprocal.value(r);
  }
  const auto slope = [&](Exact n, const Register& r) {
    return shares_reciprocal(stage.form) ? quantize((turned ? -n : n) * inverse, r, watch)
                                         : quantize_ratio(n, shape.area, r, watch);
  };
  const auto gradient = [&](const VertexTriple& w, const Register& r, std::int64_t& x, std::int64_t& y) {
    const Rises n = rises(shape, w);
    x = slope(n.nx, r);
    y = slope(n.ny, r);
  };
  const auto triple = [](const std::array<std::int64_t, 3>& raw, const Register& r) {
    return VertexTriple{value_of(raw[0], r), value_of(raw[1], r), value_of(raw[2], r)};
  };

  const Numerators fu = numerators(stage, v, &SetupVertex::u, watch);
  const Numerators fv = numerators(stage, v, &SetupVertex::v, watch);
  out.u1 = fu.base;
  out.v1 = fv.base;
  out.fu0 = fu.f[0];
  out.fu1 = fu.f[1];
  out.fu2 = fu.f[2];
  out.fv0 = fv.f[0];
  out.fv1 = fv.f[1];
  out.fv2 = fv.f[2];
  gradient(triple({v[0].h, v[1].h, v[2].h}, stage.vertex_h), stage.h_grad, out.h_x, out.h_y);
  gradient(triple(fu.f, stage.g), stage.g_grad, out.fu_x, out.fu_y);
  gradient(triple(fv.f, stage.g), stage.g_grad, out.fv_x, out.fv_y);
  for (std::size_t c = 0; c < channel_count; ++c) {
    gradient(triple({v[0].c[c], v[1].c[c], v[2].c[c]}, stage.vertex_shade), stage.shade_grad,
             out.*setup_plane_x[c], out.*setup_plane_y[c]);
  }
  return plane;
}

template TrianglePlane setup_plane(const SetupPlaneStage&, const SetupRecord&, NoObserve);
template TrianglePlane setup_plane(const SetupPlaneStage&, const SetupRecord&, Observe);

}  // namespace bitspan::model
