// One search: the points it knows, its limits, the steps that its algorithms share, and the algorithms, each
// in a file of its name.
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

// A limit ends the search from wherever it is.
struct Halt {
  StoppedBy reason;
};

// How a step down is chosen among those that hold.
enum class Pick {
  error,  // the one that uses least of the slack, whatever it saves: max-1 bit
  ratio,  // the one that saves most for the slack it uses
};

// Synthesised area goes up with a bit fewer now and then. On the long way down that is no reason to stop.
enum class Costs { any, falling };

class Searcher {
 public:
  Searcher(const SearchPlan& plan, const std::vector<Axis>& axes, const std::vector<Constraint>& constraints,
           const Evaluate& evaluate, std::stop_token stop,
           const std::function<void(const SearchProgress&)>& progress);
  SearchResult run();
  Certificate certificate_for(const SearchPoint& p);

 private:
  // ---- points, and what is known of them
  bool known(const SearchPoint& p) const { return memo_.contains(p); }
  const Judged& at(const SearchPoint& p) const { return memo_.at(p); }
  // Lower cost; at the same cost, closer to the smallest values; then in order, so that there is one best
  // point of those evaluated. Both hold.
  bool better(const SearchPoint& a, const SearchPoint& b) const;
  // Each axis one value down; none for an axis at its smallest.
  std::vector<SearchPoint> reductions_of(const SearchPoint& p) const;
  static SearchPoint moved(SearchPoint p, std::size_t axis, std::ptrdiff_t by);
  void enter(std::string_view phase) { phase_ = phase; }
  double elapsed() const;
  // How many points may be begun now, of those that are wanted.
  std::size_t allowed(std::size_t wanted) const;
  // Afterwards all of them are known, or Halt has been thrown.
  void evaluate(const std::vector<SearchPoint>& points);
  void record(const SearchPoint& p, const Evaluation& e);

  // ---- steps that the algorithms share
  // Is the step from p to `a` to be taken rather than the one to `b`?
  bool prefer(const SearchPoint& p, const SearchPoint& a, const SearchPoint& b, Pick pick) const;
  // Down by `stride` values of one axis at a time until none holds, or, with Costs::falling, none without a
  // higher cost. An axis that failed once is left out from then on: with the others lower still it seldom
  // holds again. finish() asks once more.
  SearchPoint descend(SearchPoint p, Pick pick, Costs costs, std::size_t stride,
                      std::size_t frozen = no_axis);
  // From a point that holds to one none of whose single steps down holds at the same cost or less, and that
  // no evaluated point is better than: such a step would be one.
  SearchPoint finish(SearchPoint p, Pick pick);

  // ---- min+1 bit
  // Sung and Kum (docs/search.md has the titles) start from the least value of each axis with all others at
  // their widest; all those minima together, which is too little as a rule, then get one bit at a time, where
  // it takes most off the error, until the constraints hold. Here the minima are found by bisection, all axes
  // in the same batches.
  SearchPoint min_plus_1();
  // The step up that holds and costs least; where none holds, the one that takes most off the violation. On a
  // plateau, where no single value more of anything helps, steps of 2, 4, 8 ... values; where none of those
  // helps, one value more of everything. So it ends at the widest point at the latest, which holds.
  SearchPoint raised(const SearchPoint& p);
  // Of two steps up: the one that holds, then lower cost where both do and less violation where neither does.
  bool above(const SearchPoint& a, const SearchPoint& b) const;

  // ---- max-1 bit
  // From the widest, one bit at a time where it adds least to the error, until no bit can go. The cost
  // decides only between equals.
  SearchPoint max_minus_1();

  // ---- greedy
  // The guided searches: Han and Evans take the step by the sensitivity of complexity and error together;
  // Constantinides, Cheung and Luk the one that saves most area while the error stays within its limit. Here:
  // remove what saves most for the share of the remaining slack that it uses, in strides of 8, 4, 2 values
  // while there is much slack, then one at a time. Then the way back up: one bit more in one place, where it
  // lets go of bits that cost more in others.
  SearchPoint greedy();
  SearchPoint coarse_descent();
  // Looks for a point better than p, whose reductions are all known, until one is the best: p with one axis
  // up and another down, or one axis down by two (past a value that fails by bad luck); then where a descent
  // from one axis up, held there, passes.
  void exchange(const SearchPoint& p);

  // ---- simulated annealing
  // Kirkpatrick, Gelatt and Vecchi, from where the coarse descent ends. A move is one axis up or down by one
  // or two values, or two axes in opposite directions. The energy is the cost, in units of a typical step's,
  // and for points that do not hold a penalty by their violation, so that ways around a wall exist. Moves are
  // drawn ahead and evaluated in one batch while they are being rejected; the first that is accepted counts,
  // so the outcome is that of one at a time.
  SearchPoint annealing();
  // The mean change of cost among the known steps down from p; 1 where there is none.
  double typical_step(const SearchPoint& p) const;
  SearchPoint random_move(const SearchPoint& p, const std::vector<std::size_t>& movable,
                          Random& random) const;
  void shift(SearchPoint& p, std::size_t axis, bool down, std::size_t by) const;

  // ---- the certificate, of what is known
  Certificate certificate_of(const SearchPoint& p) const;
  void judge_reduction(const SearchPoint& p, Reduction& r) const;
  const SearchPlan& plan_;
  const std::vector<Axis>& axes_;
  const std::vector<Constraint>& constraints_;
  const Evaluate& evaluate_;
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
