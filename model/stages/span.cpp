// SPDX-License-Identifier: Apache-2.0
#include "model/stages/span.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/channels.hpp"
#include "model/numeric/integers.hpp"
#include "model/stages/span-inl.hpp"

namespace bitspan::model {
namespace {

using HWY_NAMESPACE::accumulated;
using HWY_NAMESPACE::texture_point;

template <class Int, class Watch>
void accumulate(std::int64_t& acc, std::int64_t step, const Adder& adder, Watch watch) {
  acc = accumulated<Int>(acc, step, adder, watch);
}

// u and v from the registers.
template <class Int, class Watch>
auto point_at(const SpanStage& stage, const SpanState& state, Watch watch) {
  return texture_point<Int>(stage.formats, HWY_NAMESPACE::depth_constant<Int>(stage.q.b),
                            stage.reciprocal.table().data(), state.h, state.fu, state.fv, state.u1, state.v1,
                            false, watch);
}

// Behind an exact fragment: where the row has the next one, finds its u and v.
template <class Int>
void enter_subspan(const SpanStage& stage, SpanState& state, const FragmentRecord& exact) {
  const int length = 1 << stage.subspan_bits;
  if (state.left <= length) return;
  SpanState next = state;
  for (int i = 0; i < length; ++i) {
    accumulate<Int>(next.h, next.h_step, stage.formats.h, NoObserve{});
    accumulate<Int>(next.fu, next.fu_step[0], stage.formats.f, NoObserve{});
    accumulate<Int>(next.fv, next.fv_step[0], stage.formats.f, NoObserve{});
  }
  const auto point = point_at<Int>(stage, next, NoObserve{});
  state.near = {exact.u, exact.v};
  state.far = {point.u, point.v};
  state.linear_left = length - 1;
}

template <class Watch>
void linear_point(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch) {
  const int bits = stage.subspan_bits;
  const int128 j = (1 << bits) - state.linear_left;
  const auto between = [&](std::size_t c) {
    const int128 value = (int128{state.near[c]} << bits) + (int128{state.far[c]} - state.near[c]) * j;
    return quantize(value, stage.formats.uv.fraction + bits, stage.formats.uv, watch);
  };
  out.recip_m = out.recip_e = 0;
  out.u = between(0);
  out.v = between(1);
  state.divides = 0;
  --state.linear_left;
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
  const SpanFormats& f = stage.formats;
  if (state.linear_left > 0) {
    linear_point(stage, state, out, watch);
  } else {
    const auto point = point_at<Int>(stage, state, watch);
    out.recip_m = point.recip_m;
    out.recip_e = point.recip_e;
    out.u = point.u;
    out.v = point.v;
    state.divides = stage.divides_per_fragment;
    if (stage.subspan_bits > 0) enter_subspan<Int>(stage, state, out);
  }
  for (std::size_t c = 0; c < channel_count; ++c) {
    out.*fragment_shades[c] = quantize(state.shade[c], f.shade_acc.acc.fraction, f.shade, watch);
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
  accumulate<Int>(state.h, state.h_step, f.h, watch);
  accumulate<Int>(state.fu, state.fu_step[steps], f.f, watch);
  accumulate<Int>(state.fv, state.fv_step[steps], f.f, watch);
  for (std::size_t c = 0; c < channel_count; ++c) {
    accumulate<Int>(state.shade[c], state.shade_step[steps][c], f.shade_acc, watch);
  }
  const int across = up - down;
  state.x += state.along_y ? across : 1;
  state.y += state.along_y ? 1 : across;
}

// The widest sums and products of the stage, also on the grids they are rounded to, over every exponent the
// reciprocal can deliver.
bool all_fit(const Config& config, const SpanStage& s) {
  const auto of = [&](FormatId id) { return signed_grid(config.format(id)); };
  const bool linear = has_linear_texture(config.perspective);
  const auto fits_on = [](Grid a, Grid grid) { return fits_int64(aligned(a, grid.fraction + 1)); };
  const Grid h = of(FormatId::span_h);
  const Grid f = of(linear ? FormatId::span_uv_acc : FormatId::span_f);
  const Grid f_step = of(linear ? FormatId::span_uv_step : FormatId::span_f_step);
  const Grid q = h + of(FormatId::setup_b);
  const Grid uv = of(FormatId::span_uv);
  const Grid shade = of(FormatId::span_shade_acc);
  bool fit = fits_on(h + of(FormatId::span_h_step), h) && fits_on(f + f_step, f) &&
             fits_on(shade + of(FormatId::span_shade_step), of(FormatId::span_shade)) && fits_int64(q) &&
             fits_on(f, uv);
  if (has_pixel_reciprocal(config.perspective)) {
    const Grid u1 = of(FormatId::edge_uv);
    const Grid change = f * signed_grid(config.pixel_reciprocal.output);
    const Exponents e = pixel_exponents(config, s.q);
    fit = fit && fits_on(u1 + scaled(change, e.low), uv) && fits_on(u1 + scaled(change, e.high), uv);
  }
  return fit;
}

}  // namespace

InverseDepth make_inverse_depth(const Config& config, const Constants& constants) {
  const Exact b = b_of(config, constants.record);
  const int h_fraction = config.format(FormatId::span_h).fraction();
  const int fraction = std::max(h_fraction, b.fraction);
  return {fraction - h_fraction, fraction, on_grid(b, fraction)};
}

Exponents pixel_exponents(const Config& config, const InverseDepth& q) {
  if (!config.pixel_reciprocal.normalize) {
    return {};
  }
  const Grid operand =
      signed_grid(config.format(FormatId::span_h)) + signed_grid(config.format(FormatId::setup_b));
  Exponents e = exponents_on(operand);
  if (!config.format(FormatId::span_h).is_signed)
    e.low = bit_length(static_cast<uint128>(q.b)) - 1 - q.fraction;
  return e;
}

SpanStage prepare_span(const Config& config, const Constants& constants) {
  SpanStage s;
  s.formats = span_formats(config);
  s.q = make_inverse_depth(config, constants);
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.divides_per_fragment = has_pixel_reciprocal(config.perspective)  ? 1
                           : has_pixel_quotients(config.perspective) ? 2
                                                                     : 0;
  s.subspan_bits = has_subspans(config) ? config.subspan_bits : 0;
  s.fits_int64 = all_fit(config, s);
  s.shade_fits_int64 = fits_int64(aligned(signed_grid(config.format(FormatId::span_shade_acc)),
                                          config.format(FormatId::span_shade).fraction() + 1));
  const SpanFormats& f = s.formats;
  const Exponents e = pixel_exponents(config, s.q);
  const int product = f.f.acc.fraction + f.reciprocal.output.fraction;
  const int finest = std::max(product + e.high, f.u1_fraction);
  const int growth = std::max(0, f.uv.fraction + 1 - std::max(product + e.low, f.u1_fraction));
  s.product_growth = f.reciprocal.output.word + std::max(0, f.u1_fraction - product - e.low) + growth;
  s.base_growth = finest - f.u1_fraction + growth;
  s.aligned = has_pixel_reciprocal(config.perspective) &&
              product + e.low >= std::max(f.u1_fraction, f.uv.fraction + 1) &&
              product + e.high <= f.uv.fraction + 62;
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
    if (geometry->is_line) {
      s.phase = geometry->phase;
    } else {
      s.coverage = &geometry->coverage;
    }
  }
  return s;
}

template <class Watch>
void span(const SpanStage& stage, SpanState& state, FragmentRecord& out, Watch watch) {
  if (stage.fits_int64) {
    span_on<std::int64_t>(stage, state, out, watch);
  } else {
    span_on<int128>(stage, state, out, watch);
  }
}

template void span(const SpanStage&, SpanState&, FragmentRecord&, NoObserve);
template void span(const SpanStage&, SpanState&, FragmentRecord&, Observe);

}  // namespace bitspan::model
