#include "study/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

namespace bitspan {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

std::string key_text(const Axis& axis) { return joined(axis.keys, ", "); }

std::string value_text(const Axis& axis, std::size_t i) {
  std::vector<std::string> parts;
  for (const KeyValue& v : axis.values[i]) parts.push_back(to_string(v));
  return joined(parts, ", ");
}

std::string limits_text(const Constraint& c) {
  std::vector<std::string> parts;
  if (c.at_least) parts.push_back(fmt::format("at least {}", *c.at_least));
  if (c.at_most) parts.push_back(fmt::format("at most {}", *c.at_most));
  return joined(parts, ", ");
}

// What an evaluation says of a point.
struct Judged {
  bool refused = false;
  bool holds = false;
  double cost = kNaN;
  std::vector<double> values;  // of the constraints' metrics; NaN where there is none. Empty where refused
  std::string failure;         // the constraints that do not hold, or the refusal; empty where it holds
};

Judged judge(const Evaluation& e, const std::string& cost_metric,
             const std::vector<Constraint>& constraints) {
  Judged j;
  if (e.refused) {
    j.refused = true;
    j.failure = "refused: " + (e.reason.empty() ? std::string("no reason given") : e.reason);
    return j;
  }
  std::vector<std::string> failures;
  for (const Constraint& c : constraints) {
    const auto found = e.metrics.find(c.metric);
    const double value = found == e.metrics.end() ? kNaN : found->second;
    j.values.push_back(value);
    if (found == e.metrics.end()) {
      failures.push_back(fmt::format("{} has no value here, {}", c.metric, limits_text(c)));
    } else if (std::isnan(value) || !c.holds(value)) {
      failures.push_back(fmt::format("{} is {}, {}", c.metric,
                                     std::isnan(value) ? "not a number" : fmt::format("{}", value),
                                     limits_text(c)));
    }
  }
  const auto cost = e.metrics.find(cost_metric);
  if (cost == e.metrics.end()) {
    failures.push_back(fmt::format("the cost {} has no value here", cost_metric));
  } else if (!std::isfinite(cost->second)) {
    failures.push_back(fmt::format("the cost {} is not finite", cost_metric));
  } else {
    j.cost = cost->second;
  }
  j.holds = failures.empty();
  j.failure = joined(failures, "; ");
  return j;
}

// A metric that does not exist at all is a slip of the pen, not a constraint that fails.
void require_metrics(const Evaluation& e, const std::string& cost_metric,
                     const std::vector<Constraint>& constraints) {
  std::vector<std::string> known;
  for (const auto& [name, value] : e.metrics) known.push_back(name);
  const auto require = [&](const std::string& what, const std::string& name) {
    if (e.metrics.contains(name)) return;
    throw InputError(what + " \"" + name + "\" is no metric; nearest: " +
                     (known.empty() ? "none, there are no metrics" : comma_list(nearest_names(name, known))));
  };
  for (const Constraint& c : constraints) require("constraint", c.metric);
  require("search cost", cost_metric);
}

void check_axes(const std::vector<Axis>& axes) {
  if (axes.empty()) throw InputError("search: nothing varies; expected at least one [[vary]]");
  std::set<std::string> seen;
  for (const Axis& axis : axes) {
    const std::string name = key_text(axis);
    if (axis.keys.empty()) throw InputError("search: a [[vary]] without keys");
    if (axis.values.empty()) throw InputError("search: " + name + ": no values");
    for (const std::string& key : axis.keys) {
      if (!seen.insert(key).second) throw InputError("search: " + key + ": varies twice; expected once");
    }
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      if (axis.values[i].size() != axis.keys.size()) {
        throw InputError(fmt::format("search: {}: value {} has {} parts for {} keys", name, i + 1,
                                     axis.values[i].size(), axis.keys.size()));
      }
      if (std::find(axis.values.begin(), axis.values.begin() + static_cast<std::ptrdiff_t>(i),
                    axis.values[i]) != axis.values.begin() + static_cast<std::ptrdiff_t>(i)) {
        throw InputError("search: " + name + ": the value " + value_text(axis, i) + " twice");
      }
      const auto* now = std::get_if<std::int64_t>(&axis.values[i].front());
      const auto* before = i == 0 ? nullptr : std::get_if<std::int64_t>(&axis.values[i - 1].front());
      if (now != nullptr && before != nullptr && *now < *before) {
        throw InputError("search: " + name + ": " + value_text(axis, i - 1) + " before " +
                         value_text(axis, i) + "; expected values from few bits to many");
      }
    }
  }
}

