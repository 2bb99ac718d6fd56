#include "golden/span.hpp"

#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class SpanWalker {
 public:
  SpanWalker(const Config& config, const Constants& constants)
      : perspective_(config.perspective),
        q_h_(config.format(FormatId::span_h)),
        q_h_step_(config.format(FormatId::span_h_step)),
        q_acc_(config.format(linear() ? FormatId::span_uv_acc : FormatId::span_f)),
        q_step_(config.format(linear() ? FormatId::span_uv_step : FormatId::span_f_step)),
        q_edge_uv_(config.format(FormatId::edge_uv)),
        q_uv_(config.format(FormatId::span_uv)),
        q_shade_step_(config.format(FormatId::span_shade_step)),
        q_shade_acc_(config.format(FormatId::span_shade_acc)),
        q_shade_(config.format(FormatId::span_shade)),
        q_k_(config.format(FormatId::plane_k)),
        far_uv_(FarBound(config.format(FormatId::span_uv), {config.format(FormatId::edge_uv)})),
        phase_ulp_(pow2<Real>(-config.format(FormatId::plane_k).fraction())),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        least_(pow2<Real>(-depth_sum_fraction(config, FormatId::span_h))),
        unit_(config.pixel_reciprocal, depth_sum_fraction(config, FormatId::span_h)) {}

  void operator()(const SpanRecord& span, const PlaneRecord* plane, std::span<const std::uint8_t> covered,
                  std::vector<FragmentRecord>& out) const {
    Real h = q_h_.value(span.h);
    Real fu = q_acc_.value(span.fu);
    Real fv = q_acc_.value(span.fv);
    Shades<Real> c = load_shades(q_shade_acc_, span.r, span.g, span.b, span.a);
    const Real u1 = q_edge_uv_.value(span.u1);
    const Real v1 = q_edge_uv_.value(span.v1);
    const Real h_step = q_h_step_.value(span.h_step);
    const std::array<Real, 2> fu_step{q_step_.value(span.fu_step0), q_step_.value(span.fu_step1)};
    const std::array<Real, 2> fv_step{q_step_.value(span.fv_step0), q_step_.value(span.fv_step1)};
    const std::array<Shades<Real>, 2> c_step{
        load_shades(q_shade_step_, span.r_step0, span.g_step0, span.b_step0, span.a_step0),
        load_shades(q_shade_step_, span.r_step1, span.g_step1, span.b_step1, span.a_step1)};
    Line line(plane, plane != nullptr ? q_k_.value(plane->k) : Real(0), Real(span.phase) * phase_ulp_);

    FragmentRecord fragment;
    fragment.triangle = span.triangle;
    fragment.x = span.x;
    fragment.y = span.y;
    for (std::int64_t i = 0; i < span.count; ++i) {
      fragment.covered = plane != nullptr ? covered[static_cast<std::size_t>(i)] : 1;
      fragment.last = i == span.count - 1 ? 1 : 0;
      fragment.h = q_h_.raw(h);
      fragment.fu = q_acc_.raw(fu);
      fragment.fv = q_acc_.raw(fv);
      coordinates(h, fu, fv, u1, v1, fragment);
      fragment.r = q_shade_.raw(q_shade_(c[0]));
      fragment.g = q_shade_.raw(q_shade_(c[1]));
      fragment.b = q_shade_.raw(q_shade_(c[2]));
      fragment.a = q_shade_.raw(q_shade_(c[3]));
      out.push_back(fragment);

      const std::size_t step = line.advance(fragment.x, fragment.y);
      h = q_h_.sum(h, h_step);
      fu = q_acc_.sum(fu, fu_step[step]);
      fv = q_acc_.sum(fv, fv_step[step]);
      for (std::size_t j = 0; j < channels; ++j) c[j] = q_shade_acc_.sum(c[j], c_step[step][j]);
    }
  }

 private:
  bool linear() const {
    return perspective_ == Perspective::affine || perspective_ == Perspective::const_depth_rows;
  }

  // The digital line that the pixels follow; horizontal without a plane.
  struct Line {
    bool slanted, major_is_y;
    Real k, phase;
    Line(const PlaneRecord* plane, Real slope, Real start)
        : slanted(plane != nullptr), major_is_y(slanted && plane->major == 1), k(slope), phase(start) {}

    // Moves to the next pixel; 1 where the line steps in the minor coordinate, else 0.
    std::size_t advance(std::int64_t& x, std::int64_t& y) {
      if (!slanted) {
        ++x;
        return 0;
      }
      ++(major_is_y ? y : x);
      phase += k;
      std::int64_t& minor = major_is_y ? x : y;
      if (k >= 0 && phase >= 1) {
        phase -= 1;
        ++minor;
        return 1;
      }
      if (k < 0 && phase < 0) {
        phase += 1;
        --minor;
        return 1;
      }
      return 0;
    }
  };

  void coordinates(Real h, Real fu, Real fv, Real u1, Real v1, FragmentRecord& out) const {
    switch (perspective_) {
      case Perspective::delta_f: {
        const Inverse<Real> inverse = unit_(h + b_);
        out.recip_m = unit_.raw(inverse.m);
        out.recip_e = inverse.e;
        out.u = q_uv_.raw(q_uv_.sum(u1, far_uv_(inverse.times(fu))));
        out.v = q_uv_.raw(q_uv_.sum(v1, far_uv_(inverse.times(fv))));
        return;
      }
      case Perspective::hyperbolic: {
        Real d = h + b_;
        if (d <= 0) d = least_;
        out.u = q_uv_.raw(q_uv_.quotient(fu, d));
        out.v = q_uv_.raw(q_uv_.quotient(fv, d));
        return;
      }
      case Perspective::affine:
      case Perspective::const_depth_rows:
        out.u = q_uv_.raw(q_uv_(fu));
        out.v = q_uv_.raw(q_uv_(fv));
        return;
    }
  }

  Perspective perspective_;
  Quantizer<Real> q_h_, q_h_step_, q_acc_, q_step_, q_edge_uv_, q_uv_, q_shade_step_, q_shade_acc_, q_shade_,
      q_k_;
  FarProduct<Real> far_uv_;
  Real phase_ulp_, b_, least_;
  ReciprocalUnit<Real> unit_;
};

}  // namespace

SpanStage make_span(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SpanStage { return SpanWalker<Real>(config, constants); });
}

}  // namespace bitspan::golden
