#include "model/stages/span.hpp"

#include <algorithm>

#include "model/channels.hpp"
#include "model/numeric/extent.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

template <class Int, class Watch>
void accumulate(std::int64_t& acc, std::int64_t step, const Adder& adder, Watch watch) {
  const Int sum = (static_cast<Int>(acc) << adder.acc_up) + (static_cast<Int>(step) << adder.step_up);
  acc = quantize(sum, adder.fraction, adder.acc, watch);
}

template <class Int>
Int inverse_depth(const InverseDepth& q, std::int64_t h) {
  return (static_cast<Int>(h) << q.h_up) + static_cast<Int>(q.b);
}

template <class Int, class Watch>
void texture_coordinates(const SpanStage& stage, const SpanState& state, FragmentRecord& out, Watch watch) {
  out.recip_m = 0;
  out.recip_e = 0;
  if (stage.perspective == Perspective::delta_f) {
    const Inverse inverse = stage.reciprocal(inverse_depth<Int>(stage.q, state.h), stage.q.fraction, watch);
    out.recip_m = inverse.m;
    out.recip_e = inverse.e;
    const int product = stage.f.acc.fraction + stage.reciprocal.output().fraction + inverse.e;
    const int common = std::max(product, stage.u1_fraction);
    const auto coordinate = [&](std::int64_t base, std::int64_t f) {
      const Int sum = (static_cast<Int>(base) << (common - stage.u1_fraction)) +
                      ((static_cast<Int>(f) * static_cast<Int>(inverse.m)) << (common - product));
      return quantize(sum, common, stage.uv, watch);
    };
    out.u = coordinate(state.u1, state.fu);
    out.v = coordinate(state.v1, state.fv);
  } else if (stage.perspective == Perspective::hyperbolic) {
    const Int q = std::max<Int>(inverse_depth<Int>(stage.q, state.h), 1);
    const int scale = stage.q.fraction - stage.f.acc.fraction;
    out.u = quantize_ratio(state.fu, q, scale, stage.uv, watch);
    out.v = quantize_ratio(state.fv, q, scale, stage.uv, watch);
  } else {
    out.u = quantize(state.fu, stage.f.acc.fraction, stage.uv, watch);
    out.v = quantize(state.fv, stage.f.acc.fraction, stage.uv, watch);
  }
}

template <class Int, class Watch>
void span_on(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch) {
  out.triangle = state.triangle;
  out.x = state.x;
  out.y = state.y;
  out.covered = state.coverage == nullptr || covers(*state.coverage, state.x, state.y) ? 1 : 0;
  out.last = state.left == 1 ? 1 : 0;
  out.h = state.h;
  out.fu = state.fu;
  out.fv = state.fv;
  texture_coordinates<Int>(stage, state, out, watch);
  for (std::size_t c = 0; c < channel_count; ++c) {
    out.*fragment_shades[c] = quantize(state.shade[c], stage.shade_acc.acc.fraction, stage.shade, watch);
  }
  --state.left;
  if (state.left == 0) {
    return;
  }
  state.phase += state.k;
  const int up = state.phase >= state.one ? 1 : 0;
  const int down = state.phase < 0 ? 1 : 0;
  state.phase += state.one * (down - up);
  const auto steps = static_cast<std::size_t>(up | down);
  accumulate<Int>(state.h, state.h_step, stage.h, watch);
  accumulate<Int>(state.fu, state.fu_step[steps], stage.f, watch);
  accumulate<Int>(state.fv, state.fv_step[steps], stage.f, watch);
  for (std::size_t c = 0; c < channel_count; ++c) {
    accumulate<Int>(state.shade[c], state.shade_step[steps][c], stage.shade_acc, watch);
  }
  const int across = up - down;
  state.x += state.along_y ? across : 1;
  state.y += state.along_y ? 1 : across;
}

