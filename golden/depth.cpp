#include "golden/depth.hpp"

#include "golden/reciprocal.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Depth {
 public:
  Depth(const Config& config, const Constants& constants)
      : code_(config.depth_code),
        q_h_(config.format(FormatId::span_h)),
        q_z_(config.depth_format()),
        far_z_(FarBound(config.depth_format(), {config.format(FormatId::depth_c0)})),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        c1_(Quantizer<Real>(config.format(FormatId::depth_c1)).value(constants.record.c1)),
        c0_(Quantizer<Real>(config.format(FormatId::depth_c0)).value(constants.record.c0)),
        z_max_(pow2<Real>(config.depth_bits) - 1),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)) {}

  DepthRecord operator()(const FragmentRecord& fragment, std::int64_t stored) const {
    DepthRecord out;
    out.triangle = fragment.triangle;
    out.x = fragment.x;
    out.y = fragment.y;
    out.stored = stored;
    const Real h = q_h_.value(fragment.h);
    switch (code_) {
      case DepthCode::inverse:
        out.z = q_z_.raw(q_z_(h));
        out.pass = out.z > stored ? 1 : 0;
        return out;
      case DepthCode::opengl:
        out.z = q_z_.raw(q_z_.sum(z_max_, -h));
        break;
      case DepthCode::linear: {
        const Inverse<Real> inverse = unit_(h + b_);
        out.recip_m = unit_.raw(inverse.m);
        out.recip_e = inverse.e;
        out.z = q_z_.raw(q_z_.sum(far_z_(inverse.times(c1_)), -c0_));
        break;
      }
    }
    out.pass = out.z < stored ? 1 : 0;
    return out;
  }

 private:
  DepthCode code_;
  Quantizer<Real> q_h_, q_z_;
  FarProduct<Real> far_z_;
  Real b_, c1_, c0_, z_max_;
  ReciprocalUnit<Real> unit_;
};

}  // namespace

DepthStage make_depth(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> DepthStage { return Depth<Real>(config, constants); });
}

std::int64_t clear_depth(const Config& config) {
  return config.depth_code == DepthCode::inverse ? 0 : (std::int64_t{1} << config.depth_bits) - 1;
}

}  // namespace bitspan::golden
