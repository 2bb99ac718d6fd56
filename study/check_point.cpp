#include "study/check_point.hpp"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "config/rtl_timing.hpp"
#include "golden/engine_golden.hpp"
#include "model/engine_model.hpp"
#include "report/compare.hpp"
#include "report/lockstep.hpp"
#include "tb/engine_rtl.hpp"

namespace bitspan {
namespace {

using Make = std::function<std::unique_ptr<Engine>()>;

// Appends to the text. Returns whether all is equal and values were compared that are not trivial.
bool compare(const Make& reference, const Make& other, std::string_view what, std::span<const Scene> scenes,
             std::string& text) {
  std::uint64_t values = 0;
  std::uint64_t non_trivial = 0;
  text += fmt::format("{}{}: ", text.empty() ? "" : "; ", what);
  for (const Scene& scene : scenes) {
    std::vector<std::unique_ptr<Engine>> engines;
    engines.push_back(reference());
    engines.push_back(other());
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
  const Make model = [&] { return make_model(config); };
  out.held = compare([&] { return make_golden(config); }, model, "model = golden", scenes, out.text);
  if (!has_rtl(config)) {
    out.text += "; no RTL of this mode";
    return out;
  }
  out.held = compare(
                 model, [&] { return make_rtl(config); }, "model = rtl", scenes, out.text) &&
             out.held;
  return out;
}

}  // namespace bitspan