void check_constraints(const std::vector<Constraint>& constraints) {
  if (constraints.empty()) {
    throw InputError("search: no [[constraint]]; without one the smallest value of every key is the answer");
  }
  for (const Constraint& c : constraints) {
    if (!c.at_most && !c.at_least) {
      throw InputError("constraint " + c.metric + ": no limit; expected at_most, at_least");
    }
    if ((c.at_most && std::isnan(*c.at_most)) || (c.at_least && std::isnan(*c.at_least))) {
      throw InputError("constraint " + c.metric + ": a limit is not a number");
    }
    if (c.at_most && c.at_least && *c.at_least > *c.at_most) {
      throw InputError(fmt::format("constraint {}: nothing is {}", c.metric, limits_text(c)));
    }
  }
}

void check_plan(const SearchPlan& plan) {
  if (plan.evaluations < 1) {
    throw InputError(fmt::format("search.evaluations is {}; expected 1 or more", plan.evaluations));
  }
  if (!(plan.seconds > 0)) {
    throw InputError(fmt::format("search.seconds is {}; expected more than 0", plan.seconds));
  }
}

// A limit's own size is what an excess is measured by; counts that must be 0 are measured in ones.
double scale_of(double limit) { return limit != 0 && std::isfinite(limit) ? std::abs(limit) : 1.0; }

// How far a point is from holding, in bits: each doubling of an excess is one, as each bit of a width doubles
// an error. 0 where every constraint holds; infinite where nothing is known.
double violation_of(const Judged& j, const std::vector<Constraint>& constraints) {
  if (j.refused || std::isnan(j.cost)) return kInfinity;
  double sum = 0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const double value = j.values[i];
    if (std::isnan(value)) return kInfinity;
    const auto add = [&sum](double excess, double limit) {
      if (excess > 0) sum += std::log2(1 + excess / scale_of(limit));
    };
    if (constraints[i].at_most) add(value - *constraints[i].at_most, *constraints[i].at_most);
    if (constraints[i].at_least) add(*constraints[i].at_least - value, *constraints[i].at_least);
  }
  return sum;
}

// The share of the room to the limits that a step from p to q takes, of the constraint that loses most; both
// hold. 0 where the step is free, on a plateau or with an error that falls.
double slack_used(const Judged& p, const Judged& q, const std::vector<Constraint>& constraints) {
  double most = 0;
  const auto side = [&most](double room_p, double room_q, double limit) {
    if (std::isnan(room_p) || std::isnan(room_q) || room_q >= room_p) return;  // infinite limits too
    const double used = std::isinf(room_p) ? 1 / (1 + room_q / scale_of(limit)) : (room_p - room_q) / room_p;
    most = std::max(most, std::min(used, 1.0));
  };
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Constraint& c = constraints[i];
    if (c.at_most) side(*c.at_most - p.values[i], *c.at_most - q.values[i], *c.at_most);
    if (c.at_least) side(p.values[i] - *c.at_least, q.values[i] - *c.at_least, *c.at_least);
  }
  return most;
}

std::size_t height_of(const SearchPoint& p) { return std::accumulate(p.begin(), p.end(), std::size_t{0}); }

// A limit ends the search from wherever it is.
struct Halt {
  StoppedBy reason;
};

// Reproducible everywhere: the standard distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return std::ldexp(static_cast<double>(engine_() >> 11), -53); }  // in [0, 1)
  std::size_t below(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(uniform() * static_cast<double>(n)));
  }

 private:
  std::mt19937_64 engine_;
};

// How a step down is chosen among those that hold.
enum class Pick {
  error,  // the one that uses least of the slack, whatever it saves: max-1 bit
  ratio,  // the one that saves most for the slack it uses
};

