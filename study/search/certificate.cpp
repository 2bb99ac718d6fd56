// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "study/search/searcher.hpp"
#include "study/search/texts.hpp"

namespace bitspan::searching {

Certificate Searcher::certificate_for(const SearchPoint& p) {
  enter("certificate");
  evaluate({p});
  evaluate(reductions_of(p));
  return certificate_of(p);
}

Certificate Searcher::certificate_of(const SearchPoint& p) const {
  Certificate c;
  c.point_holds = known(p) && at(p).holds;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (is_category(axes_[i])) continue;  // it has no order, and no step down
    Reduction r;
    r.axis = i;
    r.key = axis_title(axes_[i]);
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
      c.missing.push_back(fmt::format("{} from {} to {} was not evaluated", r.key, r.from_value, r.to_value));
    }
    c.reductions.push_back(std::move(r));
  }
  return c;
}

void Searcher::judge_reduction(const SearchPoint& p, Reduction& r) const {
  if (!known(r.point)) {
    r.text = "not evaluated";
    return;
  }
  const Judged& j = at(r.point);
  if (!j.holds) {
    r.outcome = ReductionOutcome::fails;
    r.text = j.failure;
  } else if (j.cost <= at(p).cost && j.tie > at(p).tie) {
    r.outcome = ReductionOutcome::costs_more;
    r.text = fmt::format("holds, but {} rises from {} to {}", plan_.tie, at(p).tie, j.tie);
  } else if (j.cost <= at(p).cost) {
    r.outcome = ReductionOutcome::passes;
    r.text = fmt::format("holds; {} is {} against {}", plan_.cost, j.cost, at(p).cost);
  } else {
    r.outcome = ReductionOutcome::costs_more;
    r.text = fmt::format("holds, but {} rises from {} to {}", plan_.cost, at(p).cost, j.cost);
  }
}

}  // namespace bitspan::searching
