// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>

#include "study/search/searcher.hpp"

namespace bitspan::searching {

SearchPoint Searcher::greedy() {
  SearchPoint p = finish(coarse_descent(), Pick::ratio);
  for (;;) {
    enter("exchange");
    exchange(p);
    if (!better(*best_, p)) return p;
    p = finish(*best_, Pick::ratio);
  }
}

SearchPoint Searcher::coarse_descent() {
  enter("remove");
  SearchPoint p = top_;
  const std::size_t longest = *std::ranges::max_element(top_);
  for (std::size_t stride = std::bit_floor(std::max<std::size_t>(1, longest / 2)); stride > 1; stride /= 2) {
    p = descend(std::move(p), Pick::ratio, Costs::any, stride);
  }
  return descend(std::move(p), Pick::ratio, Costs::any, 1);
}

void Searcher::exchange(const SearchPoint& p) {
  const double cost = at(p).cost;
  std::vector<std::pair<std::size_t, SearchPoint>> ups;
  std::vector<SearchPoint> points;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i] == top_[i]) continue;
    points.push_back(moved(p, i, 1));
    ups.emplace_back(i, points.back());
  }
  evaluate(points);

  // Costs add up well enough to tell which pairs are worth an evaluation.
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
  constexpr std::size_t batch = 16;  // the same on any machine, so the result is too
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

}  // namespace bitspan::searching
