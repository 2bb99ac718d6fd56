// SPDX-License-Identifier: Apache-2.0
// Runs one search. It has the points that the search knows, its limits, the steps that its algorithms share,
// and the algorithms. Each algorithm is in a file of its name.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "study/search/judgement.hpp"
#include "study/search/random.hpp"
#include "study/search/search.hpp"

namespace bitspan::searching {

inline constexpr std::size_t no_axis = std::numeric_limits<std::size_t>::max();

// Thrown where a limit ends the search.
struct Halt {
  StoppedBy reason;
};

// How a step down is chosen among those that hold.
enum class Pick {
  error,  // the one that uses least of the slack, whatever it saves (max-1 bit)
  ratio,  // the one that saves most for the slack that it uses
};

// Whether a step down may raise the cost. Synthesised area sometimes rises where a bit goes.
enum class Costs { any, falling };

class Searcher {
 public:
  Searcher(const SearchPlan& plan, const std::vector<Axis>& axes, const std::vector<Constraint>& constraints,
           const Evaluate& evaluate, const CostOf& cost_of, std::stop_token stop,
           const std::function<void(const SearchProgress&)>& progress);
  SearchResult run();
  Certificate certificate_for(const SearchPoint& p);

 private:
  // ---- Points, and what is known of them

  bool known(const SearchPoint& p) const { return memo_.contains(p); }
  const Judged& at(const SearchPoint& p) const { return memo_.at(p); }
  // Whether a is better than b; both hold. The lower cost decides, then the lower tie, then the fewer steps
  // above the smallest values, then the order of the axes. So exactly one evaluated point is the best.
  bool better(const SearchPoint& a, const SearchPoint& b) const;
  // Returns the points with one axis one value down. An axis at its smallest has none.
  std::vector<SearchPoint> reductions_of(const SearchPoint& p) const;
  static SearchPoint moved(SearchPoint p, std::size_t axis, std::ptrdiff_t by);
  void enter(std::string_view phase) { phase_ = phase; }
  double elapsed() const;
  // Returns how many of the wanted points may begin now. Throws Halt where a limit is reached.
  std::size_t allowed(std::size_t wanted) const;
  // Evaluates those of the points that are not known yet. Throws Halt where a limit comes first.
  void evaluate(const std::vector<SearchPoint>& points);
  void record(const SearchPoint& p, const Evaluation& e);

  // ---- Steps that the algorithms share

  // Whether the step from p to `a` is to be taken rather than the one to `b`.
  bool prefer(const SearchPoint& p, const SearchPoint& a, const SearchPoint& b, Pick pick) const;
  // Goes down by `stride` values of one axis at a time until no step holds. With Costs::falling it takes no
  // step that raises the cost. An axis that failed once is left out, because it seldom holds again with the
  // others lower still. finish() asks once more.
  SearchPoint descend(SearchPoint p, Pick pick, Costs costs, std::size_t stride,
                      std::size_t frozen = no_axis);
  // Returns the point of lowest tie among the evaluated ones that hold and cost at most plan_.tie_within more
  // than the best.
  SearchPoint least_of_near_ties() const;
  // Makes a point the best one, whatever others cost.
  void settle_on(const SearchPoint& p);
  // Goes from a point that holds to one whose single steps down all fail or cost more. No evaluated point is
  // better than the result.
  SearchPoint finish(SearchPoint p, Pick pick);
  // Tries the paired steps of a finished point, the cheapest first, and goes on from one that is better,
  // until none is.
  SearchPoint finish_pairs(SearchPoint p, Pick pick);
  // Evaluates the paired steps of p, and stops after a batch with one that is better.
  void evaluate_pairs(const SearchPoint& p);

  // ---- min+1 bit

  // Sung and Kum (docs/search.md has the titles) start from the least value of each axis with all others at
  // their widest. All those minima together are usually too small. They get one bit at a time, where it takes
  // most off the error, until the constraints hold. Bisection finds the minima here, with all axes in the
  // same batches.
  SearchPoint min_plus_1();
  // Returns the step up that holds and costs least. Where none holds, returns the one that takes most off the
  // violation. On a plateau, where no single value more helps, it tries steps of 2, 4, 8 ... values. Where
  // none of those helps, it takes one value more of everything. It ends at the widest point at the latest.
  SearchPoint raised(const SearchPoint& p);
  // Whether step up `a` is better than `b`. The one that holds is. Where both hold, the cost decides. Where
  // neither holds, the violation decides.
  bool above(const SearchPoint& a, const SearchPoint& b) const;

  // ---- max-1 bit

  // Goes down from the widest point, one bit at a time where it adds least to the error, until no bit can go.
  // The cost decides only between equals.
  SearchPoint max_minus_1();

  // ---- Greedy

  // Han and Evans take the step by the sensitivity of complexity and error together; Constantinides, Cheung
  // and Luk take the one that saves most area within the error's limit. This search removes what saves most
  // for the share of the remaining slack that it uses, in strides of 8, 4, 2 values and then one at a time.
  // Exchanges follow: one bit more in one place, where that saves bits that cost more in others.
  SearchPoint greedy();
  SearchPoint coarse_descent();
  // Looks for a point better than p, whose reductions are all known. It tries p with one axis up and another
  // down, and p with one axis down by two, past a value that fails by bad luck. Then it tries descents from p
  // with one axis held one value up.
  void exchange(const SearchPoint& p);

  // ---- Simulated annealing

  // Follows Kirkpatrick, Gelatt and Vecchi, from where the coarse descent ends. A move is one axis up or down
  // by one or two values, or two axes in opposite directions. The energy is the cost in units of a typical
  // step. Points that do not hold pay a penalty by their violation, so that ways around a wall exist. While
  // moves are rejected, several are drawn ahead and evaluated in one batch. The first accepted one counts, so
  // the outcome is that of one at a time.
  SearchPoint annealing();
  // Returns the mean change of cost among the known steps down from p, and 1 where there is none.
  double typical_step(const SearchPoint& p) const;
  SearchPoint random_move(const SearchPoint& p, const std::vector<std::size_t>& movable,
                          Random& random) const;
  void shift(SearchPoint& p, std::size_t axis, bool down, std::size_t by) const;

  // ---- The certificate, from what is known

  Certificate certificate_of(const SearchPoint& p) const;
  // Returns the paired steps of p that may lower its cost, with their points and axes.
  std::vector<PairedStep> pairs_of(const SearchPoint& p) const;
  void judge_pair(const SearchPoint& p, PairedStep& pair) const;
  void judge_reduction(const SearchPoint& p, Reduction& r) const;

  const SearchPlan& plan_;
  const std::vector<Axis>& axes_;
  const std::vector<Constraint>& constraints_;
  const Evaluate& evaluate_;
  const CostOf& cost_of_;
  std::stop_token stop_;
  const std::function<void(const SearchProgress&)>& progress_;
  std::size_t cores_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  SearchPoint top_;
  std::map<SearchPoint, Judged> memo_;
  std::vector<SearchStep> steps_;
  std::optional<SearchPoint> best_;
  std::string_view phase_;
  bool metrics_exist_ = false;
  StoppedBy cut_short_ =
      StoppedBy::done;        // a limit that ended a phase early, and left time for the certificate
  double slowest_round_ = 0;  // seconds for a point on each core
};

}  // namespace bitspan::searching
