// SPDX-License-Identifier: Apache-2.0
#include "golden/span_setup.hpp"

#include "config/modes.hpp"
#include "golden/reciprocal.hpp"
#include "golden/values.hpp"
#include "golden/with_real.hpp"

namespace bitspan::golden {

namespace {

template <class Real>
class SpanSetup {
 public:
  SpanSetup(const Config& config, const Constants& constants)
      : perspective_(config.perspective),
        q_x_(config.format(FormatId::edge_x)),
        q_edge_h_(config.format(FormatId::edge_h)),
        q_uv_(config.format(FormatId::edge_uv)),
        q_shade_(config.format(FormatId::edge_shade)),
        q_h_step_(config.format(FormatId::span_h_step)),
        q_h_(config.format(FormatId::span_h)),
        q_f_diff_(config.format(FormatId::span_f_diff)),
        q_start_(config.format(linear() ? FormatId::span_uv_acc : FormatId::span_f)),
        q_step_(config.format(linear() ? FormatId::span_uv_step : FormatId::span_f_step)),
        q_shade_step_(config.format(FormatId::span_shade_step)),
        q_shade_acc_(config.format(FormatId::span_shade_acc)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        form_(form_of(config.row_slope)),
        unit_(config.row_reciprocal, config.format(FormatId::edge_x).fraction()) {
    const StartOffsets& offset = config.start_offset;
    const auto f = [&](FormatId id) { return config.format(id); };
    start_h_ = Start(offset.span_h, config.depth_format());
    start_f_ = Start(offset.span_f, f(linear() ? FormatId::span_uv : FormatId::span_f));
    start_shade_ = Start(offset.span_shade, f(FormatId::span_shade));
  }

  SpanRecord operator()(const RowRecord& row) const {
    const Real x_l = q_x_.value(row.l_x);
    const Real length = q_x_.value(row.r_x) - x_l;
    const Real pre = Real(row.x_first) + Real(0.5) - x_l;
    const bool sloped = length > 0;
    const Divisor<Real> pixels = sloped ? Divisor<Real>(length, form_, unit_) : Divisor<Real>();
    const auto slope = [&](Real n, const Quantizer<Real>& q) {
      return sloped ? pixels.slope(n, q) : Real(0);
    };

    SpanRecord out;
    out.triangle = row.triangle;
    out.x = row.x_first;
    out.y = row.y;
    out.count = row.x_last - row.x_first + 1;
    if (pixels.reciprocal) {
      out.recip_m = unit_.raw(pixels.inverse.m);
      out.recip_e = pixels.inverse.e;
    }

    const Real h_l = q_edge_h_.value(row.l_h);
    const Real h_r = q_edge_h_.value(row.r_h);
    const Real h_step = slope(h_r - h_l, q_h_step_);
    out.h_step = q_h_step_.raw(h_step);
    out.h = q_h_.raw(start_h_(q_h_, h_l, h_step, pre));

    const auto texture = [&](std::int64_t raw_l, std::int64_t raw_r, std::int64_t& diff, std::int64_t& base,
                             std::int64_t& start, std::int64_t& step0, std::int64_t& step1) {
      const Real l = q_uv_.value(raw_l);
      const Real r = q_uv_.value(raw_r);
      Real difference = r - l;
      Real from = 0;
      switch (perspective_) {
        case Perspective::delta_f:
          difference = q_f_diff_.product(difference, h_r + b_);
          diff = q_f_diff_.raw(difference);
          base = raw_l;
          break;
        case Perspective::hyperbolic: {
          from = q_f_diff_.product(l, h_l + b_);
          const Real to = q_f_diff_.product(r, h_r + b_);
          difference = to - from;
          diff = q_f_diff_.raw(to);
          break;
        }
        case Perspective::affine:
          from = l;
          break;
        case Perspective::const_depth_rows:  // has no horizontal rows
          unreachable();
      }
      const Real step = slope(difference, q_step_);
      start = q_start_.raw(start_f_(q_start_, from, step, pre));
      step0 = step1 = q_step_.raw(step);
    };
    texture(row.l_u, row.r_u, out.fu_diff, out.u1, out.fu, out.fu_step0, out.fu_step1);
    texture(row.l_v, row.r_v, out.fv_diff, out.v1, out.fv, out.fv_step0, out.fv_step1);

    const Shades<Real> c_l = load_shades(q_shade_, row.l_r, row.l_g, row.l_b, row.l_a);
    const Shades<Real> c_r = load_shades(q_shade_, row.r_r, row.r_g, row.r_b, row.r_a);
    Shades<Real> step;
    Shades<Real> start;
    for (std::size_t i = 0; i < channels; ++i) {
      step[i] = slope(c_r[i] - c_l[i], q_shade_step_);
      start[i] = start_shade_(q_shade_acc_, c_l[i], step[i], pre);
    }
    store_shades(q_shade_acc_, start, out.r, out.g, out.b, out.a);
    store_shades(q_shade_step_, step, out.r_step0, out.g_step0, out.b_step0, out.a_step0);
    store_shades(q_shade_step_, step, out.r_step1, out.g_step1, out.b_step1, out.a_step1);
    return out;
  }

 private:
  using Start = PreStep<Real>;

  bool linear() const { return has_linear_texture(perspective_); }

  Perspective perspective_;
  Quantizer<Real> q_x_, q_edge_h_, q_uv_, q_shade_, q_h_step_, q_h_, q_f_diff_, q_start_, q_step_,
      q_shade_step_, q_shade_acc_;
  Real b_;
  SlopeForm form_;
  ReciprocalUnit<Real> unit_;
  Start start_h_, start_f_, start_shade_;
};

// slope.row = plane.
template <class Real>
class TriangleSpanSetup {
 public:
  explicit TriangleSpanSetup(const Config& config)
      : vertex_(config),
        q_g_(config.format(FormatId::plane_g)),
        q_h_grad_(config.format(FormatId::plane_h_grad)),
        q_g_grad_(config.format(FormatId::plane_g_grad)),
        q_shade_grad_(config.format(FormatId::plane_shade_grad)),
        q_h_(config.format(FormatId::span_h)),
        q_h_step_(config.format(FormatId::span_h_step)),
        q_f_(config.format(linear(config) ? FormatId::span_uv_acc : FormatId::span_f)),
        q_f_step_(config.format(linear(config) ? FormatId::span_uv_step : FormatId::span_f_step)),
        q_shade_acc_(config.format(FormatId::span_shade_acc)),
        q_shade_step_(config.format(FormatId::span_shade_step)),
        offset_h_(start_offset<Real>(config.start_offset.span_h, config.depth_format())),
        offset_f_(start_offset<Real>(config.start_offset.span_f,
                                     config.format(linear(config) ? FormatId::span_uv : FormatId::span_f))),
        offset_shade_(
            start_offset<Real>(config.start_offset.span_shade, config.format(FormatId::span_shade))) {}