// Synthesised area goes up with a bit fewer now and then. On the long way down that is no reason to stop.
enum class Costs { any, falling };

class Search {
 public:
  Search(const SearchPlan& plan, const std::vector<Axis>& axes, const std::vector<Constraint>& constraints,
         const Evaluate& evaluate, std::stop_token stop,
         const std::function<void(const SearchProgress&)>& progress)
      : plan_(plan),
        axes_(axes),
        constraints_(constraints),
        evaluate_(evaluate),
        stop_(std::move(stop)),
        progress_(progress),
        cores_(std::max<std::size_t>(1, std::thread::hardware_concurrency())) {
    for (const Axis& axis : axes) top_.push_back(axis.values.size() - 1);
  }

  SearchResult run() {
    SearchResult result;
    try {
      enter("widest");
      evaluate({top_});
      if (at(top_).holds) {
        SearchPoint p = top_;
        switch (plan_.algorithm) {
          case SearchAlgorithm::min_plus_1:
            p = finish(min_plus_1(), Pick::error);
            break;
          case SearchAlgorithm::max_minus_1:
            p = finish(max_minus_1(), Pick::error);
            break;
          case SearchAlgorithm::greedy:
            p = greedy();
            break;
          case SearchAlgorithm::annealing:
            p = finish(annealing(), Pick::ratio);
            break;
        }
        best_ = p;
        result.stopped_by = cut_short_;
      }
    } catch (const Halt& halt) {
      result.stopped_by = halt.reason;
    }
    result.found = best_.has_value();
    if (result.found) {
      result.point = *best_;
      result.cost = at(*best_).cost;
      result.certificate = certificate_of(*best_);
    } else if (known(top_)) {
      result.failing.push_back("the widest point does not hold: " + at(top_).failure);
    } else {
      result.failing.emplace_back("stopped before the widest point was evaluated");
    }
    result.evaluations = steps_.size();
    result.steps = std::move(steps_);
    return result;
  }

  Certificate certificate_for(const SearchPoint& p) {
    enter("certificate");
    evaluate({p});
    evaluate(reductions_of(p));
    return certificate_of(p);
  }

 private:
  // ---- points, and what is known of them

  bool known(const SearchPoint& p) const { return memo_.contains(p); }
  const Judged& at(const SearchPoint& p) const { return memo_.at(p); }

  // Lower cost; at the same cost, closer to the smallest values; then in order, so that there is one best
  // point of those evaluated. Both hold.
  bool better(const SearchPoint& a, const SearchPoint& b) const {
    const double cost_a = at(a).cost, cost_b = at(b).cost;
    if (cost_a != cost_b) return cost_a < cost_b;
    const std::size_t height_a = height_of(a), height_b = height_of(b);
    return height_a != height_b ? height_a < height_b : a < b;
  }

