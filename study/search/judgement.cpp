// SPDX-License-Identifier: Apache-2.0
#include "study/search/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/search/texts.hpp"

namespace bitspan::searching {

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
    const auto found = decisive(c, e.metrics, e.scenes);
    const double value = found ? found->value : nan;
    j.values.push_back(value);
    if (!found) {
      failures.push_back(fmt::format("{} has no value here, {}", c.metric, limits_text(c)));
    } else if (!c.holds(value)) {
      failures.push_back(fmt::format("{} is {}{}, {}", c.metric,
                                     std::isnan(value) ? "not a number" : fmt::format("{}", value),
                                     found->scene.empty() ? "" : " on " + found->scene, limits_text(c)));
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

// A metric that does not exist at all is a misspelling, not a constraint that fails.
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

namespace {

// Returns the unit of an excess: the limit's own size, and 1 for counts that must be 0.
double scale_of(double limit) { return limit != 0 && std::isfinite(limit) ? std::abs(limit) : 1.0; }

}  // namespace

double violation_of(const Judged& j, const std::vector<Constraint>& constraints) {
  if (j.refused || std::isnan(j.cost)) return infinity;
  double sum = 0;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const double value = j.values[i];
    if (std::isnan(value)) return infinity;
    const auto add = [&sum](double excess, double limit) {
      if (excess > 0) sum += std::log2(1 + excess / scale_of(limit));
    };
    if (constraints[i].at_most) add(value - *constraints[i].at_most, *constraints[i].at_most);
    if (constraints[i].at_least) add(*constraints[i].at_least - value, *constraints[i].at_least);
  }
  return sum;
}

double slack_used(const Judged& p, const Judged& q, const std::vector<Constraint>& constraints) {
  double most = 0;
  const auto side = [&most](double room_p, double room_q, double limit) {
    if (std::isnan(room_p) || std::isnan(room_q) || room_q >= room_p) return;  // also with infinite limits
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

}  // namespace bitspan::searching
