// SPDX-License-Identifier: Apache-2.0
#include "study/check_point.hpp"

#include <fmt/format.h>

#include <memory>
#include <string_view>
#include <vector>

#include "engine/registry.hpp"
#include "report/compare.hpp"
#include "report/lockstep.hpp"

namespace bitspan {
namespace {

// Appends the outcome to the text. Returns whether all values are equal and some of them are not trivial.
bool compare(std::string_view reference, std::string_view other, std::string_view what, const Config& config,
             std::span<const Scene> scenes, std::string& text) {
  std::uint64_t values = 0;
  std::uint64_t non_trivial = 0;
  text += fmt::format("{}{}: ", text.empty() ? "" : "; ", what);
  for (const Scene& scene : scenes) {
    std::vector<std::unique_ptr<Engine>> engines;
    for (const std::string_view name : {reference, other}) engines.push_back(make_engine(name, config));
    const LockStepResult run = run_lock_step(engines, scene, {});
    const Comparison& pair = run.pairs[0];
    if (!pair.held()) {
      text += fmt::format("differs on {}", scene.name);
      if (pair.first) text += fmt::format(", stage {}, field {}", pair.first->stage, pair.first->field);
      if (pair.first && pair.first->triangle) text += fmt::format(", triangle {}", *pair.first->triangle);
      if (!pair.fault.empty()) text += ": " + pair.fault;
      return false;
    }
    values += pair.total().values + pair.frame.values + pair.counters.values;
    if (engines[0]->counters().covered != 0) non_trivial += pair.total().non_trivial;
  }
  text += fmt::format("{} values equal", values);
  if (non_trivial == 0) text += ", none of them of a pixel: this says nothing";
  return non_trivial != 0;
}

}  // namespace

PointCheck check_point(const Config& config, std::span<const Scene> scenes) {
  PointCheck out;
  out.held = compare("golden", "model", "model = golden", config, scenes, out.text);
  if (!engine_runs("rtl", config)) {
    out.text += "; no RTL of this configuration";
    return out;
  }
  out.held = compare("model", "rtl", "model = rtl", config, scenes, out.text) && out.held;
  return out;
}

}  // namespace bitspan