  // Each axis one value down; none for an axis at its smallest.
  std::vector<SearchPoint> reductions_of(const SearchPoint& p) const {
    std::vector<SearchPoint> list;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p[i] > 0) list.push_back(moved(p, i, -1));
    }
    return list;
  }

  static SearchPoint moved(SearchPoint p, std::size_t axis, std::ptrdiff_t by) {
    p[axis] = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(p[axis]) + by);
    return p;
  }

  void enter(std::string_view phase) { phase_ = phase; }

  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  // How many points may be begun now, of those that are wanted.
  std::size_t allowed(std::size_t wanted) const {
    if (stop_.stop_requested()) throw Halt{StoppedBy::interrupt};
    const auto limit = static_cast<std::size_t>(plan_.evaluations);
    if (steps_.size() >= limit) throw Halt{StoppedBy::evaluations};
    std::size_t count = std::min(wanted, limit - steps_.size());
    const double left = plan_.seconds - elapsed();
    if (left <= 0) throw Halt{StoppedBy::seconds};
    if (slowest_round_ > 0) {
      const double rounds = std::floor(left / slowest_round_);
      if (rounds < 1) throw Halt{StoppedBy::seconds};
      const double most = rounds * static_cast<double>(cores_);
      if (most < static_cast<double>(count)) count = static_cast<std::size_t>(most);
    }
    return count;
  }

  // Afterwards all of them are known, or Halt has been thrown.
  void evaluate(const std::vector<SearchPoint>& points) {
    std::vector<SearchPoint> todo;
    std::set<SearchPoint> listed;
    for (const SearchPoint& p : points) {
      if (!known(p) && listed.insert(p).second) todo.push_back(p);
    }
    for (std::size_t first = 0; first < todo.size();) {
      const std::size_t count = allowed(todo.size() - first);
      std::vector<std::vector<KeySetting>> settings;
      for (std::size_t i = first; i < first + count; ++i) settings.push_back(settings_of(axes_, todo[i]));
      const double before = elapsed();
      const std::vector<Evaluation> found = evaluate_(settings);
      if (found.size() != count) {
        throw std::logic_error(fmt::format("evaluate: {} results for {} points", found.size(), count));
      }
      bool missing = false;
      for (std::size_t i = 0; i < count; ++i) {
        if (found[i].missing) {
          missing = true;
        } else {
          record(todo[first + i], found[i]);
        }
      }
      const std::size_t rounds = (count + cores_ - 1) / cores_;
      slowest_round_ = std::max(slowest_round_, (elapsed() - before) / static_cast<double>(rounds));
      if (progress_) {
        progress_({phase_, steps_.size(), elapsed(), best_.has_value(), best_ ? at(*best_).cost : kNaN});
      }
      if (missing) throw Halt{StoppedBy::interrupt};
      first += count;
    }
  }

  void record(const SearchPoint& p, const Evaluation& e) {
    if (!metrics_exist_ && !e.refused) {
      require_metrics(e, plan_.cost, constraints_);
      metrics_exist_ = true;
    }
    const Judged& j = memo_.emplace(p, judge(e, plan_.cost, constraints_)).first->second;
    const bool best = j.holds && (!best_ || better(p, *best_));
    if (best) best_ = p;
    steps_.push_back({p, j.cost, j.holds, best});
  }

  // ---- steps that the algorithms share

  // Is the step from p to `a` to be taken rather than the one to `b`?
  bool prefer(const SearchPoint& p, const SearchPoint& a, const SearchPoint& b, Pick pick) const {
    const double gain_a = at(p).cost - at(a).cost, gain_b = at(p).cost - at(b).cost;
    const double used_a = slack_used(at(p), at(a), constraints_),
                 used_b = slack_used(at(p), at(b), constraints_);
    if (pick == Pick::error) return used_a != used_b ? used_a < used_b : gain_a > gain_b;
    // Free steps come first, the largest gain among them before the others.
    constexpr double least = 1e-9;
    const double ratio_a = gain_a / std::max(used_a, least), ratio_b = gain_b / std::max(used_b, least);
    return ratio_a != ratio_b ? ratio_a > ratio_b : used_a < used_b;
  }

  // Down by `stride` values of one axis at a time until none holds, or, with Costs::falling, none without a
  // higher cost. An axis that failed once is left out from then on: with the others lower still it seldom
  // holds again. finish() asks once more.
  SearchPoint descend(SearchPoint p, Pick pick, Costs costs, std::size_t stride, std::size_t frozen = kNone) {
    std::vector<bool> open(p.size(), true);
    if (frozen != kNone) open[frozen] = false;
    for (;;) {
      std::vector<std::pair<std::size_t, SearchPoint>> steps;
      std::vector<SearchPoint> points;
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (!open[i] || p[i] == 0) continue;
        points.push_back(moved(p, i, -static_cast<std::ptrdiff_t>(std::min(stride, p[i]))));
        steps.emplace_back(i, points.back());
      }
      evaluate(points);
      const SearchPoint* chosen = nullptr;
      for (const auto& [axis, q] : steps) {
        if (!at(q).holds || (costs == Costs::falling && at(q).cost > at(p).cost)) {
          open[axis] = false;
        } else if (chosen == nullptr || prefer(p, q, *chosen, pick)) {
          chosen = &q;
        }
      }
      if (chosen == nullptr) return p;
      p = SearchPoint(*chosen);
    }
  }

  // From a point that holds to one none of whose single steps down holds at the same cost or less, and that
  // no evaluated point is better than: such a step would be one.
  SearchPoint finish(SearchPoint p, Pick pick) {
    enter("certificate");
    for (;;) {
      p = descend(std::move(p), pick, Costs::falling, 1);
      evaluate(reductions_of(p));
      if (!better(*best_, p)) return p;
      p = *best_;
    }
  }

  // ---- min+1 bit

  // Sung and Kum (docs/search.md has the titles) start from the least value of each axis with all others at
  // their widest; all those minima together, which is too little as a rule, then get one bit at a time, where
  // it takes most off the error, until the constraints hold. Here the minima are found by bisection, all axes
  // in the same batches.
  SearchPoint min_plus_1() {
    enter("minimum of each");
    SearchPoint least = top_;
    std::vector<std::ptrdiff_t> fails(top_.size(), -1);
    for (;;) {
      std::vector<std::size_t> asked;
      std::vector<SearchPoint> points;
      for (std::size_t i = 0; i < top_.size(); ++i) {
        const auto above = static_cast<std::ptrdiff_t>(least[i]);
        if (above - fails[i] < 2) continue;
        SearchPoint q = top_;
        q[i] = static_cast<std::size_t>(fails[i] + (above - fails[i]) / 2);
        asked.push_back(i);
        points.push_back(std::move(q));
      }
      if (points.empty()) break;
      evaluate(points);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const std::size_t i = asked[k];
        if (at(points[k]).holds) {
          least[i] = points[k][i];
        } else {
          fails[i] = static_cast<std::ptrdiff_t>(points[k][i]);
        }
      }
    }
    enter("add");
    SearchPoint p = least;
    evaluate({p});
    while (!at(p).holds) p = raised(p);
    return p;
  }

  // The step up that holds and costs least; where none holds, the one that takes most off the violation. On a
  // plateau, where no single value more of anything helps, steps of 2, 4, 8 ... values; where none of those
  // helps, one value more of everything. So it ends at the widest point at the latest, which holds.
  SearchPoint raised(const SearchPoint& p) {
    const double violation = violation_of(at(p), constraints_);
    const std::size_t longest = *std::ranges::max_element(top_);
    for (std::size_t stride = 1; stride <= longest; stride *= 2) {
      std::vector<SearchPoint> points;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const std::size_t before = stride == 1 ? p[i] : std::min(top_[i], p[i] + stride / 2);
        const std::size_t now = std::min(top_[i], p[i] + stride);
        if (now > before) points.push_back(moved(p, i, static_cast<std::ptrdiff_t>(now - p[i])));
      }
      evaluate(points);
      const SearchPoint* chosen = nullptr;
      for (const SearchPoint& q : points) {
        const double v = violation_of(at(q), constraints_);
        if (!at(q).holds && !(v < violation)) continue;
        if (chosen == nullptr || above(q, *chosen)) chosen = &q;
      }
      if (chosen != nullptr) return *chosen;
    }
    SearchPoint all = p;
    for (std::size_t i = 0; i < p.size(); ++i) all[i] = std::min(top_[i], p[i] + 1);
    evaluate({all});
    return all;
  }

  // Of two steps up: the one that holds, then lower cost where both do and less violation where neither does.
  bool above(const SearchPoint& a, const SearchPoint& b) const {
    if (at(a).holds != at(b).holds) return at(a).holds;
    if (at(a).holds) return better(a, b);
    const double violation_a = violation_of(at(a), constraints_),
                 violation_b = violation_of(at(b), constraints_);
    return violation_a != violation_b ? violation_a < violation_b : at(a).cost < at(b).cost;
  }

  // ---- max-1 bit

  // From the widest, one bit at a time where it adds least to the error, until no bit can go. The cost
  // decides only between equals.
  SearchPoint max_minus_1() {
    enter("remove");
    return descend(top_, Pick::error, Costs::any, 1);
  }

  // ---- greedy

  // The guided searches: Han and Evans take the step by the sensitivity of complexity and error together;
  // Constantinides, Cheung and Luk the one that saves most area while the error stays within its limit. Here:
  // remove what saves most for the share of the remaining slack that it uses, in strides of 8, 4, 2 values
  // while there is much slack, then one at a time. Then the way back up: one bit more in one place, where it
  // lets go of bits that cost more in others.
  SearchPoint greedy() {
    SearchPoint p = finish(coarse_descent(), Pick::ratio);
    for (;;) {
      enter("exchange");
      exchange(p);
      if (!better(*best_, p)) return p;
      p = finish(*best_, Pick::ratio);
    }
  }

  SearchPoint coarse_descent() {
    enter("remove");
    SearchPoint p = top_;
    const std::size_t longest = *std::ranges::max_element(top_);
    for (std::size_t stride = std::bit_floor(std::max<std::size_t>(1, longest / 2)); stride > 1;
         stride /= 2) {
      p = descend(std::move(p), Pick::ratio, Costs::any, stride);
    }
    return descend(std::move(p), Pick::ratio, Costs::any, 1);
  }

  // Looks for a point better than p, whose reductions are all known, until one is the best: p with one axis
  // up and another down, or one axis down by two (past a value that fails by bad luck); then where a descent
  // from one axis up, held there, passes.
  void exchange(const SearchPoint& p) {
    const double cost = at(p).cost;
    std::vector<std::pair<std::size_t, SearchPoint>> ups;
    std::vector<SearchPoint> points;
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p[i] == top_[i]) continue;
      points.push_back(moved(p, i, 1));
      ups.emplace_back(i, points.back());
    }
    evaluate(points);

    // Costs add up nearly enough to say which pairs are worth an evaluation.
    std::vector<std::pair<double, SearchPoint>> pairs;
    for (std::size_t j = 0; j < p.size(); ++j) {
      if (p[j] == 0) continue;
      const double down = at(moved(p, j, -1)).cost;
      if (std::isnan(down)) continue;
      if (p[j] > 1) pairs.emplace_back(2 * down - cost, moved(p, j, -2));
      for (const auto& [i, up] : ups) {
        const double expected = at(up).cost + down - cost;
        if (i != j && expected < cost) pairs.emplace_back(expected, moved(up, j, -1));
      }
    }
    std::ranges::stable_sort(pairs, {}, &std::pair<double, SearchPoint>::first);
    constexpr std::size_t batch = 16;  // of any machine: the result does not depend on the cores
    for (std::size_t first = 0; first < pairs.size(); first += batch) {
      points.clear();
      for (std::size_t k = first; k < std::min(first + batch, pairs.size()); ++k)
        points.push_back(pairs[k].second);
      evaluate(points);
      if (better(*best_, p)) return;
    }

    std::erase_if(ups, [&](const auto& up) { return !at(up.second).holds; });
    std::ranges::stable_sort(
        ups, [&](const auto& a, const auto& b) { return at(a.second).cost < at(b.second).cost; });
    for (const auto& [i, up] : ups) {
      descend(up, Pick::ratio, Costs::any, 1, i);
      if (better(*best_, p)) return;
    }
  }

  // ---- simulated annealing

  // Kirkpatrick, Gelatt and Vecchi, from where the coarse descent ends. A move is one axis up or down by one
  // or two values, or two axes in opposite directions. The energy is the cost, in units of a typical step's,
  // and for points that do not hold a penalty by their violation, so that ways around a wall exist. Moves are
  // drawn ahead and evaluated in one batch while they are being rejected; the first that is accepted counts,
  // so the outcome is that of one at a time.
  SearchPoint annealing() {
    SearchPoint p = coarse_descent();
    enter("anneal");
    std::vector<std::size_t> movable;
    for (std::size_t i = 0; i < top_.size(); ++i) {
      if (top_[i] > 0) movable.push_back(i);
    }
    if (movable.empty()) return p;
    evaluate(reductions_of(p));
    const double unit = typical_step(p);
    // One bit fewer everywhere saves a step of each axis and costs one bit of violation: that must not pay.
    const double penalty = 1.5 * static_cast<double>(movable.size());
    const auto energy = [&](const SearchPoint& q) {
      const double violation = violation_of(at(q), constraints_);
      return at(q).cost / unit + (at(q).holds ? 0.0 : 0.5 + penalty * violation);
    };

    // What is left goes to the moves but for a third, which the way down to a certificate may take.
    const auto limit = static_cast<std::size_t>(plan_.evaluations);
    const std::size_t used = std::min(steps_.size(), limit);
    const std::size_t budget = (limit - used) * 2 / 3;
    const std::size_t most_moves = 8 * budget;
    constexpr double hot = 1.0, cold = 0.05;  // in typical steps
    constexpr std::size_t widest_batch = 8;
    const std::size_t frozen =
        40 * movable.size();  // rejections in a row: every move was drawn several times
    Random random(plan_.seed);
    SearchPoint best = p;
    for (std::size_t moves = 0, rejected = 0; moves < most_moves && rejected < frozen;) {
      const std::size_t made = steps_.size() - used;
      if (made >= budget) break;
      if (elapsed() > plan_.seconds * 2 / 3) {  // of the seconds the same share
        cut_short_ = StoppedBy::seconds;
        break;
      }
      std::vector<SearchPoint> drawn;
      std::vector<double> lots;
      const std::size_t ahead = std::min({widest_batch, 1 + rejected, budget - made});
      while (drawn.size() < ahead) {
        drawn.push_back(random_move(p, movable, random));
        lots.push_back(random.uniform());
      }
      evaluate(drawn);
      const double done = std::max(static_cast<double>(moves) / static_cast<double>(most_moves),
                                   static_cast<double>(made) / static_cast<double>(budget));
      const double temperature = hot * std::pow(cold / hot, done);
      for (std::size_t k = 0; k < drawn.size(); ++k) {
        ++moves;
        const double rise = energy(drawn[k]) - energy(p);
        // A point of unknown energy (refused) rises by NaN or infinity and is never accepted.
        if (drawn[k] != p && (rise <= 0 || lots[k] < std::exp(-rise / temperature))) {
          p = drawn[k];
          rejected = 0;
          if (at(p).holds && better(p, best)) best = p;
          break;
        }
        ++rejected;
      }
    }
    return best;
  }

  // The mean change of cost among the known steps down from p; 1 where there is none.
  double typical_step(const SearchPoint& p) const {
    double sum = 0;
    int count = 0;
    for (const SearchPoint& q : reductions_of(p)) {
      const double change = std::abs(at(p).cost - at(q).cost);
      if (!(change > 0)) continue;
      sum += change;
      ++count;
    }
    return count == 0 ? 1.0 : sum / count;
  }

  SearchPoint random_move(const SearchPoint& p, const std::vector<std::size_t>& movable,
                          Random& random) const {
    SearchPoint q = p;
    const bool down = random.uniform() < 0.5;
    const std::size_t size = random.uniform() < 0.9 ? 1 : 2;
    const std::size_t first = movable[random.below(movable.size())];
    const bool pair = random.uniform() < 0.6;
    const std::size_t second = movable[random.below(movable.size())];
    shift(q, first, down, size);
    if (pair && second != first) shift(q, second, !down, 1);
    return q;
  }

  void shift(SearchPoint& p, std::size_t axis, bool down, std::size_t by) const {
    p[axis] = down ? p[axis] - std::min(by, p[axis]) : std::min(top_[axis], p[axis] + by);
  }

  // ---- the certificate, of what is known

  Certificate certificate_of(const SearchPoint& p) const {
    Certificate c;
    c.point_holds = known(p) && at(p).holds;
    for (std::size_t i = 0; i < p.size(); ++i) {
      Reduction r;
      r.axis = i;
      r.key = key_text(axes_[i]);
      r.from_value = value_text(axes_[i], p[i]);
      r.point = p;
      if (p[i] == 0) {
        r.outcome = ReductionOutcome::at_smallest;
        r.text = "at its smallest";
        c.reductions.push_back(std::move(r));
        continue;
      }
      r.point = moved(p, i, -1);
      r.to_value = value_text(axes_[i], r.point[i]);
      judge_reduction(p, r);
      if (r.outcome == ReductionOutcome::not_evaluated) {
        c.missing.push_back(
            fmt::format("{} from {} to {} was not evaluated", r.key, r.from_value, r.to_value));
      }
      c.reductions.push_back(std::move(r));
    }
    return c;
  }

  void judge_reduction(const SearchPoint& p, Reduction& r) const {
    if (!known(r.point)) {
      r.text = "not evaluated";
      return;
    }
    const Judged& j = at(r.point);
    if (!j.holds) {
      r.outcome = ReductionOutcome::fails;
      r.text = j.failure;
    } else if (j.cost <= at(p).cost) {
      r.outcome = ReductionOutcome::passes;
      r.text = fmt::format("holds; {} is {} against {}", plan_.cost, j.cost, at(p).cost);
    } else {
      r.outcome = ReductionOutcome::costs_more;
      r.text = fmt::format("holds, but {} rises from {} to {}", plan_.cost, at(p).cost, j.cost);
    }
  }

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

}  // namespace

