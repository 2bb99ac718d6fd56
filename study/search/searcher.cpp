// SPDX-License-Identifier: Apache-2.0
#include "study/search/searcher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

namespace bitspan::searching {

namespace {

std::size_t height_of(const SearchPoint& p) { return std::accumulate(p.begin(), p.end(), std::size_t{0}); }

}  // namespace

Searcher::Searcher(const SearchPlan& plan, const std::vector<Axis>& axes,
                   const std::vector<Constraint>& constraints, const Evaluate& evaluate,
                   const CostOf& cost_of, std::stop_token stop,
                   const std::function<void(const SearchProgress&)>& progress)
    : plan_(plan),
      axes_(axes),
      constraints_(constraints),
      evaluate_(evaluate),
      cost_of_(cost_of),
      stop_(std::move(stop)),
      progress_(progress),
      cores_(std::max<std::size_t>(1, std::thread::hardware_concurrency())) {
  for (const Axis& axis : axes) top_.push_back(axis.values.size() - 1);
}

SearchResult Searcher::run() {
  SearchResult result;
  try {
    enter("widest");
    evaluate({top_});
    result.refused = at(top_).refused;
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
      if (plan_.pairs) {
        const bool by_error =
            plan_.algorithm == SearchAlgorithm::min_plus_1 || plan_.algorithm == SearchAlgorithm::max_minus_1;
        p = finish_pairs(std::move(p), by_error ? Pick::error : Pick::ratio);
      }
      best_ = p;
      // For the certificate; one of these points may be the next least.
      for (std::size_t before = 0; plan_.tie_within > 0 && before != steps_.size();) {
        before = steps_.size();
        evaluate(reductions_of(least_of_near_ties()));
      }
      result.stopped_by = cut_short_;
    }
  } catch (const Halt& halt) {
    result.stopped_by = halt.reason;
  }
  if (best_ && plan_.tie_within > 0) settle_on(least_of_near_ties());
  result.found = best_.has_value();
  if (result.found) {
    result.point = *best_;
    result.cost = at(*best_).cost;
    result.tie = at(*best_).tie;
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

bool Searcher::better(const SearchPoint& a, const SearchPoint& b) const {
  const double cost_a = at(a).cost, cost_b = at(b).cost;
  if (cost_a != cost_b) return cost_a < cost_b;
  if (at(a).tie != at(b).tie) return at(a).tie < at(b).tie;
  const std::size_t height_a = height_of(a), height_b = height_of(b);
  return height_a != height_b ? height_a < height_b : a < b;
}

SearchPoint Searcher::least_of_near_ties() const {
  const double most = at(*best_).cost + plan_.tie_within * std::abs(at(*best_).cost);
  const SearchPoint* out = &*best_;
  for (const auto& [p, judged] : memo_) {
    if (!judged.holds || judged.cost > most) continue;
    if (judged.tie < at(*out).tie || (judged.tie == at(*out).tie && better(p, *out))) out = &p;
  }
  return *out;
}

void Searcher::settle_on(const SearchPoint& p) {
  best_ = p;
  const auto step = std::ranges::find(steps_, p, &SearchStep::point);
  step->best = true;
  for (auto later = step + 1; later != steps_.end(); ++later) later->best = false;
}

std::vector<SearchPoint> Searcher::reductions_of(const SearchPoint& p) const {
  std::vector<SearchPoint> list;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] > 0) list.push_back(moved(p, i, -1));
  }
  return list;
}

SearchPoint Searcher::moved(SearchPoint p, std::size_t axis, std::ptrdiff_t by) {
  p[axis] = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(p[axis]) + by);
  return p;
}

double Searcher::elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::size_t Searcher::allowed(std::size_t wanted) const {
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

void Searcher::evaluate(const std::vector<SearchPoint>& points) {
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
      progress_({phase_, steps_.size(), elapsed(), best_.has_value(), best_ ? at(*best_).cost : nan});
    }
    if (missing) throw Halt{StoppedBy::interrupt};
    first += count;
  }
}

void Searcher::record(const SearchPoint& p, const Evaluation& e) {
  if (!metrics_exist_ && !e.refused) {
    require_metrics(e, plan_.cost, constraints_);
    metrics_exist_ = true;
  }
  Judged& j = memo_.emplace(p, judge(e, plan_.cost, constraints_)).first->second;
  const auto tie = e.metrics.find(plan_.tie);
  if (tie != e.metrics.end() && !std::isnan(tie->second)) j.tie = tie->second;
  const bool best = j.holds && (!best_ || better(p, *best_));
  if (best) best_ = p;
  steps_.push_back({p, j.cost, j.holds, best});
}

bool Searcher::prefer(const SearchPoint& p, const SearchPoint& a, const SearchPoint& b, Pick pick) const {
  const double gain_a = at(p).cost - at(a).cost, gain_b = at(p).cost - at(b).cost;
  const double used_a = slack_used(at(p), at(a), constraints_),
               used_b = slack_used(at(p), at(b), constraints_);
  if (pick == Pick::error) return used_a != used_b ? used_a < used_b : gain_a > gain_b;
  // Free steps come first, and the largest gain among them before the others.
  constexpr double least = 1e-9;
  const double ratio_a = gain_a / std::max(used_a, least), ratio_b = gain_b / std::max(used_b, least);
  return ratio_a != ratio_b ? ratio_a > ratio_b : used_a < used_b;
}

SearchPoint Searcher::descend(SearchPoint p, Pick pick, Costs costs, std::size_t stride, std::size_t frozen) {
  std::vector<bool> open(p.size(), true);
  if (frozen != no_axis) open[frozen] = false;
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
      if (!at(q).holds || (costs == Costs::falling && better(p, q))) {
        open[axis] = false;
      } else if (chosen == nullptr || prefer(p, q, *chosen, pick)) {
        chosen = &q;
      }
    }
    if (chosen == nullptr) return p;
    p = SearchPoint(*chosen);
  }
}

SearchPoint Searcher::finish(SearchPoint p, Pick pick) {
  enter("certificate");
  for (;;) {
    p = descend(std::move(p), pick, Costs::falling, 1);
    evaluate(reductions_of(p));
    if (!better(*best_, p)) return p;
    p = *best_;
  }
}

SearchPoint Searcher::finish_pairs(SearchPoint p, Pick pick) {
  for (;;) {
    enter("pairs");
    evaluate_pairs(p);
    if (!better(*best_, p)) return p;
    p = finish(*best_, pick);
  }
}

void Searcher::evaluate_pairs(const SearchPoint& p) {
  const std::vector<PairedStep> pairs = pairs_of(p);
  constexpr std::size_t batch = 16;  // the same on any machine, so the result is too
  for (std::size_t first = 0; first < pairs.size(); first += batch) {
    std::vector<SearchPoint> points;
    for (std::size_t k = first; k < std::min(first + batch, pairs.size()); ++k) {
      points.push_back(pairs[k].point);
    }
    evaluate(points);
    if (better(*best_, p)) return;
  }
}

}  // namespace bitspan::searching
