// SPDX-License-Identifier: Apache-2.0
// Scenes that are drawn in translucency passes, judged by the layers of each pixel. docs/verify.md, "Layers".
//
// The judge needs the first pass alone, which has all triangles: what the others leave out shows.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/frame.hpp"
#include "golden/abuffer.hpp"
#include "report/visibility.hpp"
#include "scene/scene.hpp"

namespace bitspan {

// The scene without its passes, with the changes of state that hold in all of them. None where it is no such
// plan: a pass over opaque fragments, and then, with a resolve in front of each, passes that hold candidates.
std::optional<Scene> layered_picture_of(const Scene& scene);

// Why the lists do not judge a scene without its passes: a line that names the register. Empty where they do.
std::string layer_refusal(const Config& config, const Scene& picture);

// What the lists, which become sorted, find of each pixel of an engine that has drawn the passes. A pixel is
// a tie where two of its layers have one depth code; else its colour is equal, or unexplained.
std::vector<PixelFinding> layer_findings(const Config& config, const Scene& picture, golden::ABuffer& lists,
                                         const Frame& frame, std::string_view engine);
VisibilityReport layer_report(const Oracle& oracle, const Frame& frame, std::string_view engine,
                              std::vector<PixelFinding> findings);

// A line per layer of a pixel that a sorted list has, from the nearest one on.
std::vector<std::string> layers_text(const Config& config, const std::vector<golden::Layer>& layers);

}  // namespace bitspan
