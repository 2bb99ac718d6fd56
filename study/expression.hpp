// SPDX-License-Identifier: Apache-2.0
// Reads and evaluates the expressions that a plan may have in place of a metric:
// "estimate.ecp5.luts + 100 * estimate.ecp5.multipliers". They have numbers, metrics, + - * /, parentheses,
// min and max. A metric's name alone is an expression, too.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "study/plan.hpp"

namespace bitspan {

class Expression {
 public:
  // Throws InputError, which names the place in the text, where it is no expression, and for a metric that is
  // not among known_metrics().
  explicit Expression(std::string text);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  const std::string& text() const { return text_; }
  const std::vector<std::string>& metrics() const { return metrics_; }  // sorted, at least one
  // Returns none where one of the metrics is not there, and a NaN where something is divided by zero. To be
  // called from one thread at a time.
  std::optional<double> value(const Metrics& metrics);

 private:
  struct Parser;
  std::string text_;
  std::vector<std::string> metrics_;
  std::unique_ptr<Parser> parser_;
};

// Returns what is wrong with a name that no metric has, with the nearest that exist.
std::string no_metric(const std::string& name);

// Returns the texts by which the plan judges a point: those of its constraints, the cost, and a search's tie.
std::vector<std::string> judged_texts(const StudyPlan& plan);
// Returns those of them that are no metric's name.
std::vector<Expression> expressions_of(const StudyPlan& plan);
// Returns the metrics that the plan judges a point by, sorted.
std::vector<std::string> judged_metrics(const StudyPlan& plan);
// Adds the values that exist, each under its expression's text. A scene takes what it has no share in, such
// as a cost, from all together.
void add_expressions(std::vector<Expression>& expressions, PointMetrics& metrics);

}  // namespace bitspan
