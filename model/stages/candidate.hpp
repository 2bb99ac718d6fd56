// SPDX-License-Identifier: Apache-2.0
// candidate: the farthest translucent fragment of each pixel, which waits for its merge (T6).
// docs/numeric-spec.md, "candidate".
#pragma once

#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "model/stages/depth.hpp"

namespace bitspan::model {

// A fragment whose alpha lies between 0 and 1 against the candidate of its pixel, whose place it may take.
void candidate(const DepthFormats& formats, const FragmentRecord& fragment, const DepthRecord& depth,
               const TextureRecord& texture, const FogRecord& fog, Candidate& held, CandidateRecord& out);

// The records that merge takes of a candidate at its pixel.
struct HeldFragment {
  FragmentRecord fragment;
  DepthRecord depth;
  TextureRecord texture;
  FogRecord fog;
};
HeldFragment held_fragment(const Candidate& held, std::int64_t x, std::int64_t y);

}  // namespace bitspan::model
