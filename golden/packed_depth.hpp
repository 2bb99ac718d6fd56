// SPDX-License-Identifier: Apache-2.0
// The stored word of the depth code float_dz. docs/numeric-spec.md, "depth".
#pragma once

#include <algorithm>
#include <cstdint>

#include "config/modes.hpp"

namespace bitspan::golden {

struct PackedDepth {
  std::int64_t z = 0;
  int dz = 0;  // its binary logarithm
};

inline constexpr int last_octave = (1 << float_dz_exponent_bits) - 1;

// An octave of z, by the exponent of its codes: where it starts, and the steps of z within.
struct DepthOctave {
  std::int64_t start = 0, step = 1;
};
constexpr DepthOctave depth_octave(int exponent, int depth_bits) {
  const std::int64_t end = std::int64_t{1} << depth_bits;
  return {end - (end >> exponent), std::int64_t{1} << std::max(0, last_octave - 1 - exponent)};
}
// z: 0 .. 2^depth_bits - 1.
constexpr std::int64_t packed(PackedDepth depth, int depth_bits) {
  int exponent = last_octave;
  while (depth.z < depth_octave(exponent, depth_bits).start) --exponent;
  const auto [start, step] = depth_octave(exponent, depth_bits);
  const std::int64_t mantissas = std::int64_t{1} << (depth_bits - dz_bits - float_dz_exponent_bits);
  return (exponent * mantissas + (depth.z - start) / step) * (1 << dz_bits) + depth.dz;
}
constexpr PackedDepth unpacked(std::int64_t word, int depth_bits) {
  const std::int64_t mantissas = std::int64_t{1} << (depth_bits - dz_bits - float_dz_exponent_bits);
  const std::int64_t code = word / (1 << dz_bits);
  const auto [start, step] = depth_octave(static_cast<int>(code / mantissas), depth_bits);
  return {start + code % mantissas * step, static_cast<int>(word % (1 << dz_bits))};
}

}  // namespace bitspan::golden
