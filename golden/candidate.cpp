// SPDX-License-Identifier: Apache-2.0
#include "golden/candidate.hpp"

#include "golden/depth.hpp"
#include "golden/packed_depth.hpp"

namespace bitspan::golden {
namespace {

bool is_behind(const Config& config, std::int64_t z, std::int64_t other) {
  if (!has_dz(config.depth_code)) return passes_depth(config.depth_code, DepthFunc::greater, z, other);
  return unpacked(z, config.depth_bits).z > unpacked(other, config.depth_bits).z;
}

}  // namespace

CandidateRecord candidate(const Config& config, const FragmentRecord& fragment, const DepthRecord& depth,
                          const TextureRecord& texture, const FogRecord& fog, Candidate& held) {
  CandidateRecord out;
  out.triangle = fragment.triangle;
  out.x = fragment.x;
  out.y = fragment.y;
  out.z = depth.z;
  const bool holds_one = held.a > 0;
  if (holds_one) out.held = held.z;
  if (holds_one && !is_behind(config, depth.z, held.z)) return out;
  out.taken = 1;
  held.triangle = fragment.triangle;
  held.z = depth.z;
  held.u = fragment.u;
  held.v = fragment.v;
  held.r = fog.r;
  held.g = fog.g;
  held.b = fog.b;
  held.a = texture.a;
  return out;
}

}  // namespace bitspan::golden
