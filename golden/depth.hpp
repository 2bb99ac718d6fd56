// SPDX-License-Identifier: Apache-2.0
// Stage `depth`: a covered fragment's depth code and test. [D1, H6]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/frame.hpp"
#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// Takes fragments of one triangle, so each at a pixel of its own, its gradients (which float_dz alone reads),
// and the stored codes of the picture's rows in `grid`. Appends a record for each covered fragment.
using DepthStage =
    std::function<void(std::span<const FragmentRecord>, const GradientRecord&, const DrawState&,
                       std::span<const std::uint32_t> stored, PixelGrid grid, std::vector<DepthRecord>& out)>;
DepthStage make_depth(Arithmetic arithmetic, const Config& config, const Constants& constants);

// z + bias, held within the codes.
std::int64_t biased_code(std::int64_t z, std::int64_t bias, int depth_bits);
// The depth comparison of two codes, other than the words of float_dz.
bool passes_depth(DepthCode code, DepthFunc func, std::int64_t z, std::int64_t stored);

// Returns the code that the depth buffer holds before the first fragment.
std::int64_t clear_depth(const Config& config);

}  // namespace bitspan::golden
