// SPDX-License-Identifier: Apache-2.0
// Searches for word lengths: the cheapest point of a set of axes on which every constraint holds. It has the
// standard algorithms, and makes a certificate that no single step further down holds. docs/search.md says
// what each algorithm does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "study/axis.hpp"
#include "study/constraint.hpp"

namespace bitspan {

enum class SearchAlgorithm { min_plus_1, max_minus_1, greedy, annealing };
inline constexpr auto search_algorithms =
    std::to_array<std::string_view>({"min+1", "max-1", "greedy", "annealing"});  // in their order

inline constexpr const char* default_cost = "cost.register_bits";

struct SearchPlan {
  SearchAlgorithm algorithm = SearchAlgorithm::greedy;
  std::string cost = default_cost;  // a metric or an expression, to be as low as possible
  std::string tie = default_cost;   // the same, of points of equal cost
  double tie_within = 0;            // the share of the least cost by which costs may differ and be a tie
  int evaluations = 1000;           // at most
  double seconds = 600;             // at most
  std::uint64_t seed = 1;
  bool pairs = true;  // whether the certificate tries paired steps
  int measure = 10;   // points synthesised at the end, at most, where the cost is estimated
};

// One value per axis, as an index into Axis::values. 0 has the fewest bits.
using SearchPoint = std::vector<std::size_t>;
// Returns what a point sets on the base configuration, in the order of the axes and their keys.
std::vector<KeySetting> settings_of(const std::vector<Axis>& axes, const SearchPoint& point);

// What the caller found at a point.
struct Evaluation {
  bool refused = false;                   // no configuration, or too narrow for a scene
  std::string reason = {};                // of the refusal
  Metrics metrics = {};                   // over all scenes together
  std::vector<SceneMetrics> scenes = {};  // what constraints judge by default, where there are any
  bool missing = false;  // the caller was stopped before this point, which counts as never asked for
};
// Evaluates a batch at once, and returns the results in its order. The caller runs it on all cores. The
// search asks for no point twice. What this function throws passes through search().
using Evaluate = std::function<std::vector<Evaluation>(const std::vector<std::vector<KeySetting>>&)>;

// Returns the cost at a point that need not be evaluated, and NaN where the point has none.
using CostOf = std::function<double(const std::vector<KeySetting>&)>;

struct SearchStep {  // an evaluated point, in the order of evaluation
  SearchPoint point;
  double cost = 0;  // NaN where refused
  bool holds = false;
  bool best = false;  // the cheapest point so far that holds
};

enum class ReductionOutcome {
  fails,          // refused, or a constraint does not hold
  at_smallest,    // the axis has no smaller value
  costs_more,     // holds, at a higher cost or tie than the point
  passes,         // holds and costs no more, so the point is not minimal; a finished search has none
  not_evaluated,  // a limit came first
};

struct Reduction {  // one axis, one value down, all others as they are
  std::size_t axis = 0;
  std::string key;         // axis_title
  std::string from_value;  // axis_text
  std::string to_value;    // "" at the smallest
  SearchPoint point;       // the reduced point; the point itself at the smallest
  ReductionOutcome outcome = ReductionOutcome::not_evaluated;
  std::string text;  // what failed ("span.u.max is 0.31, at most 0.25"), the refusal, or a note
};

// One axis one value up and another two values down. Only such pairs count whose cost is lower than the
// point's, or is not known.
struct PairedStep {
  std::size_t up = 0, down = 0;  // the axes
  std::string key;               // "A up, B down"
  std::string from_values;       // of A and B
  std::string to_values;
  SearchPoint point;
  ReductionOutcome outcome = ReductionOutcome::not_evaluated;  // fails, passes or not_evaluated
  std::string text;
};

struct Certificate {
  bool point_holds = false;
  std::vector<Reduction> reductions;  // one per axis, in their order
  std::vector<PairedStep> pairs;  // the cheapest first where costs are known; empty where none are asked for
  std::vector<std::string> missing;  // what a limit left out of the reductions, one line each
  bool complete() const { return missing.empty(); }
  std::size_t pairs_missing() const;  // those that a limit left out
  // True where every reduction is evaluated, the point holds, none of its reductions holds at the same cost
  // or less, and no paired step that was evaluated holds.
  bool minimal() const;
};

enum class StoppedBy { done, evaluations, seconds, interrupt };  // a later one says more of a whole search
std::string_view to_string(StoppedBy reason);
std::string_view to_string(ReductionOutcome outcome);

// What was found for one combination of the categories.
struct Combination {
  std::string text;  // "reciprocal.pixel.kind = exact", one part per axis of categories
  bool found = false;
  bool refused = false;  // the widest point was
  SearchPoint point;     // empty where not found
  double cost = 0;       // of the point
  double tie = 0;        // of the point; infinite where the metric has no value
  std::size_t evaluations = 0;
  Certificate certificate;  // of the point, within the combination
  StoppedBy stopped_by = StoppedBy::done;
  std::string failing;    // what fails at the widest point, where nothing was found
  double cost_error = 0;  // the cost's ±, which run_search finds
};

struct SearchResult {
  bool found = false;
  bool refused = false;           // the widest point was; of several combinations, all were
  SearchPoint point;              // the best so far where a limit stopped the search; empty where not found
  double cost = 0;                // of the point
  double tie = 0;                 // as of a combination
  double cost_error = 0;          // its ±, which run_search finds
  std::size_t evaluations = 0;    // points asked for
  std::vector<SearchStep> steps;  // one per evaluation
  std::vector<std::string> failing;  // what fails at the widest point, where nothing was found
  Certificate certificate;           // of the point; empty where not found
  StoppedBy stopped_by = StoppedBy::done;
  std::vector<Combination> combinations;  // in the order of a grid; empty where no axis has categories
};

struct SearchProgress {
  std::string_view phase;  // "widest", "remove", "exchange", ...
  std::size_t evaluations = 0;
  double seconds = 0;
  bool found = false;
  double cost = 0;  // of the best so far, where found
};

// The search starts from the widest point. A point holds where it is not refused, every constraint's metric
// has a value within its limits, and the cost is finite. A NaN is within no limits. Constraints need not be
// monotone in the widths.
//
// A finished search ends on a point whose every single-step reduction fails, or costs more. With plan.pairs
// no paired step holds at a lower cost either; without `cost_of` every pair is evaluated for that. No point
// that it evaluated is better: a better point has the lower cost, then the lower tie, then fewer steps above
// the smallest, then the earlier axes narrower. With plan.tie_within the lowest tie among the points that
// cost at most that share more wins instead. The same plan and evaluations give the same result, whatever the
// number of cores.
//
// An axis of categories has no order. Each combination of categories is searched for itself, by the same
// algorithm from the same seed. The best of them, as above, is the answer. Each gets an equal part of the
// limits that are left.
//
// The search never passes plan.evaluations. It does not begin a batch that, judged by the slowest so far,
// would end after plan.seconds. On either limit, and on a stop request, the best point so far is the answer.
//
// Throws InputError where the axes, constraints or limits make no search. Throws it also where a metric does
// not exist at the first point that is not refused. A metric that is missing only later has no value there.
SearchResult search(const SearchPlan& plan, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const Evaluate& evaluate,
                    std::stop_token stop = {},
                    const std::function<void(const SearchProgress&)>& progress = {},
                    const CostOf& cost_of = {});

// Returns the certificate of any point, evaluated anew. It checks a result, or a point from elsewhere. Throws
// InputError as search() does, and for a point that is not on the axes.
Certificate certify(const std::string& cost_metric, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const SearchPoint& point,
                    const Evaluate& evaluate, const CostOf& cost_of = {});

// Returns the certificate as lines of text, for the command line and the report.
std::string to_text(const Certificate& certificate);

}  // namespace bitspan
