// SPDX-License-Identifier: Apache-2.0
// Judges an evaluated point: whether it holds, what it costs, how far it is from the limits.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "study/search/search.hpp"

namespace bitspan::searching {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// What an evaluation says of a point.
struct Judged {
  bool refused = false;
  bool holds = false;
  double cost = nan;
  double tie = infinity;       // decides between equal costs; infinite where the metric has no value
  std::vector<double> values;  // of the constraints' metrics, NaN where there is none; empty where refused
  std::string failure;         // the constraints that do not hold, or the refusal; empty where it holds
};

Judged judge(const Evaluation& e, const std::string& cost_metric, const std::vector<Constraint>& constraints);
// Throws InputError for a metric that does not exist at all. That is not a constraint that fails.
void require_metrics(const Evaluation& e, const std::string& cost_metric,
                     const std::vector<Constraint>& constraints);

// Returns how far a point is from holding, in bits. Each doubling of an excess is one bit, because each bit
// of a width doubles an error. It is 0 where every constraint holds, and infinite where nothing is known.
double violation_of(const Judged& j, const std::vector<Constraint>& constraints);
// Returns the share of the room to the limits that a step from p to q takes, for the constraint that loses
// most. Both points hold. It is 0 where the step is free: on a plateau, or with an error that falls.
double slack_used(const Judged& p, const Judged& q, const std::vector<Constraint>& constraints);

}  // namespace bitspan::searching