std::vector<KeySetting> settings_of(const std::vector<Axis>& axes, const SearchPoint& point) {
  std::vector<KeySetting> settings;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t k = 0; k < axes[i].keys.size(); ++k) {
      settings.push_back({axes[i].keys[k], axes[i].values[point[i]][k]});
    }
  }
  return settings;
}

bool Certificate::minimal() const {
  return point_holds && complete() && std::ranges::none_of(reductions, [](const Reduction& r) {
           return r.outcome == ReductionOutcome::passes || r.outcome == ReductionOutcome::not_evaluated;
         });
}

std::string_view to_string(StoppedBy reason) {
  switch (reason) {
    case StoppedBy::done:
      return "done";
    case StoppedBy::evaluations:
      return "evaluations";
    case StoppedBy::seconds:
      return "seconds";
    case StoppedBy::interrupt:
      return "interrupt";
  }
  return "?";
}

std::string_view to_string(ReductionOutcome outcome) {
  switch (outcome) {
    case ReductionOutcome::fails:
      return "fails";
    case ReductionOutcome::at_smallest:
      return "at its smallest";
    case ReductionOutcome::costs_more:
      return "costs more";
    case ReductionOutcome::passes:
      return "passes";
    case ReductionOutcome::not_evaluated:
      return "not evaluated";
  }
  return "?";
}

