// SPDX-License-Identifier: Apache-2.0
#include "golden/lod.hpp"

#include <algorithm>
#include <array>

#include "config/modes.hpp"
#include "golden/gradient.hpp"
#include "golden/log2.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class GradientForming {
 public:
  GradientForming(const Config& config, const Constants& constants)
      : vertex_(config),
        q_g_(config.format(FormatId::plane_g)),
        q_h_grad_(config.format(FormatId::plane_h_grad)),
        q_g_grad_(config.format(FormatId::plane_g_grad)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)) {}

  GradientRecord operator()(const SetupRecord& triangle) const {
    const std::array<VertexValues<Real>, 3> v = vertex_.load(triangle);
    const PlaneShape<Real> shape(v);
    const auto gu_at = numerators_at(v, LineId::fu, b_, q_g_);
    const auto gv_at = numerators_at(v, LineId::fv, b_, q_g_);
    const Gradient<Real> h = shape.gradient(at_vertices(v, LineId::h), q_h_grad_);
    const Gradient<Real> gu = shape.gradient(gu_at, q_g_grad_);
    const Gradient<Real> gv = shape.gradient(gv_at, q_g_grad_);
    GradientRecord out;
    out.triangle = triangle.triangle;
    out.gu0 = q_g_.raw(gu_at[0]);
    out.gv0 = q_g_.raw(gv_at[0]);
    out.gu1 = q_g_.raw(gu_at[1]);
    out.gv1 = q_g_.raw(gv_at[1]);
    out.gu2 = q_g_.raw(gu_at[2]);
    out.gv2 = q_g_.raw(gv_at[2]);
    out.h_x = q_h_grad_.raw(h.x);
    out.h_y = q_h_grad_.raw(h.y);
    out.gu_x = q_g_grad_.raw(gu.x);
    out.gu_y = q_g_grad_.raw(gu.y);
    out.gv_x = q_g_grad_.raw(gv.x);
    out.gv_y = q_g_grad_.raw(gv.y);
    return out;
  }

 private:
  VertexFormats<Real> vertex_;
  Quantizer<Real> q_g_, q_h_grad_, q_g_grad_;
  Real b_;
};

template <class Real>
class Leveling {
 public:
  Leveling(const Config& config, const Constants& constants)
      : mip_(config.mip),
        mode_(config.lod),
        q_h_(config.format(FormatId::span_h)),
        q_uv_(config.format(FormatId::span_uv)),
        q_h_grad_(config.format(FormatId::plane_h_grad)),
        q_g_grad_(config.format(FormatId::plane_g_grad)),
        q_s_(config.format(FormatId::distance_s)),
        q_d_(config.format(FormatId::distance_d)),
        q_slope_(config.format(FormatId::lod_slope)),
        q_lambda_(config.format(FormatId::lod_lambda)),
        q_frac_(config.format(FormatId::lod_frac)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        neighbour_unit_(config.pixel_reciprocal, std::max(depth_sum_fraction(config, FormatId::span_h),
                                                          config.format(FormatId::plane_h_grad).fraction())) {
    if (!has_lod_zones(config)) return;
    const Real s_max = Quantizer<Real>(config.format(FormatId::setup_s)).value(constants.record.s_max);
    a_ = Quantizer<Real>(config.format(FormatId::distance_a)).product(b_, s_max);
    const Quantizer<Real> q_k(config.format(FormatId::lod_k));
    Real start = Real(config.lod_first) * pow2<Real>(-16);
    for (std::size_t i = 0; i < start_.size(); ++i) {
      start_[i] = start;
      k_[i] = q_k.quotient(Real(1), start);
      start = start + start;
    }
  }

  void operator()(std::span<const FragmentRecord* const> fragments, const GradientRecord& gradient,
                  std::span<const DistanceRecord> distances, int levels, const DrawState& state,
                  std::vector<LodRecord>& out) const {
    const Real bias = Real(state.texture_lod_bias) * pow2<Real>(-4);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const FragmentRecord* fragment = fragments[i];
      LodRecord& record = out.emplace_back();
      record.triangle = fragment->triangle;
      record.x = fragment->x;
      record.y = fragment->y;
      const Real x = level(*fragment, gradient, distances.empty() ? nullptr : &distances[i], levels, record);
      const Real lambda = q_lambda_.sum(x, bias);
      record.lambda = q_lambda_.raw(lambda);
      const Real held = std::min(within(first_levels(state), lambda), Real(levels - 1));
      if (mixes_levels(mip_)) {
        const Real whole = floor_of(held);
        record.level = to_integer(whole);
        record.f = q_frac_.raw(q_frac_(held - whole));
      } else {
        record.level = to_integer(floor_of(held + Real(0.5)));
      }
    }
  }