// The widest sums and products of the stage, over every exponent the reciprocal can deliver.
bool all_fit(const Config& config, const SpanStage& s) {
  const auto of = [&](FormatId id) { return extent(config.format(id)); };
  const bool linear =
      config.perspective == Perspective::affine || config.perspective == Perspective::const_depth_rows;
  const Extent h = of(FormatId::span_h);
  const Extent f = of(linear ? FormatId::span_uv_acc : FormatId::span_f);
  const Extent f_step = of(linear ? FormatId::span_uv_step : FormatId::span_f_step);
  const Extent q = sum(h, of(FormatId::setup_b));
  bool fit = fits_int64(sum(h, of(FormatId::span_h_step))) && fits_int64(sum(f, f_step)) &&
             fits_int64(sum(of(FormatId::span_shade_acc), of(FormatId::span_shade_step))) && fits_int64(q);
  if (config.perspective == Perspective::delta_f) {
    const Extent u1 = of(FormatId::edge_uv);
    const Extent change = product(f, extent(config.pixel_reciprocal.output));
    // Exponents of h + B: from its least ulp, or from B where h is never negative, to its highest bit.
    const bool normalize = config.pixel_reciprocal.normalize;
    const int least = config.format(FormatId::span_h).is_signed ? 1 : bit_length(static_cast<uint128>(s.q.b));
    const int lowest = normalize ? least - 1 - s.q.fraction : 0;
    const int highest = normalize ? q.integer - 2 : 0;
    fit = fit && fits_int64(sum(u1, scaled(change, lowest))) && fits_int64(sum(u1, scaled(change, highest)));
  }
  return fit;
}

}  // namespace

Adder make_adder(const Register& acc, const Register& step) {
  const int fraction = std::max(acc.fraction, step.fraction);
  return {acc, fraction - acc.fraction, fraction - step.fraction, fraction};
}

InverseDepth make_inverse_depth(const Config& config, const Constants& constants) {
  const Exact b = b_of(config, constants.record);
  const int h_fraction = config.format(FormatId::span_h).fraction();
  const int fraction = std::max(h_fraction, b.fraction);
  return {fraction - h_fraction, fraction, on_grid(b, fraction)};
}

SpanStage prepare_span(const Config& config, const Constants& constants) {
  SpanStage s;
  s.perspective = config.perspective;
  s.q = make_inverse_depth(config, constants);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  const bool linear =
      config.perspective == Perspective::affine || config.perspective == Perspective::const_depth_rows;
  const auto adder = [&](FormatId acc, FormatId step) {
    return make_adder(make_register(config, acc), make_register(config, step));
  };
  s.h = adder(FormatId::span_h, FormatId::span_h_step);
  s.f = linear ? adder(FormatId::span_uv_acc, FormatId::span_uv_step)
               : adder(FormatId::span_f, FormatId::span_f_step);
  s.shade_acc = adder(FormatId::span_shade_acc, FormatId::span_shade_step);
  s.u1_fraction = config.format(FormatId::edge_uv).fraction();
  s.uv = make_register(config, FormatId::span_uv);
  s.shade = make_register(config, FormatId::span_shade);
  if (config.perspective == Perspective::delta_f) {
    s.divides_per_fragment = 1;
  } else if (config.perspective == Perspective::hyperbolic) {
    s.divides_per_fragment = 2;
  }
  s.narrow = all_fit(config, s);
  return s;
}

SpanState start_span(const SpanRecord& span, const PlaneGeometry* geometry) {
  SpanState s;
  s.triangle = span.triangle;
  s.x = span.x;
  s.y = span.y;
  s.left = span.count;
  s.h = span.h;
  s.fu = span.fu;
  s.fv = span.fv;
  s.phase = span.phase;
  s.u1 = span.u1;
  s.v1 = span.v1;
  s.h_step = span.h_step;
  s.fu_step = {span.fu_step0, span.fu_step1};
  s.fv_step = {span.fv_step0, span.fv_step1};
  for (std::size_t c = 0; c < channel_count; ++c) {
    s.shade[c] = span.*span_starts[c];
    s.shade_step[0][c] = span.*span_steps0[c];
    s.shade_step[1][c] = span.*span_steps1[c];
  }
  if (geometry != nullptr) {
    s.k = geometry->k;
    s.one = geometry->one;
    s.along_y = geometry->along_y;
    s.coverage = &geometry->coverage;
  }
  return s;
}

template <class Watch>
void span(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch) {
  if (stage.narrow) {
    span_on<std::int64_t>(stage, state, out, watch);
  } else {
    span_on<int128>(stage, state, out, watch);
  }
}

template void span(const SpanStage&, SpanState&, FragmentRecord&, NoObserve);
template void span(const SpanStage&, SpanState&, FragmentRecord&, Observe);

}  // namespace bitspan::model
