// SPDX-License-Identifier: Apache-2.0
// Oracles over a scene, by the proved bounds: what `verify`, `explain` and studies share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/registry.hpp"
#include "report/shadow_plan.hpp"
#include "report/visibility.hpp"

namespace bitspan {

// Returns the scene with its proved bounds, as oracles are compared over it. Where no oracle draws it, or no
// bound is known, there is none, and `why` says so in one line.
std::optional<Visibility> visibility_of(const Config& config, const Scene& scene, std::string& why);

// Why this oracle does not draw a scene that visibility_of takes; empty where it does.
std::string own_refusal(const Oracle& oracle, const Config& config, const Scene& scene);

// What rays from the light find of the shadows of an engine, which is made anew for it. picture, seen: as
// shadow_findings has them.
std::vector<PixelFinding> shadows_of(const Config& config, const ShadowPlan& plan,
                                     std::span<const Visible> picture, const VisibilityReport& seen,
                                     const EngineOptions& options);

// The same of a picture that an engine has drawn: by the oracle `ray`. frame: of the whole scene. Throws
// InputError where no oracle draws the picture, or no bound is known.
VisibilityReport judged_shadows(const Config& config, const ShadowPlan& plan, const Frame& frame,
                                std::string_view engine);

}  // namespace bitspan
