// SPDX-License-Identifier: Apache-2.0
// Stage `project`: where a fragment lies in a projector's texture, and its depth code from there. [T14, SH2]
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/records.hpp"
#include "golden/arithmetic.hpp"
#include "golden/constants.hpp"
#include "scene/scene.hpp"

namespace bitspan::golden {

// Takes fragments, the first of the channels in use of each where there are any, and the texture of the
// second unit; appends a record for each.
using ProjectStage =
    std::function<void(std::span<const FragmentRecord* const>, std::span<const FragmentChannelRecord* const>,
                       const Texture&, std::vector<ProjectRecord>& out)>;
ProjectStage make_project(Arithmetic arithmetic, const Config& config, const Constants& constants);

}  // namespace bitspan::golden
