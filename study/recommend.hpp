// What comes after a study's points: which of them to recommend, and all that its report says of those.
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

// Metrics that come from a configuration alone, beside those of the scenes, where the mode has RTL:
// "estimate.FAMILY.luts", ".ffs", ".multipliers"; "timing.pixel_unit", ".row_unit", ".span", clocks.
void add_estimates(const Config& config, std::map<std::string, double, std::less<>>& metrics);

// Runs the plan's search over points that `runner` measures and keeps, and writes its steps and certificate.
// A cost named "area.FAMILY.luts" (ffs, multipliers, memory_bits) is synthesised for every point on which the
// constraints hold, one after the other, and kept too.
SearchResult run_search(const StudyPlan& plan, PointRunner& runner, Store& store, const RunOptions& options,
                        const std::function<void(const SearchProgress&)>& progress);

struct Recommendation {
  std::string hash, reason;
};
// Of a sweep: the cheapest point on which all constraints hold, and the knee of error against cost, where the
// points have one. Of a search: what it found. None where nothing holds.
std::vector<Recommendation> recommendations(const StudyPlan& plan, Store& store);
// The metrics that a study is judged by: the first of the plan's, or span.u.p999; and its cost.
std::string error_metric(const StudyPlan& plan);
std::string cost_metric(const StudyPlan& plan);

// One of some points (x: cost, y: error, both positive): the end of the largest bend of the lower left front,
// as the farthest point below the line between its ends, on logarithmic axes. None where the front has fewer
// than three points.
std::optional<std::size_t> knee(const std::vector<std::pair<double, double>>& points);

struct Examination {
  bool held = true;
  std::vector<std::string> lines;  // what was found, for the command line
};
// Of a recommended point, on the study's scenes (stretched as the point's were): model = golden = RTL; the
// error budget, proved bounds and areas where the plan asks; its pictures. All of it into the database. told:
// what is under way. Not held: a view differs, or an observed error is above its bound. Throws InputError as
// what it calls.
Examination examine(const StudyPlan& plan, const Recommendation& point, std::vector<Scene> scenes,
                    Store& store, const std::function<void(const std::string&)>& told,
                    const std::stop_token& stop);

}  // namespace bitspan
