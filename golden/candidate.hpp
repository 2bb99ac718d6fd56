// SPDX-License-Identifier: Apache-2.0
// Stage `candidate`: the farthest translucent fragment of each pixel, until it is resolved. [T6]
#pragma once

#include "engine/frame.hpp"
#include "engine/records.hpp"

namespace bitspan::golden {

// Takes a fragment's records and what its pixel holds. `held` becomes what the pixel holds behind it.
CandidateRecord candidate(const Config& config, const FragmentRecord& fragment, const DepthRecord& depth,
                          const TextureRecord& texture, const FogRecord& fog, Candidate& held);

}  // namespace bitspan::golden