  SpanRecord operator()(const RowRecord& row, const SetupRecord& triangle,
                        const SetupPlaneRecord& plane) const {
    const VertexValues<Real> origin = vertex_.load(triangle, 0);
    const Real right = Real(row.x_first) + Real(0.5) - origin.x;
    const Real down = Real(row.y) + Real(0.5) - origin.y;
    const auto at = [&](const Quantizer<Real>& q, Real from, Real x, Real y, Real offset) {
      return q.raw(q.sum(exact_product(x, right), exact_product(y, down), from, offset));
    };
    SpanRecord out;
    out.triangle = row.triangle;
    out.x = row.x_first;
    out.y = row.y;
    out.count = row.x_last - row.x_first + 1;
    out.u1 = plane.u1;
    out.v1 = plane.v1;
    const Real h_x = q_h_grad_.value(plane.h_x);
    out.h = at(q_h_, origin.h, h_x, q_h_grad_.value(plane.h_y), offset_h_);
    out.h_step = q_h_step_.raw(q_h_step_(h_x));
    const auto texture = [&](std::int64_t f0, std::int64_t x, std::int64_t y) {
      return at(q_f_, q_g_.value(f0), q_g_grad_.value(x), q_g_grad_.value(y), offset_f_);
    };
    out.fu = texture(plane.fu0, plane.fu_x, plane.fu_y);
    out.fv = texture(plane.fv0, plane.fv_x, plane.fv_y);
    out.fu_step0 = out.fu_step1 = q_f_step_.raw(q_f_step_(q_g_grad_.value(plane.fu_x)));
    out.fv_step0 = out.fv_step1 = q_f_step_.raw(q_f_step_(q_g_grad_.value(plane.fv_x)));
    const std::array<std::int64_t, channels> raw_x{plane.r_x, plane.g_x, plane.b_x, plane.a_x};
    const std::array<std::int64_t, channels> raw_y{plane.r_y, plane.g_y, plane.b_y, plane.a_y};
    std::array<std::int64_t, channels> start{};
    std::array<std::int64_t, channels> step{};
    for (std::size_t i = 0; i < channels; ++i) {
      const Real x = q_shade_grad_.value(raw_x[i]);
      start[i] = at(q_shade_acc_, origin.c[i], x, q_shade_grad_.value(raw_y[i]), offset_shade_);
      step[i] = q_shade_step_.raw(q_shade_step_(x));
    }
    out.r = start[0];
    out.g = start[1];
    out.b = start[2];
    out.a = start[3];
    out.r_step0 = out.r_step1 = step[0];
    out.g_step0 = out.g_step1 = step[1];
    out.b_step0 = out.b_step1 = step[2];
    out.a_step0 = out.a_step1 = step[3];
    return out;
  }

