// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "study/search/searcher.hpp"

namespace bitspan::searching {

SearchPoint Searcher::annealing() {
  SearchPoint p = coarse_descent();
  enter("anneal");
  std::vector<std::size_t> movable;
  for (std::size_t i = 0; i < top_.size(); ++i) {
    if (top_[i] > 0) movable.push_back(i);
  }
  if (movable.empty()) return p;
  evaluate(reductions_of(p));
  const double unit = typical_step(p);
  // One bit fewer everywhere saves a step of each axis and costs one bit of violation. That must not pay.
  const double penalty = 1.5 * static_cast<double>(movable.size());
  const auto energy = [&](const SearchPoint& q) {
    const double violation = violation_of(at(q), constraints_);
    return at(q).cost / unit + (at(q).holds ? 0.0 : 0.5 + penalty * violation);
  };

  // The moves get two thirds of the evaluations that are left. The descent to a certificate may take the
  // rest.
  const auto limit = static_cast<std::size_t>(plan_.evaluations);
  const std::size_t used = std::min(steps_.size(), limit);
  const std::size_t budget = (limit - used) * 2 / 3;
  const std::size_t most_moves = 8 * budget;
  constexpr double hot = 1.0, cold = 0.05;  // in typical steps
  constexpr std::size_t widest_batch = 8;
  const std::size_t frozen = 40 * movable.size();  // so many rejections in a row end the search
  Random random(plan_.seed);
  SearchPoint best = p;
  for (std::size_t moves = 0, rejected = 0; moves < most_moves && rejected < frozen;) {
    const std::size_t made = steps_.size() - used;
    if (made >= budget) break;
    if (elapsed() > plan_.seconds * 2 / 3) {  // the moves get the same share of the seconds
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

double Searcher::typical_step(const SearchPoint& p) const {
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

SearchPoint Searcher::random_move(const SearchPoint& p, const std::vector<std::size_t>& movable,
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

void Searcher::shift(SearchPoint& p, std::size_t axis, bool down, std::size_t by) const {
  p[axis] = down ? p[axis] - std::min(by, p[axis]) : std::min(top_[axis], p[axis] + by);
}

}  // namespace bitspan::searching
