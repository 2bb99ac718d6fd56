// Stage `depth`: a covered fragment's depth code and test. [D1, H6]
#pragma once

#include <functional>

#include "config/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"

namespace bitspan::golden {

// (fragment, the code stored at its pixel)
using DepthStage = std::function<DepthRecord(const FragmentRecord&, std::int64_t)>;
DepthStage make_depth(Arithmetic arithmetic, const Config& config, const Constants& constants);

// What the depth buffer holds before the first fragment.
std::int64_t clear_depth(const Config& config);

}  // namespace bitspan::golden