 private:
  static bool linear(const Config& config) { return has_linear_texture(config.perspective); }

  VertexFormats<Real> vertex_;
  Quantizer<Real> q_g_, q_h_grad_, q_g_grad_, q_shade_grad_, q_h_, q_h_step_, q_f_, q_f_step_, q_shade_acc_,
      q_shade_step_;
  Real offset_h_, offset_f_, offset_shade_;
};

template <class Real>
class PlaneSpanSetup {
 public:
  PlaneSpanSetup(const Config& config, const Constants& constants)
      : q_h_(config.format(FormatId::span_h)),
        q_f_(config.format(FormatId::span_f)),
        q_f_step_(config.format(FormatId::span_f_step)),
        q_uv_acc_(config.format(FormatId::span_uv_acc)),
        q_uv_step_(config.format(FormatId::span_uv_step)),
        b_(Quantizer<Real>(config.format(FormatId::setup_b)).value(constants.record.b)),
        unit_(config.row_reciprocal, depth_sum_fraction(config, FormatId::span_h)),
        offset_f_(start_offset<Real>(config.start_offset.span_f, config.format(FormatId::span_uv))) {}

  SpanRecord operator()(const PlaneRecord& plane, const PlaneRowRecord& row) const {
    SpanRecord out;
    out.triangle = row.triangle;
    out.x = plane.major == 0 ? row.major_first : row.minor_first;
    out.y = plane.major == 0 ? row.minor_first : row.major_first;
    out.count = row.count;
    const Inverse<Real> inverse = unit_(q_h_.value(row.h) + b_);
    out.recip_m = unit_.raw(inverse.m);
    out.recip_e = inverse.e;
    out.phase = row.phase;
    out.h = row.h;
    const auto start = [&](std::int64_t g) {
      return q_uv_acc_.raw(q_uv_acc_.sum(inverse.times(q_f_.value(g)), offset_f_));
    };
    const auto step = [&](std::int64_t g) {
      return q_uv_step_.raw(q_uv_step_.product(inverse.times(q_f_step_.value(g))));
    };
    out.fu = start(row.gu);
    out.fv = start(row.gv);
    out.fu_step0 = step(row.gu_step0);
    out.fu_step1 = step(row.gu_step1);
    out.fv_step0 = step(row.gv_step0);
    out.fv_step1 = step(row.gv_step1);
    out.r = row.r;
    out.g = row.g;
    out.b = row.b;
    out.a = row.a;
    out.r_step0 = row.r_step0;
    out.r_step1 = row.r_step1;
    out.g_step0 = row.g_step0;
    out.g_step1 = row.g_step1;
    out.b_step0 = row.b_step0;
    out.b_step1 = row.b_step1;
    out.a_step0 = row.a_step0;
    out.a_step1 = row.a_step1;
    return out;
  }

 private:
  Quantizer<Real> q_h_, q_f_, q_f_step_, q_uv_acc_, q_uv_step_;
  Real b_;
  ReciprocalUnit<Real> unit_;
  Real offset_f_;
};

}  // namespace

SpanSetupStage make_span_setup(Arithmetic arithmetic, const Config& config, const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> SpanSetupStage { return SpanSetup<Real>(config, constants); });
}

TriangleSpanSetupStage make_triangle_span_setup(Arithmetic arithmetic, const Config& config) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic,
                   [&]<class Real>() -> TriangleSpanSetupStage { return TriangleSpanSetup<Real>(config); });
}

PlaneSpanSetupStage make_plane_span_setup(Arithmetic arithmetic, const Config& config,
                                          const Constants& constants) {
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): see with_real.hpp
  return with_real(arithmetic, [&]<class Real>() -> PlaneSpanSetupStage {
    return PlaneSpanSetup<Real>(config, constants);
  });
}

}  // namespace bitspan::golden
