// SPDX-License-Identifier: Apache-2.0
#include "golden/project.hpp"

#include "config/modes.hpp"
#include "golden/channel.hpp"
#include "golden/lines.hpp"
#include "golden/reciprocal.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class Projecting {
 public:
  Projecting(const Config& config, const Constants& constants)
      : code_(config.depth_code),
        has_projector_(constants.projector.has_value()),
        q_h_(config.format(FormatId::span_h)),
        q_value_(config.format(FormatId::project_value)),
        q_uv_(config.format(FormatId::span_uv)),
        q_ratio_(config.format(FormatId::project_ratio)),
        q_code_(config.format(FormatId::project_h)),
        q_z_(config.depth_format()),
        z_max_(pow2<Real>(config.depth_bits) - 1),
        unit_(config.pixel_reciprocal, config.format(FormatId::project_value).fraction()) {
    if (!has_projector_) return;
    const Quantizer<Real> q_b(config.format(FormatId::setup_b));
    const Quantizer<Real> q_s(config.format(FormatId::setup_s));
    b_ = q_b.value(constants.record.b);
    projector_b_ = q_b.value(constants.projector->b);
    projector_a_ = Quantizer<Real>(config.format(FormatId::distance_a))
                       .product(projector_b_, q_s.value(constants.projector->s_max));
    x_ = place_of(constants, LineId::project_x);
    y_ = place_of(constants, LineId::project_y);
    w_ = place_of(constants, LineId::project_w);
  }

  void operator()(std::span<const FragmentRecord* const> fragments,
                  std::span<const FragmentChannelRecord* const> channels, const Texture& texture,
                  std::vector<ProjectRecord>& out) const {
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      ProjectRecord& record = out.emplace_back();
      record.triangle = fragments[i]->triangle;
      record.x = fragments[i]->x;
      record.y = fragments[i]->y;
      if (has_projector_) project(*fragments[i], channels[i], texture, record);
    }
  }

 private:
  // channels: the fragment's, the first one.
  void project(const FragmentRecord& fragment, const FragmentChannelRecord* channels, const Texture& texture,
               ProjectRecord& out) const {
    const Real w = q_value_.value(channels[w_].w);
    if (w <= 0) return;  // behind the projector
    const Inverse<Real> inverse = unit_(w);
    out.recip_m = unit_.raw(inverse.m);
    out.recip_e = inverse.e;
    const Real s = q_uv_.product(inverse.times(q_value_.value(channels[x_].w)));
    const Real t = q_uv_.product(inverse.times(q_value_.value(channels[y_].w)));
    const Real ratio = q_ratio_.product(inverse.times(q_h_.value(fragment.h) + b_));
    const Real h = q_code_.sum(exact_product(projector_a_, ratio), -projector_b_);
    const auto within = [](Real at, int size) {
      const Real whole = floor_of(at);
      return whole >= 0 && whole < size;
    };
    out.s = q_uv_.raw(s);
    out.t = q_uv_.raw(t);
    out.ratio = q_ratio_.raw(ratio);
    out.h = q_code_.raw(h);
    out.z = q_z_.raw(is_complement_of_h(code_) ? q_z_.sum(z_max_, -h) : q_z_(h));
    out.inside = within(s, texture.width) && within(t, texture.height) ? 1 : 0;
  }

  DepthCode code_;
  bool has_projector_;
  Quantizer<Real> q_h_, q_value_, q_uv_, q_ratio_, q_code_, q_z_;
  Real z_max_;
  ReciprocalUnit<Real> unit_;
  Real b_ = 0;                            // the view's
  Real projector_b_ = 0;                  // B_p
  Real projector_a_ = 0;                  // A_p
  std::ptrdiff_t x_ = 0, y_ = 0, w_ = 0;  // among the channels in use
};

}  // namespace

ProjectStage make_project(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> ProjectStage { return Projecting<Real>(config, constants); });
}

}  // namespace bitspan::golden
