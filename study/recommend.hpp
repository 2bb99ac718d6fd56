// SPDX-License-Identifier: Apache-2.0
// Ends a study: says which of its points to recommend, and finds out all that the report says of those.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "study/plan.hpp"
#include "study/point.hpp"
#include "study/search/search.hpp"
#include "study/store.hpp"
#include "study/sweep.hpp"

namespace bitspan {

// Returns the keys of each axis of a search that does not move the cost: it is the same at the axis' smallest
// and largest value, with the others as in the base, and with the others at their widest. An axis is left out
// where the cost is known only after a measurement.
std::vector<std::string> idle_axes(const StudyPlan& plan, const std::vector<Scene>& scenes);

// Runs the plan's search over points that `runner` measures and keeps, and writes its steps and certificate.
// Cost and constraints may have "area.FAMILY.luts" (ffs, multipliers, memory_bits, fmax_mhz). Every point on
// which the constraints without areas hold is then synthesised, one after the other, and placed where a clock
// rate is asked for. The result is kept too. Throws InputError where there are
// categories, and every combination's widest point is refused.
SearchResult run_search(const StudyPlan& plan, PointRunner& runner, Store& store, const RunOptions& options,
                        const std::function<void(const SearchProgress&)>& progress);

struct Recommendation {
  std::string hash, reason;
};
// Returns what the study recommends. A sweep recommends the cheapest point on which all constraints hold, and
// the knee of error against cost where the points have one. A search recommends what it found. The result is
// empty where nothing holds.
std::vector<Recommendation> recommendations(const StudyPlan& plan, Store& store);
// Return the metrics that a study is judged by. The error is the first of the plan's metrics, or span.u.p999;
// the cost is the plan's.
std::string error_metric(const StudyPlan& plan);
std::string cost_metric(const StudyPlan& plan);

// Returns the point (x: cost, y: error, both positive) at the largest bend of the lower left front. It is the
// farthest one below the line between the front's ends, on logarithmic axes. There is none where the front
// has fewer than three points.
std::optional<std::size_t> knee(const std::vector<std::pair<double, double>>& points);

// Returns, for each constraint, the value that decides, the scene that has it, the margin, and on how many
// scenes it holds. Constraints on areas are left out, here and in validate().
std::vector<std::string> margin_lines(const StudyPlan& plan, PointMetrics measured);

struct Validation {
  std::size_t views = 0, held = 0;  // held: those on which all constraints hold
  std::vector<std::string> lines;
};
// Measures a recommended point on scenes that no point was chosen by, each alone, and judges every constraint
// on each. `load` makes the scenes of a name. Writes each value into the database. Throws InputError as
// `load` and PointMeter do, but for a refused scene, which counts as one that does not hold. `told` gets what
// is under way. lit, curves: as PointMeter has them.
Validation validate(const StudyPlan& plan, const Recommendation& point,
                    const std::function<std::vector<Scene>(const std::string&)>& load, Store& store,
                    const std::function<void(const std::string&)>& told, const std::stop_token& stop,
                    const LoadLit& lit = {}, const LoadCurves& curves = {});

struct Examination {
  bool held = true;
  std::vector<std::string> lines;  // what was found, for the command line
};
// Examines a recommended point on the study's scenes, stretched as the point's were. It writes what it finds
// into the database: whether model = golden = RTL, the pictures, and, where the plan asks for them, the error
// budget, proved bounds and areas. `told` gets what is under way. `held` is false where a view differs, or an
// observed error is above its bound. Throws InputError as the functions that it calls do.
Examination examine(const StudyPlan& plan, const Recommendation& point, std::vector<Scene> scenes,
                    Store& store, const std::function<void(const std::string&)>& told,
                    const std::stop_token& stop, const LoadLit& lit = {}, const LoadCurves& curves = {});

// Throws InputError where the plan asks for a budget or bounds of a scene that is drawn in passes.
void check_report(const StudyPlan& plan, const std::vector<Scene>& scenes);

}  // namespace bitspan
