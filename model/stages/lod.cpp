// SPDX-License-Identifier: Apache-2.0
#include "model/stages/lod.hpp"

#include <algorithm>

#include "config/modes.hpp"
#include "model/numeric/log2.hpp"
#include "model/numeric/ratio.hpp"
#include "model/stages/distance.hpp"

namespace bitspan::model {
namespace {

// Of a distance, the level with its fraction.
template <class Watch>
Exact level_by_zone(const LodStage& stage, Exact distance, int levels, Watch watch) {
  std::size_t zone = 0;
  const auto last = static_cast<std::size_t>(levels - 1);
  while (zone < last && sign_of(distance - stage.zones[zone + 1].start) >= 0) ++zone;
  const Exact level{static_cast<std::int64_t>(zone), 0};
  if (zone == last) return level;
  const Exact into = (distance - stage.zones[zone].start) * stage.zones[zone].k;
  return level + value_of(quantize(into, stage.frac, watch), stage.frac);
}

// The derivatives, by a reciprocal along each axis, and, of the longest, its logarithm.
template <class Watch>
Exact level_by_gradient(const LodStage& stage, Exact inverse_x, Exact inverse_y,
                        const FragmentRecord& fragment, const GradientRecord& gradient, LodRecord& out,
                        Watch watch) {
  const auto derivative = [&](std::int64_t g, std::int64_t h, std::int64_t w, Exact inverse) {
    const Exact n = value_of(g, stage.g_grad) - value_of(w, stage.uv) * value_of(h, stage.h_grad);
    return quantize(n * inverse, stage.slope, watch);
  };
  out.u_x = derivative(gradient.gu_x, gradient.h_x, fragment.u, inverse_x);
  out.u_y = derivative(gradient.gu_y, gradient.h_y, fragment.u, inverse_y);
  out.v_x = derivative(gradient.gv_x, gradient.h_x, fragment.v, inverse_x);
  out.v_y = derivative(gradient.gv_y, gradient.h_y, fragment.v, inverse_y);
  uint128 rho = 1;  // one ulp, where all are 0
  for (const std::int64_t t : {out.u_x, out.u_y, out.v_x, out.v_y}) {
    rho = std::max(rho, static_cast<uint128>(t < 0 ? -int128{t} : int128{t}));
  }
  return linear_log2(rho, stage.slope.fraction);
}

}  // namespace

template <class Watch>
LodStage prepare_lod(const Config& config, const Constants& constants, Watch watch) {
  LodStage s;
  s.mip = config.mip;
  s.mode = config.lod;
  s.b = b_of(config, constants.record);
  set_lod(s, first_state(config));
  s.reciprocal = ReciprocalUnit(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.h = make_register(config, FormatId::span_h);
  s.uv = make_register(config, FormatId::span_uv);
  s.h_grad = make_register(config, FormatId::plane_h_grad);
  s.g_grad = make_register(config, FormatId::plane_g_grad);
  s.s = make_register(config, FormatId::distance_s);
  s.d = make_register(config, FormatId::distance_d);
  s.slope = make_register(config, FormatId::lod_slope);
  s.lambda = make_register(config, FormatId::lod_lambda);
  s.frac = make_register(config, FormatId::lod_frac);
  if (!has_lod_zones(config)) return s;
  s.a = distance_constant(config, constants, watch);
  const Register k = make_register(config, FormatId::lod_k);
  for (std::size_t i = 0; i < s.zones.size(); ++i) {
    const Exact start = scaled(Exact{config.lod_first, 16}, -static_cast<int>(i));
    s.zones[i] = {start, value_of(quantize_ratio(Exact{1, 0}, start, k, watch), k)};
  }
  return s;
}

void set_lod(LodStage& stage, const DrawState& state) {
  stage.bias = {state.texture_lod_bias, 4};
  stage.range = first_levels(state);
}

template <class Watch>
void lod(const LodStage& stage, const FragmentRecord& fragment, const GradientRecord* gradient,
         const DistanceRecord& distance, int levels, LodRecord& out, Watch watch) {
  out = {};
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  const auto invert = [&](Exact q) {
    const Inverse r = stage.reciprocal(q, watch);
    out.recip_m = r.m;
    out.recip_e = r.e;
    return stage.reciprocal.value(r);
  };
  const Exact q = value_of(fragment.h, stage.h) + stage.b;
  Exact level{0, 0};
  switch (stage.mode) {
    case LodMode::none:
      break;
    case LodMode::zone_s:
      out.s = quantize(stage.a * invert(q), stage.s, watch);
      level = level_by_zone(stage, value_of(out.s, stage.s), levels, watch);
      break;
    case LodMode::zone_d:
      level = level_by_zone(stage, value_of(distance.d, stage.d), levels, watch);
      break;
    case LodMode::gradient: {
      const Exact inverse = invert(q);
      level = level_by_gradient(stage, inverse, inverse, fragment, *gradient, out, watch);
      break;
    }
    case LodMode::finite: {
      // The record has the reciprocal of the pixel to the right.
      const Exact below = invert(q + value_of(gradient->h_y, stage.h_grad));
      const Exact right = invert(q + value_of(gradient->h_x, stage.h_grad));
      level = level_by_gradient(stage, right, below, fragment, *gradient, out, watch);
      break;
    }
  }
  out.lambda = quantize(level + stage.bias, stage.lambda, watch);
  hold_level(value_of(out.lambda, stage.lambda), stage.range, levels, mixes_levels(stage.mip), stage.frac,
             out, watch);
}

template <class Watch>
void hold_level(Exact lambda, const LevelRange& range, int levels, bool mixes, const Register& frac,
                LodRecord& out, Watch watch) {
  const LevelEnds ends = level_ends(range, levels);
  const Exact least{ends.least, 0}, greatest{ends.greatest, 0};
  Exact held = lambda;
  if (sign_of(held - least) < 0) held = least;
  if (sign_of(held - greatest) > 0) held = greatest;
  if (mixes) {
    out.level = static_cast<std::int64_t>(floor_of(held));
    out.f = quantize(held - Exact{out.level, 0}, frac, watch);
  } else {
    out.level = static_cast<std::int64_t>(floor_of(held + Exact{1, 1}));
  }
}

template LodStage prepare_lod(const Config&, const Constants&, NoObserve);
template LodStage prepare_lod(const Config&, const Constants&, Observe);
template void hold_level(Exact, const LevelRange&, int, bool, const Register&, LodRecord&, NoObserve);
template void hold_level(Exact, const LevelRange&, int, bool, const Register&, LodRecord&, Observe);
template void lod(const LodStage&, const FragmentRecord&, const GradientRecord*, const DistanceRecord&, int,
                  LodRecord&, NoObserve);
template void lod(const LodStage&, const FragmentRecord&, const GradientRecord*, const DistanceRecord&, int,
                  LodRecord&, Observe);

}  // namespace bitspan::model
