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
        vertex_(config, constants.channels),
        q_uv_(config.format(FormatId::edge_uv)),
        q_g_(config.format(FormatId::plane_g)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        reciprocal_(shares_reciprocal(config.edge_slope)),
        unit_(config.edge_reciprocal, 2 * config.subpixel_bits) {
    for (const Line& line : lines_of(config, constants.channels)) {
      lines_.push_back({line, Quantizer<Real>(config.format(line.gradient))});
    }
  }

  SetupPlaneRecord operator()(const SetupRecord& triangle, std::span<SetupChannelRecord> channels) const {
    const std::array<VertexValues<Real>, 3> v = vertex_.load(triangle, channels);
    const PlaneShape<Real> shape(v);
    SetupPlaneRecord out;
    out.triangle = triangle.triangle;
    Inverse<Real> inverse;
    if (reciprocal_) {
      inverse = unit_(shape.area < 0 ? -shape.area : shape.area);
      out.recip_m = unit_.raw(inverse.m);
      out.recip_e = inverse.e;
    }
    const auto slope = [&](PairOf<Real> n, const Quantizer<Real>& q) {
      const typename RealTraits<Real>::Base sign = shape.area < 0 ? -1 : 1;
      if (!reciprocal_) return q.raw(q.quotient(n, PairOf<Real>{base_of(shape.area), 0}));
      n = n.scaled(sign);
      return q.raw(q.sum(inverse.times(Real(n.high)), inverse.times(Real(n.low))));
    };
    for (const RisingLine& of : lines_) {
      std::array<Real, 3> w = at_vertices(v, of.line.id);
      if (is_channel(of.line.id)) {
        channels.front().w_x = slope(shape.nx(w[0], w[1], w[2]), of.q_gradient);
        channels.front().w_y = slope(shape.ny(w[0], w[1], w[2]), of.q_gradient);
        channels = channels.subspan(1);
        continue;
      }
      const PlaneFields<SetupPlaneRecord>& field = setup_plane_fields[index_of(of.line.id)];
      if (of.line.product) {
        Real from = 0;
        if (has_pixel_reciprocal(perspective_)) {
          from = q_uv_(w[0]);
          out.*field.base = q_uv_.raw(from);
        }
        for (std::size_t i = 0; i < v.size(); ++i) {
          w[i] = of.line.is_homogeneous() ? q_g_.product(w[i] - from, v[i][LineId::h] + b_) : q_g_(w[i]);
          out.*field.at_vertex[i] = q_g_.raw(w[i]);
        }
      }
      out.*field.x = slope(shape.nx(w[0], w[1], w[2]), of.q_gradient);
      out.*field.y = slope(shape.ny(w[0], w[1], w[2]), of.q_gradient);
    }
    return out;
  }

 private:
  struct RisingLine {
    Line line;
    Quantizer<Real> q_gradient;
  };

  Perspective perspective_;
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_uv_, q_g_;
  Real b_;
  bool reciprocal_;
  ReciprocalUnit<Real> unit_;
  std::vector<RisingLine> lines_;
};

}  // namespace

SetupPlaneStage make_setup_plane(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SetupPlaneStage { return PlaneForming<Real>(config, constants); });
}

}  // namespace bitspan::golden
