// SPDX-License-Identifier: Apache-2.0
// Scenes whose triangles stand for quadrics, judged by rays against the quadrics themselves. docs/verify.md,
// "Quadrics". [V2]
//
// Triangles lie in a shell around their quadric. Where a ray goes through all of it, the engine must show the
// body, or something nearer. Where it goes through a part of it, the engine may show the body, or what is
// behind. There is no other tolerance, but for the proved bounds of stored depths.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/frame.hpp"
#include "golden/oracle.hpp"
#include "report/visibility.hpp"

namespace bitspan {

// Whether an oracle judges quadrics of the scene. Vertices that give their depth have no distance to judge
// by.
bool judges_quadrics(const Oracle& oracle, const Visibility& visibility);

// visibility: of a scene with quadrics. oracle: of its triangles; picture: its picture of all of them. frame:
// of the engine. A pixel is `equal` where ray and engine see the same body and the triangle is in the shell;
// `edge` where they see two, as the shell allows; `tie` where two surfaces are as near as the bounds tell.
VisibilityReport quadric_report(const Visibility& visibility, const Oracle& oracle,
                                std::span<const Visible> picture, const Frame& frame,
                                std::string_view engine);

// The same of one pixel.
PixelFinding quadric_finding(const Visibility& visibility, const Oracle& oracle,
                             std::span<const Visible> picture, const Frame& frame, std::string_view engine,
                             std::int64_t x, std::int64_t y);

}  // namespace bitspan
