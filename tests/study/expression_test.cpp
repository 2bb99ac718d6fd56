// SPDX-License-Identifier: Apache-2.0
// Expressions over metrics: their values, and what is no expression.
#include "study/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "study/metrics.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

using Metrics = std::map<std::string, double, std::less<>>;

const Metrics measured{{"cost.register_bits", 3000},
                       {"cost.product_bits", 500},
                       {"span.u.max", 0.25},
                       {"registers.wraps", 0},
                       {"span.u.sqnr_db", std::numeric_limits<double>::infinity()}};

double value_of(const std::string& text) {
  const auto value = Expression(text).value(measured);
  EXPECT_TRUE(value) << text;
  return value.value_or(-1);
}

TEST(Expression, HasTheValueOfItsArithmetic) {
  EXPECT_EQ(value_of("cost.register_bits"), 3000);
  EXPECT_EQ(value_of("cost.register_bits + 2 * cost.product_bits"), 4000);
  EXPECT_EQ(value_of("(cost.register_bits + 2) * cost.product_bits"), 3002.0 * 500);
  EXPECT_EQ(value_of("cost.register_bits - cost.product_bits - 1"), 2499);
  EXPECT_EQ(value_of("cost.register_bits / cost.product_bits / 2"), 3);
  EXPECT_EQ(value_of("-cost.product_bits + 1e3"), 500);
  EXPECT_EQ(value_of("2*-cost.product_bits"), -1000);
  EXPECT_EQ(value_of("1 - -cost.product_bits"), 501);
  EXPECT_EQ(value_of("-span.u.max * .5"), -0.125);
  EXPECT_EQ(value_of("min(cost.register_bits, cost.product_bits, 7000)"), 500);
  EXPECT_EQ(value_of("max(cost.register_bits/1000,min(5, cost.product_bits))"), 5);
  EXPECT_EQ(value_of("span.u.sqnr_db + 1"), std::numeric_limits<double>::infinity());
}

TEST(Expression, WhatIsDividedByZeroHasNoValue) {
  for (const char* text :
       {"cost.register_bits / registers.wraps", "1 / (1 / registers.wraps)", "min(1, 1 / registers.wraps)",
        "max(1, 1 / registers.wraps)", "max(1 / registers.wraps, 1)", "cost.product_bits / 0"}) {
    EXPECT_TRUE(std::isnan(value_of(text))) << text;
  }
}

TEST(Expression, IsAbsentWhereAMetricIs) {
  Expression e("cost.register_bits + 0 * estimate.ecp5.luts");
  EXPECT_EQ(e.metrics(), (std::vector<std::string>{"cost.register_bits", "estimate.ecp5.luts"}));
  EXPECT_FALSE(e.value(measured));
  Metrics more = measured;
  more["estimate.ecp5.luts"] = 100;
  EXPECT_EQ(e.value(more), 3000);
  more["cost.register_bits"] = 10;
  EXPECT_EQ(e.value(more), 10) << "each value is its point's";
}

TEST(Expression, EveryMetricIsOne) {
  for (const Metric& metric : known_metrics()) {
    Expression e(metric.name + " + 1");
    ASSERT_EQ(e.metrics(), std::vector{metric.name});
    EXPECT_EQ(e.value({{metric.name, 4.0}}), 5);
  }
}

TEST(Expression, WhatIsNoneIsRefusedWithItsPlace) {
  const auto said = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(Expression(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "taken";
  };
  const auto expect = [&](const std::string& text, const std::string& begins) {
    EXPECT_TRUE(said(text).starts_with(begins)) << text << ": " << said(text);
  };
  expect("cost.bits", "\"cost.bits\" is no metric; legal: those of docs/study.md, nearest: cost.");
  expect(
      "1 + cost.bits",
      "\"1 + cost.bits\": character 5: \"cost.bits\" is no metric; legal: those of docs/study.md, nearest: ");
  expect("cost.register_bits + sin(cost.product_bits)",
         "\"cost.register_bits + sin(cost.product_bits)\": character 22: \"sin\"");
  expect("cost.register_bits + _pi", "\"cost.register_bits + _pi\": character 22: \"_pi\" is no metric");
  expect("cost.register_bits ^ 2",
         "\"cost.register_bits ^ 2\": character 20: belongs to no expression; legal: ");
  expect("cost.register_bits = 2", "\"cost.register_bits = 2\": character 20: belongs to no expression");
  expect("cost.register_bits ? 1 : 2", "\"cost.register_bits ? 1 : 2\": character 20: ");
  expect("1 + 2", "\"1 + 2\": character 1: names no metric; legal: ");
  for (const char* text : {"cost.register_bits +", "+", "()", "cost.register_bits cost.product_bits",
                           "cost.register_bits 2", "2 cost.register_bits", "(cost.register_bits",
                           "cost.register_bits)", "* cost.register_bits", "cost.register_bits, 1", "min()",
                           "min(,cost.register_bits)", "min cost.register_bits", "3..4*cost.register_bits"}) {
    expect(text, "\"" + std::string(text) + "\": character ");
  }
  expect("3.5", "\"3.5\" is no metric");
  expect("   ", "\"   \": character ");
}

}  // namespace
}  // namespace bitspan
