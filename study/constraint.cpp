// SPDX-License-Identifier: Apache-2.0
#include "study/constraint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bitspan {

double Constraint::margin(double value) const {
  double margin = std::numeric_limits<double>::infinity();
  if (std::isnan(value)) return -margin;
  if (at_most) margin = std::min(margin, *at_most - value);
  if (at_least) margin = std::min(margin, value - *at_least);
  return margin;
}

std::optional<Decisive> decisive(const Constraint& constraint, const Metrics& all,
                                 std::span<const SceneMetrics> scenes) {
  std::optional<Decisive> worst;
  for (const SceneMetrics& scene : scenes) {
    const auto found = scene.metrics.find(constraint.metric);
    if (constraint.over == Over::pooled || found == scene.metrics.end()) continue;
    if (worst && constraint.margin(found->second) >= constraint.margin(worst->value)) continue;
    worst = {found->second, scene.scene};
  }
  if (worst) return worst;
  const auto found = all.find(constraint.metric);
  return found == all.end() ? std::nullopt : std::optional(Decisive{found->second, ""});
}

bool all_hold(const std::vector<Constraint>& constraints, const PointMetrics& metrics) {
  return std::ranges::all_of(constraints, [&](const Constraint& c) {
    const auto at = decisive(c, metrics.all, metrics.scenes);
    return at && c.holds(at->value);
  });
}

std::string limits_text(const Constraint& c) {
  const std::string least = c.at_least ? fmt::format("at least {}", *c.at_least) : "";
  const std::string most = c.at_most ? fmt::format("at most {}", *c.at_most) : "";
  return least + (c.at_least && c.at_most ? ", " : "") + most;
}

std::string margin_text(const Constraint& c, double value) {
  const double margin = c.margin(value);
  if (!std::isfinite(margin)) return std::isnan(value) ? "not a number" : "infinitely far";
  // That of the limit which is nearer.
  const double limit = c.at_most && *c.at_most - value == margin ? *c.at_most : c.at_least.value_or(0);
  const double percent = limit == 0 ? 0 : 100 * std::fabs(margin / limit);
  const std::string size = limit == 0       ? fmt::format("{:.4g}", std::fabs(margin))
                           : percent < 9.95 ? fmt::format("{:.2g} %", percent)
                                            : fmt::format("{:.0f} %", percent);
  return margin < 0 ? size + " beyond" : "margin " + size;
}

}  // namespace bitspan
