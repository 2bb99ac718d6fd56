// SPDX-License-Identifier: Apache-2.0
#include "study/search/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "study/search/texts.hpp"

namespace bitspan::searching {

void check_axes(const std::vector<Axis>& axes) {
  if (axes.empty()) throw InputError("search: nothing varies; expected at least one [[vary]]");
  std::set<std::string> seen;
  for (const Axis& axis : axes) {
    const std::string name = axis_title(axis);
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
  if (!(plan.tie_within >= 0)) {
    throw InputError(fmt::format("search.tie_within is {}; expected 0 or more", plan.tie_within));
  }
}

}  // namespace bitspan::searching
