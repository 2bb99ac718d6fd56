// SPDX-License-Identifier: Apache-2.0
#include "model/stages/candidate.hpp"

#include "model/stages/depth-inl.hpp"

namespace bitspan::model {

void candidate(const DepthFormats& formats, const FragmentRecord& fragment, const DepthRecord& depth,
               const TextureRecord& texture, const FogRecord& fog, Candidate& held, CandidateRecord& out) {
  const bool is_empty = held.a == 0;
  const bool is_farther = HWY_NAMESPACE::depth_word_passes(formats, DepthFunc::greater, depth.z, held.z);
  out = {fragment.triangle,
         fragment.x,
         fragment.y,
         depth.z,
         is_empty ? 0 : held.z,
         is_empty || is_farther ? 1 : 0};
  if (out.taken == 0) return;
  held = {fragment.triangle, depth.z, fragment.u, fragment.v, fog.r, fog.g, fog.b, texture.a};
}

HeldFragment held_fragment(const Candidate& held, std::int64_t x, std::int64_t y) {
  HeldFragment out;
  const auto stand = [&](auto& record) {
    record.triangle = held.triangle;
    record.x = x;
    record.y = y;
  };
  stand(out.fragment);
  stand(out.depth);
  stand(out.texture);
  stand(out.fog);
  out.fragment.u = held.u;
  out.fragment.v = held.v;
  out.depth.z = held.z;
  out.texture.a = held.a;
  out.fog.r = held.r;
  out.fog.g = held.g;
  out.fog.b = held.b;
  return out;
}

}  // namespace bitspan::model
