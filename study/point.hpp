// SPDX-License-Identifier: Apache-2.0
// Measures one point of a study: a configuration on scenes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "engine/engine.hpp"
#include "scene/scene.hpp"
#include "study/curves.hpp"
#include "study/metrics.hpp"
#include "study/truths.hpp"

namespace bitspan {

// The error of one quantity of a stage against the unquantised truth (docs/numeric-spec.md, "ideal"), over
// all records of all scenes.
struct FieldError {
  std::string stage, quantity, unit;  // "span", "u", "texel"
  double ulp = 0;                     // of the format that holds it, in that unit; 0 where no format does
  std::uint64_t count = 0;
  double max = 0;  // the largest magnitude; the other statistics are among the metrics
};

// What a register held, over all scenes.
struct RegisterUse {
  std::string name;  // as in the configuration's formats: "span.h"
  Format format;
  std::uint64_t count = 0;
  double min = 0, max = 0;  // in its unit
  int used_bits = 0;        // integer bits, sign included, that min and max need
  int headroom = 0;         // integer bits of the format beyond them
  std::uint64_t wraps = 0, saturations = 0;
  // octave[i] counts the values with 2^(i-64) <= |value| < 2^(i-63). `zeros` counts those that are 0.
  std::uint64_t zeros = 0;
  std::array<std::uint64_t, 128> octave{};
};

struct PointResult {
  std::vector<FieldError> fields;
  std::vector<RegisterUse> registers;
  Metrics metrics;  // as PointMetrics::all
  std::vector<SceneMetrics> scenes;
};

// Returns a scene with a shadow map as a configuration compares it: its biases are codes of depth.bits.
using LoadLit = std::function<Scene(const Scene& scene, const Config& config)>;
// The scene itself where there is no loader, or nothing is drawn in passes.
Scene lit_for(Scene scene, const Config& config, const LoadLit& lit);

class PointMeter {
 public:
  // Keeps the scenes; what depends on them alone is computed once, where it fits in so many bytes. Of a scene
  // with a shadow map the picture is measured, and rays from the light judge it; there are no errors of
  // fields. Of a scene of patches the curves are measured, too. Throws InputError where there is no scene,
  // and where one is drawn in other passes.
  explicit PointMeter(std::vector<Scene> scenes, std::size_t truth_bytes = half_of_memory(), LoadLit lit = {},
                      const LoadCurves& curves = {});
  ~PointMeter();
  // May be called from several threads. Throws InputError where the configuration is illegal, is too narrow
  // for a scene (check_scene_range), or draws nothing of any scene. Without histograms RegisterUse::zeros and
  // octave stay 0.
  PointResult measure(const Config& config, bool histograms = true) const;
  // Returns the picture that `ideal` draws of a scene. It is drawn here only where no measurement has drawn
  // it already.
  std::shared_ptr<const Frame> ideal(const Config& config, std::size_t scene) const;
  const std::vector<Scene>& scenes() const { return scenes_; }

 private:
  std::vector<Scene> scenes_;
  std::vector<std::optional<CurveSet>> curves_;  // of each
  std::unique_ptr<Truths> truths_;
  LoadLit lit_;
};

}  // namespace bitspan
