// SPDX-License-Identifier: Apache-2.0
// The limits that a study puts on metrics, and how a point is judged by them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/metrics.hpp"

namespace bitspan {

// What of several scenes a constraint judges.
enum class Over : std::uint8_t {
  worst,   // the scene that is nearest to the limit, or farthest beyond it
  pooled,  // all scenes together
};

struct Constraint {
  std::string metric;  // or an expression (study/expression.hpp)
  std::optional<double> at_most, at_least;
  Over over = Over::worst;
  bool holds(double value) const {  // false for a NaN
    return (!at_most || value <= *at_most) && (!at_least || value >= *at_least);
  }
  // Returns how far the value is from the nearer limit, below 0 beyond it. A NaN is infinitely far beyond.
  double margin(double value) const;
};

// The value that a constraint judges at a point.
struct Decisive {
  double value = 0;
  std::string scene;  // that has the value; empty: all together, or the configuration alone gives it
};
// There is none where no scene gives the metric.
std::optional<Decisive> decisive(const Constraint& constraint, const Metrics& all,
                                 std::span<const SceneMetrics> scenes);

// Whether all constraints hold. The constraint of a metric that is not there does not.
bool all_hold(const std::vector<Constraint>& constraints, const PointMetrics& metrics);

// Returns what a constraint asks for ("at most 0.25"), and by how much a value is within or beyond it, as a
// share of the limit where that is not 0: "margin 6.2 %", "0.0625 beyond".
std::string limits_text(const Constraint& constraint);
std::string margin_text(const Constraint& constraint, double value);

}  // namespace bitspan
