// SPDX-License-Identifier: Apache-2.0
// depth: the fragment's depth code and its test against the buffer. docs/numeric-spec.md, "depth" (D1, H6).
#pragma once

#include <algorithm>
#include <cstdint>

#include "config/config.hpp"
#include "config/modes.hpp"
#include "engine/records.hpp"
#include "model/numeric/reciprocal.hpp"
#include "model/stages/constants.hpp"
#include "model/stages/span.hpp"

namespace bitspan::model {

// What the stage computes by, as far as the configuration alone says it.
struct DepthFormats {
  DepthCode code = DepthCode::inverse;
  bool nearer_is_larger = true;  // among codes
  std::int64_t zmax = 0;
  Register h, z;
  int h_up = 0, q_fraction = 0;  // of h + B, as in InverseDepth
  ReciprocalFormats reciprocal;  // R_pixel
  int c1_fraction = 0, c0_fraction = 0;
  bool operator==(const DepthFormats&) const = default;
};
constexpr DepthFormats depth_formats(const Config& config) {
  DepthFormats s;
  s.code = config.depth_code;
  s.nearer_is_larger = nearer_is_larger(config.depth_code);
  s.zmax = (std::int64_t{1} << config.depth_bits) - 1;
  s.h = make_register(config, FormatId::span_h);
  s.z = make_register(config.depth_format(), RegisterId::depth_z);
  s.q_fraction = std::max(s.h.fraction, config.format(FormatId::setup_b).fraction());
  s.h_up = s.q_fraction - s.h.fraction;
  s.reciprocal = reciprocal_formats(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.c1_fraction = config.format(FormatId::depth_c1).fraction();
  s.c0_fraction = config.format(FormatId::depth_c0).fraction();
  return s;
}

// What it computes by of the scene, raw.
struct DepthScene {
  int128 b = 0;                         // on the grid of h + B
  const std::int64_t* table = nullptr;  // of R_pixel
  std::int64_t c1 = 0, c0 = 0;
};

struct DepthStage {
  DepthFormats formats;
  DepthFunc func = DepthFunc::less;
  std::int64_t bias = 0;
  bool fits_int64 = false;  // z without a reciprocal, and all in front of it fits 63 bits
  std::int64_t clear = 0;   // what the buffer holds before the first triangle
  ReciprocalUnit reciprocal;
  DepthScene scene;
};
DepthStage prepare_depth(const Config& config, const Constants& constants);

// A covered fragment against the buffer's code at its pixel. True where it passes (out.pass).
template <class Watch = NoObserve>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, std::int64_t stored, DepthRecord& out,
           Watch watch = {});

}  // namespace bitspan::model
