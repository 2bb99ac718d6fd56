// SPDX-License-Identifier: Apache-2.0
// Curves by the unit forward_difference, against the cubics themselves. [C2]
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "model/stages/forward_difference.hpp"
#include "scene/generate/patch.hpp"
#include "scene/scene.hpp"
#include "study/metrics.hpp"

namespace bitspan {

// One coordinate of a curve in Bezier's form: its control points, in steps of a grid.
using ControlPoints = std::array<std::int64_t, 4>;

struct AdderCurve {
  std::vector<double> points;  // 2^k + 1 of them, in coordinates
  double worst = 0;            // how far the farthest of them is from the cubic, in coordinates
  bool misses_end = false;     // the last one is not the last control point
};
// stage: prepared for the fraction bits of the grid and for 2^k steps.
AdderCurve curve_by_adders(const model::ForwardDifferenceStage& stage, const ControlPoints& control,
                           int fraction);

// Curves that a study measures the unit by.
struct CurveSet {
  int fraction = 0;  // of the grid
  int k = 0;         // 2^k steps per curve
  std::vector<ControlPoints> curves;
};
// Rows and columns of the control points of all patches, each coordinate by itself. Throws InputError where
// the grid has no fraction bits.
CurveSet curves_of(const PatchSet& patches, int k);

// The curves of a scene of patches; none for another scene.
using LoadCurves = std::function<std::optional<CurveSet>(const Scene& scene)>;

// "curve.*". Throws InputError where a configuration's registers take no such curves (check_curve).
Metrics curve_metrics(const Config& config, const CurveSet& set);
// Adds those of another scene, so that they are of both.
void add_curve_metrics(const Metrics& of_scene, Metrics& all);

}  // namespace bitspan
