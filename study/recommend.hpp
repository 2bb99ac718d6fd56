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

// Adds the metrics that come from the configuration alone, estimate.* and timing.*, where the mode has RTL.
void add_estimates(const Config& config, std::map<std::string, double, std::less<>>& metrics);

// Runs the plan's search over points that `runner` measures and keeps, and writes its steps and certificate.
// A cost may be named "area.FAMILY.luts" (ffs, multipliers, memory_bits). Every point on which the
// constraints hold is then synthesised, one after the other, and the result is kept too. Throws InputError
// where there are categories, and every combination's widest point is refused.
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
                    const std::stop_token& stop);

}  // namespace bitspan
