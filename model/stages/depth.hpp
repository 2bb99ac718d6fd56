// SPDX-License-Identifier: Apache-2.0
// depth: the fragment's depth code and its test against the buffer. docs/numeric-spec.md, "depth" (D1, H6).
#pragma once

#include <algorithm>
#include <bit>
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
  int b_fraction = 0;            // of InverseDepth's b
  ReciprocalFormats reciprocal;  // R_pixel
  int c1_fraction = 0, c0_fraction = 0;
  int mantissa_bits = 0;      // of w_float
  int gradient_fraction = 0;  // of plane.h_grad, float_dz
  bool operator==(const DepthFormats&) const = default;
};
// Places below 1 that b and h keep where they make the code. Of w_float the highest bit counts, down to ones.
constexpr int q_fraction(DepthCode code, int b_fraction) {
  switch (code) {
    case DepthCode::w_float:
      return std::max(b_fraction, 0);
    case DepthCode::inverse:
    case DepthCode::linear:
    case DepthCode::opengl:
    case DepthCode::float_dz:
      return b_fraction;
  }
  unreachable();
}
constexpr DepthFormats depth_formats(const Config& config) {
  DepthFormats s;
  s.code = config.depth_code;
  s.nearer_is_larger = nearer_is_larger(config.depth_code);
  s.zmax = (std::int64_t{1} << config.depth_bits) - 1;
  s.h = make_register(config, FormatId::span_h);
  s.z = make_register(config.depth_format(), RegisterId::depth_z);
  s.b_fraction = std::max(s.h.fraction, config.format(FormatId::setup_b).fraction());
  s.q_fraction = q_fraction(s.code, s.b_fraction);
  s.h_up = s.q_fraction - s.h.fraction;
  s.reciprocal = reciprocal_formats(config.pixel_reciprocal, RegisterId::pixel_reciprocal);
  s.c1_fraction = config.format(FormatId::depth_c1).fraction();
  s.c0_fraction = config.format(FormatId::depth_c0).fraction();
  s.mantissa_bits = config.depth_bits - w_float_exponent_bits;
  if (has_dz(s.code)) s.gradient_fraction = config.format(FormatId::plane_h_grad).fraction();
  return s;
}

// The word of float_dz, of `bits` bits:
//
//   | exponent | mantissa | log2 of dz |     z: exponent ones, a zero, mantissa, and `dropped` bits
//   |    3     | bits - 7 |     4      |        (exponent 7: no zero)
struct PackedDepth {
  std::int64_t z = 0;
  int dz = 0;  // its binary logarithm
};
constexpr PackedDepth unpacked_depth(std::int64_t word, int bits) {
  const int mantissa_bits = bits - dz_bits - float_dz_exponent_bits;
  const auto exponent = static_cast<int>(word >> (bits - float_dz_exponent_bits));
  const int dropped = std::max(0, (1 << float_dz_exponent_bits) - 2 - exponent);
  const std::int64_t ones = ((std::int64_t{1} << exponent) - 1) << (bits - exponent);
  const std::int64_t mantissa = (word >> dz_bits) & ((std::int64_t{1} << mantissa_bits) - 1);
  return {ones | mantissa << dropped, static_cast<int>(word & largest_dz)};
}
constexpr std::int64_t packed_depth(PackedDepth depth, int bits) {
  const int mantissa_bits = bits - dz_bits - float_dz_exponent_bits;
  constexpr int last = (1 << float_dz_exponent_bits) - 1;
  const int ones = std::countl_one(static_cast<std::uint64_t>(depth.z) << (64 - bits));
  const int exponent = std::min(ones, last);
  const int dropped = std::max(0, last - 1 - exponent);
  const std::int64_t mantissa = (depth.z >> dropped) & ((std::int64_t{1} << mantissa_bits) - 1);
  return (std::int64_t{exponent} << mantissa_bits | mantissa) << dz_bits | depth.dz;
}

// Of a triangle, for float_dz: the smallest power of two that is not below |h_x| + |h_y|, as far as its
// logarithm is one of the word's.
int log2_of_dz(const DepthFormats& formats, const GradientRecord& gradient);

// What it computes by of the scene, raw.
struct DepthScene {
  int128 b = 0;                         // on the grid of h + B
  const std::int64_t* table = nullptr;  // of R_pixel
  std::int64_t c1 = 0, c0 = 0;
  // w_float, on the grid of h + B: 2^w_top is 2^K, and below w_far the code is zmax.
  int w_top = 0;
  int128 w_far = 0;
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

// A covered fragment against the buffer's code at its pixel. True where it passes (out.pass). gradient: the
// triangle's; may be null for all codes but float_dz.
template <class Watch = NoObserve>
bool depth(const DepthStage& stage, const FragmentRecord& fragment, const GradientRecord* gradient,
           std::int64_t stored, DepthRecord& out, Watch watch = {});

}  // namespace bitspan::model
