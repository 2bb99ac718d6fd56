// SPDX-License-Identifier: Apache-2.0
#include "study/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

#include "study/metrics.hpp"

namespace bitspan {
namespace {

constexpr std::string_view name_characters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.";
constexpr std::string_view other_characters = " \t+-*/(),";
constexpr std::string_view expression_rule = "legal: numbers, metrics, + - * / ( ), min(a, b), max(a, b)";

double sum(double a, double b) { return a + b; }
double difference(double a, double b) { return a - b; }
double product(double a, double b) { return a * b; }
double quotient(double a, double b) { return b == 0 ? std::numeric_limits<double>::quiet_NaN() : a / b; }

// Unlike std::min, both let no NaN get lost.
double extreme(const double* values, int count, bool largest) {
  if (count < 1) throw mu::ParserError("too few arguments");
  double out = values[0];
  for (int i = 1; i < count; ++i) {
    if (std::isnan(values[i]) || (largest ? values[i] > out : values[i] < out)) out = values[i];
  }
  return out;
}
double least(const double* values, int count) { return extreme(values, count, false); }
double most(const double* values, int count) { return extreme(values, count, true); }

}  // namespace

std::string no_metric(const std::string& name) {
  std::vector<std::string> known;
  for (const Metric& metric : known_metrics()) known.push_back(metric.name);
  return fmt::format("\"{}\" is no metric; legal: those of docs/study.md, nearest: {}", name,
                     comma_list(nearest_names(name, known)));
}

struct Expression::Parser {
  mu::Parser of;
  Metrics values;  // its nodes stay where they are
};

Expression::Expression(std::string text) : text_(std::move(text)), parser_(std::make_unique<Parser>()) {
  if (text_.find_first_not_of(name_characters) == std::string::npos && find_metric(text_) == nullptr) {
    throw InputError(no_metric(text_));
  }
  const auto refuse = [this](std::size_t at, std::string_view what) {
    throw InputError(fmt::format("\"{}\": character {}: {}; {}", text_, at + 1, what, expression_rule));
  };
  const std::size_t strange =
      text_.find_first_not_of(std::string(name_characters) + std::string(other_characters));
  if (strange != std::string::npos) refuse(strange, "belongs to no expression");

  std::size_t end = 0;
  for (std::size_t at = 0; (at = text_.find_first_of(name_characters, end)) != std::string::npos;) {
    end = std::min(text_.find_first_not_of(name_characters, at), text_.size());
    const std::string name = text_.substr(at, end - at);
    const bool is_number = std::isdigit(static_cast<unsigned char>(name[0])) != 0 || name[0] == '.';
    if (is_number || name == "min" || name == "max") continue;
    if (find_metric(name) == nullptr) {
      throw InputError(fmt::format("\"{}\": character {}: {}", text_, at + 1, no_metric(name)));
    }
    parser_->values[name] = 1;
  }
  for (const auto& [name, value] : parser_->values) metrics_.push_back(name);
  if (metrics_.empty()) refuse(0, "names no metric");

  mu::Parser& parser = parser_->of;
  parser.ClearConst();
  parser.ClearFun();
  parser.EnableBuiltInOprt(false);
  parser.DefineNameChars(std::string(name_characters).c_str());
  parser.DefineOprt("+", sum, mu::prADD_SUB);
  parser.DefineOprt("-", difference, mu::prADD_SUB);
  parser.DefineOprt("*", product, mu::prMUL_DIV);
  parser.DefineOprt("/", quotient, mu::prMUL_DIV);
  parser.DefineFun("min", least);
  parser.DefineFun("max", most);
  try {
    parser.SetExpr(text_);
    for (auto& [name, value] : parser_->values) parser.DefineVar(name, &value);
    parser.Eval();
  } catch (const mu::ParserError& error) {
    // Behind the end of the text, and where a function refuses its arguments, muParser's position is none.
    refuse(std::min(static_cast<std::size_t>(error.GetPos()), text_.size()),
           "an expression cannot go on, or end, like this");
  }
  if (parser.GetNumResults() > 1) refuse(0, "has several values");
}

Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

std::optional<double> Expression::value(const Metrics& metrics) {
  for (auto& [name, value] : parser_->values) {
    const auto found = metrics.find(name);
    if (found == metrics.end()) return std::nullopt;
    value = found->second;
  }
  return parser_->of.Eval();
}

std::vector<std::string> judged_texts(const StudyPlan& plan) {
  std::vector<std::string> out;
  for (const Constraint& c : plan.constraints) out.push_back(c.metric);
  out.push_back(plan.search ? plan.search->cost : plan.cost);
  if (plan.search) out.push_back(plan.search->tie);
  return out;
}

std::vector<Expression> expressions_of(const StudyPlan& plan) {
  std::vector<Expression> out;
  std::set<std::string> seen;
  for (const std::string& text : judged_texts(plan)) {
    if (find_metric(text) == nullptr && seen.insert(text).second) out.emplace_back(text);
  }
  return out;
}

std::vector<std::string> judged_metrics(const StudyPlan& plan) {
  std::set<std::string> out;
  for (const std::string& text : judged_texts(plan)) {
    const Expression expression(text);
    out.insert(expression.metrics().begin(), expression.metrics().end());
  }
  return {out.begin(), out.end()};
}

void add_expressions(std::vector<Expression>& expressions, PointMetrics& metrics) {
  for (Expression& expression : expressions) {
    for (SceneMetrics& scene : metrics.scenes) {
      Metrics used;
      bool shares = false;
      for (const std::string& name : expression.metrics()) {
        const auto own = scene.metrics.find(name);
        const auto all = metrics.all.find(name);
        shares = shares || own != scene.metrics.end();
        if (own != scene.metrics.end()) {
          used[name] = own->second;
        } else if (all != metrics.all.end()) {
          used[name] = all->second;
        }
      }
      if (const auto value = expression.value(used); shares && value) {
        scene.metrics[expression.text()] = *value;
      }
    }
    if (const auto value = expression.value(metrics.all)) metrics.all[expression.text()] = *value;
  }
}

}  // namespace bitspan
