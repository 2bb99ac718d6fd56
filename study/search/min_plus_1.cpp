// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "study/search/searcher.hpp"

namespace bitspan::searching {

SearchPoint Searcher::min_plus_1() {
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

SearchPoint Searcher::raised(const SearchPoint& p) {
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

bool Searcher::above(const SearchPoint& a, const SearchPoint& b) const {
  if (at(a).holds != at(b).holds) return at(a).holds;
  if (at(a).holds) return better(a, b);
  const double violation_a = violation_of(at(a), constraints_),
               violation_b = violation_of(at(b), constraints_);
  return violation_a != violation_b ? violation_a < violation_b : at(a).cost < at(b).cost;
}

}  // namespace bitspan::searching
