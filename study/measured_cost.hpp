// SPDX-License-Identifier: Apache-2.0
// The ± of a cost, and the end of a search whose cost is estimated: its best points are synthesised, and
// ranked by what was measured.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include "study/expression.hpp"
#include "study/plan.hpp"
#include "study/search/search.hpp"
#include "study/store.hpp"
#include "study/sweep.hpp"

namespace bitspan {

// Returns the ± of an expression at a point: the root of the summed squares of what it changes by where one
// estimate is larger by its own ±. 0 where no estimate is in it, or where the metrics have no ±.
double cost_error(Expression& cost, const Metrics& metrics);
// Returns "4512 ± 160", and six digits where the error is 0.
std::string cost_text(double cost, double error);

struct MeasuredCost {
  SearchPoint point;
  std::string hash;
  double estimated = 0, error = 0;
  // NaN where synthesis failed, or where the counts break a constraint on estimates.
  double measured = std::numeric_limits<double>::quiet_NaN();
  std::string message;  // of that
};
struct MeasuredCosts {
  std::vector<MeasuredCost> points;  // the least measured first
  std::size_t left_out = 0;          // points within the error that were not synthesised
};

// Whether such a search ends with synthesis: its cost or a constraint has an estimate, [area] has the family
// of each, and search.measure is not 0.
bool ends_with_synthesis(const StudyPlan& plan);

// Synthesises the points of a search that hold: its answer, the two next in cost, and all whose cost is
// within the answer's ± of it, but at most search.measure points, each netlist once. The cost is then that of
// the counts. Writes them into the database, which recommends the first. `told` gets what is under way. A
// stop request leaves out the rest. Throws as measure_area does.
MeasuredCosts measure_best(const StudyPlan& plan, const SearchResult& result, PointRunner& runner,
                           Store& store, const std::function<void(const std::string&)>& told,
                           const std::stop_token& stop);

}  // namespace bitspan
