// SPDX-License-Identifier: Apache-2.0
// lod: the level of detail of a fragment, from a distance's zone, or from the gradients of u and v or their
// differences to the next pixels.
// docs/numeric-spec.md, "lod" (T10, T11).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/numeric/quantize.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "scene/draw_state.hpp"

namespace bitspan::model {

struct LodStage {
  MipMode mip = MipMode::none;
  LodMode mode = LodMode::none;
  Exact b, a;        // B and A'
  Exact bias;        // of the draw state
  LevelRange range;  // of the draw state
  struct Zone {
    Exact start, k;
  };
  std::array<Zone, max_mip_level + 1> zones{};  // by level
  ReciprocalUnit reciprocal;                    // R_pixel
  Register h, uv, h_grad, g_grad;               // formats of the fragment and of the gradients
  Register s, d, slope, lambda, frac;
};
template <class Watch = NoObserve>
LodStage prepare_lod(const Config& config, const Constants& constants, Watch watch = {});

void set_lod(LodStage& stage, const DrawState& state);

// Whether lanes of 64 bits hold the logarithm, lambda and the level; only gradients come in lanes
// (model/simd/levels-inl.hpp), whose products may need 128 bits, and which tell it by their values.
inline bool fits_lanes(const LodStage& stage) {
  return has_gradients(stage.mode) && !has_neighbours(stage.mode) && stage.slope.word <= 50 &&
         std::abs(stage.slope.fraction) <= 64 && stage.lambda.word <= 40 && stage.lambda.fraction >= 0 &&
         stage.lambda.fraction <= 40 && stage.frac.fraction <= 40;
}

// The least and the greatest level in a chain of so many levels.
struct LevelEnds {
  std::int64_t least, greatest;
};
constexpr LevelEnds level_ends(const LevelRange& range, int levels) {
  const int last = levels - 1;
  const int least = std::min(range.least, last);
  return {least, std::max(least, std::min(range.greatest, last))};
}
// Whether a level of detail in that range, raw, is at most 0.
constexpr bool magnifies(const LevelRange& range, std::int64_t lambda) {
  return range.least == 0 && (lambda <= 0 || range.greatest == 0);
}

// The level and the fraction that lambda has in a chain of so many levels.
template <class Watch>
void hold_level(Exact lambda, const LevelRange& range, int levels, bool mixes, const Register& frac,
                LodRecord& out, Watch watch);

// A fragment that passed the depth test, of a texture with so many levels; gradient: of its triangle, null
// but in modes gradient and finite; distance: read in mode zone_d alone.
template <class Watch = NoObserve>
void lod(const LodStage& stage, const FragmentRecord& fragment, const GradientRecord* gradient,
         const DistanceRecord& distance, int levels, LodRecord& out, Watch watch = {});

}  // namespace bitspan::model