SearchResult search(const SearchPlan& plan, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const Evaluate& evaluate,
                    std::stop_token stop, const std::function<void(const SearchProgress&)>& progress) {
  check_plan(plan);
  check_axes(axes);
  check_constraints(constraints);
  return Search(plan, axes, constraints, evaluate, std::move(stop), progress).run();
}

Certificate certify(const std::string& cost_metric, const std::vector<Axis>& axes,
                    const std::vector<Constraint>& constraints, const SearchPoint& point,
                    const Evaluate& evaluate) {
  check_axes(axes);
  check_constraints(constraints);
  if (point.size() != axes.size()) {
    throw InputError(fmt::format("certificate: a point of {} values for {} axes", point.size(), axes.size()));
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (point[i] < axes[i].values.size()) continue;
    throw InputError(fmt::format("certificate: {}: value {} of {}", key_text(axes[i]), point[i] + 1,
                                 axes[i].values.size()));
  }
  SearchPlan plan;
  plan.cost = cost_metric;
  plan.evaluations = std::numeric_limits<int>::max();
  plan.seconds = kInfinity;
  const std::function<void(const SearchProgress&)> silent;
  return Search(plan, axes, constraints, evaluate, {}, silent).certificate_for(point);
}

std::string to_text(const Certificate& certificate) {
  std::string text;
  if (certificate.minimal()) {
    text = "the point holds, and none of its single steps down does\n";
  } else if (!certificate.point_holds) {
    text = "the point does not hold\n";
  } else if (!certificate.complete()) {
    text = fmt::format("incomplete: {} of {} single steps down were not evaluated\n",
                       certificate.missing.size(), certificate.reductions.size());
  } else {
    text = "not minimal: a single step down holds\n";
  }
  for (const Reduction& r : certificate.reductions) {
    const std::string from_to = r.to_value.empty() ? r.from_value : r.from_value + " -> " + r.to_value;
    text += fmt::format("  {} {}: {}\n", r.key, from_to, r.text);
  }
  return text;
}

}  // namespace bitspan