 private:
  Real level(const FragmentRecord& fragment, const GradientRecord& gradient, const DistanceRecord* distance,
             int levels, LodRecord& out) const {
    switch (mode_) {
      case LodMode::none:
        return Real(0);
      case LodMode::zone_s: {
        const Real s = q_s_.product(invert(fragment, out).times(a_));
        out.s = q_s_.raw(s);
        return level_by_zone(s, levels);
      }
      case LodMode::zone_d:
        return level_by_zone(q_d_.value(distance->d), levels);
      case LodMode::gradient: {
        const Inverse<Real> inverse = invert(fragment, out);
        return level_by_gradient(fragment, gradient, inverse, inverse, out);
      }
      case LodMode::finite: {
        const Real q = q_h_.value(fragment.h) + b_;
        const Inverse<Real> right = neighbour_unit_(q + q_h_grad_.value(gradient.h_x));
        const Inverse<Real> below = neighbour_unit_(q + q_h_grad_.value(gradient.h_y));
        out.recip_m = neighbour_unit_.raw(right.m);
        out.recip_e = right.e;
        return level_by_gradient(fragment, gradient, right, below, out);
      }
    }
    unreachable();
  }

  Real level_by_zone(Real distance, int levels) const {
    int zone = levels - 1;
    while (zone > 0 && distance < start_[static_cast<std::size_t>(zone)]) --zone;
    if (zone == levels - 1) return Real(zone);
    const auto z = static_cast<std::size_t>(zone);
    return Real(zone) + q_frac_.product(distance - start_[z], k_[z]);
  }

  Inverse<Real> invert(const FragmentRecord& fragment, LodRecord& out) const {
    const Inverse<Real> inverse = unit_(q_h_.value(fragment.h) + b_);
    out.recip_m = unit_.raw(inverse.m);
    out.recip_e = inverse.e;
    return inverse;
  }

  Real level_by_gradient(const FragmentRecord& fragment, const GradientRecord& gradient,
                         const Inverse<Real>& along_x, const Inverse<Real>& along_y, LodRecord& out) const {
    const auto derivative = [&](std::int64_t g, std::int64_t h, std::int64_t w,
                                const Inverse<Real>& inverse) {
      return q_slope_.product(inverse.times(q_g_grad_.value(g) - q_uv_.value(w) * q_h_grad_.value(h)));
    };
    const std::array<Real, 4> t{derivative(gradient.gu_x, gradient.h_x, fragment.u, along_x),
                                derivative(gradient.gu_y, gradient.h_y, fragment.u, along_y),
                                derivative(gradient.gv_x, gradient.h_x, fragment.v, along_x),
                                derivative(gradient.gv_y, gradient.h_y, fragment.v, along_y)};
    out.u_x = q_slope_.raw(t[0]);
    out.u_y = q_slope_.raw(t[1]);
    out.v_x = q_slope_.raw(t[2]);
    out.v_y = q_slope_.raw(t[3]);
    Real rho = q_slope_.ulp();
    for (const Real each : t) rho = std::max(rho, each < 0 ? -each : each);
    return linear_log2(rho);
  }

  MipMode mip_;
  LodMode mode_;
  Quantizer<Real> q_h_, q_uv_, q_h_grad_, q_g_grad_, q_s_, q_d_, q_slope_, q_lambda_, q_frac_;
  Real b_;
  ReciprocalUnit<Real> unit_, neighbour_unit_;
  Real a_ = 0;
  std::array<Real, max_mip_level + 1> start_{}, k_{};
};

}  // namespace

GradientStage make_gradients(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> GradientStage { return GradientForming<Real>(config, constants); });
}

LodStage make_lod(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> LodStage { return Leveling<Real>(config, constants); });
}

}  // namespace bitspan::golden
