// SPDX-License-Identifier: Apache-2.0
#include "model/stages/lod.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/ratio.hpp"

namespace bitspan::model {
namespace {

// The distance and, of it, the level with its fraction.
template <class Watch>
Exact level_by_zone(const LodStage& stage, Exact inverse, int levels, LodRecord& out, Watch watch) {
  out.s = quantize(stage.a * inverse, stage.s, watch);
  const Exact s = value_of(out.s, stage.s);
  std::size_t zone = 0;
  const auto last = static_cast<std::size_t>(levels - 1);
  while (zone < last && sign_of(s - stage.zones[zone + 1].start) >= 0) ++zone;
  const Exact level{static_cast<std::int64_t>(zone), 0};
  if (zone == last) return level;
  const Exact into = (s - stage.zones[zone].start) * stage.zones[zone].k;
  return level + value_of(quantize(into, stage.frac, watch), stage.frac);
}

// The derivatives and, of the longest, its logarithm: the exponent, and the rest of it taken as linear.
template <class Watch>
Exact level_by_gradient(const LodStage& stage, Exact inverse, const FragmentRecord& fragment,
                        const GradientRecord& gradient, LodRecord& out, Watch watch) {
  const auto derivative = [&](std::int64_t g, std::int64_t h, std::int64_t w) {
    const Exact n = value_of(g, stage.g_grad) - value_of(w, stage.uv) * value_of(h, stage.h_grad);
    return quantize(n * inverse, stage.slope, watch);
  };
  out.u_x = derivative(gradient.gu_x, gradient.h_x, fragment.u);
  out.u_y = derivative(gradient.gu_y, gradient.h_y, fragment.u);
  out.v_x = derivative(gradient.gv_x, gradient.h_x, fragment.v);
  out.v_y = derivative(gradient.gv_y, gradient.h_y, fragment.v);
  uint128 rho = 1;  // one ulp, where all are 0
  for (const std::int64_t t : {out.u_x, out.u_y, out.v_x, out.v_y}) {
    rho = std::max(rho, static_cast<uint128>(t < 0 ? -int128{t} : int128{t}));
  }
  const int top = bit_length(rho) - 1;
  const int128 rest = static_cast<int128>(rho) - (int128{1} << top);
  return Exact{top - stage.slope.fraction, 0} + Exact{rest, top};
}

}  // namespace

template <class Watch>
LodStage prepare_lod(const Config& config, const Constants& constants, Watch watch) {
  LodStage s;
  s.mip = config.mip;
  s.mode = config.lod;
  s.b = b_of(config, constants.record);
  s.bias = {config.lod_bias, 4};
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.h = make_register(config, FormatId::span_h);
  s.uv = make_register(config, FormatId::span_uv);
  s.h_grad = make_register(config, FormatId::plane_h_grad);
  s.g_grad = make_register(config, FormatId::plane_g_grad);
  s.s = make_register(config, FormatId::distance_s);
  s.slope = make_register(config, FormatId::lod_slope);
  s.lambda = make_register(config, FormatId::lod_lambda);
  s.frac = make_register(config, FormatId::lod_frac);
  if (!has_lod_zones(config)) return s;
  const Register a = make_register(config, FormatId::distance_a);
  const Exact s_max = value_of(constants.record.s_max, make_register(config, FormatId::setup_s));
  s.a = value_of(quantize(s.b * s_max, a, watch), a);
  const Register k = make_register(config, FormatId::lod_k);
  for (std::size_t i = 0; i < s.zones.size(); ++i) {
    const Exact start = scaled(Exact{config.lod_first, 16}, -static_cast<int>(i));
    s.zones[i] = {start, value_of(quantize_ratio(Exact{1, 0}, start, k, watch), k)};
  }
  return s;
}

template <class Watch>
void lod(const LodStage& stage, const FragmentRecord& fragment, const GradientRecord* gradient, int levels,
         LodRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  const auto invert = [&] {
    const Inverse r = stage.reciprocal(value_of(fragment.h, stage.h) + stage.b, watch);
    out.recip_m = r.m;
    out.recip_e = r.e;
    return stage.reciprocal.value(r);
  };
  Exact level{0, 0};
  switch (stage.mode) {
    case LodMode::none:
      break;
    case LodMode::zone_s:
      level = level_by_zone(stage, invert(), levels, out, watch);
      break;
    case LodMode::gradient:
      level = level_by_gradient(stage, invert(), fragment, *gradient, out, watch);
      break;
  }
  out.lambda = quantize(level + stage.bias, stage.lambda, watch);
  Exact held = value_of(out.lambda, stage.lambda);
  const Exact last{levels - 1, 0};
  if (held.raw < 0) held = {0, 0};
  if (sign_of(held - last) > 0) held = last;
  if (mixes_levels(stage.mip)) {
    out.level = static_cast<std::int64_t>(floor_of(held));
    out.f = quantize(held - Exact{out.level, 0}, stage.frac, watch);
  } else {
    out.level = static_cast<std::int64_t>(floor_of(held + Exact{1, 1}));
  }
}

template LodStage prepare_lod(const Config&, const Constants&, NoObserve);
template LodStage prepare_lod(const Config&, const Constants&, Observe);
template void lod(const LodStage&, const FragmentRecord&, const GradientRecord*, int, LodRecord&, NoObserve);
template void lod(const LodStage&, const FragmentRecord&, const GradientRecord*, int, LodRecord&, Observe);

}  // namespace bitspan::model
