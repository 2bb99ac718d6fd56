// SPDX-License-Identifier: Apache-2.0
// The error budget: exact is exact, and the parts make up the whole.
#include "study/budget.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/demo.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

TEST(Budget, PartsMakeUpTheWhole) {
  const PointMeter meter({demo_scene(160, 120)});
  std::size_t told = 0;
  const Budget b = error_budget(meter, shipped_config("depth16"), {"span.u.rms", "span.h.rms"},
                                [&](std::size_t done, std::size_t total) {
                                  told = std::max(told, done);
                                  EXPECT_LE(done, total);
                                });
  EXPECT_EQ(told, 1 + 2 * b.rows.size());
  for (const std::string& metric : b.metrics) {
    EXPECT_LT(b.exact.at(metric), 1e-3 * b.base.at(metric)) << metric;
    // Independent errors add up as squares.
    double squares = 0;
    for (const BudgetRow& row : b.rows) squares += row.alone.at(metric) * row.alone.at(metric);
    EXPECT_NEAR(std::sqrt(squares) / b.base.at(metric), 1, 0.25) << metric;
  }
  // The last register of u is a cause of its error, and none of the error of h.
  for (const BudgetRow& row : b.rows) {
    if (row.quantisation.name != "span.uv") continue;
    EXPECT_LT(row.without.at("span.u.rms"), b.base.at("span.u.rms"));
    EXPECT_EQ(row.without.at("span.h.rms"), b.base.at("span.h.rms"));
    EXPECT_GE(row.quantisation.extra_bits, 8);
  }
  ASSERT_EQ(b.maps.size(), 1U);
  EXPECT_EQ(b.maps[0].cause.size(), std::size_t{160 * 120});
  std::size_t named = 0;
  for (const std::int16_t cause : b.maps[0].cause) {
    EXPECT_LT(cause, static_cast<std::int16_t>(b.rows.size()));
    named += cause >= 0 ? 1 : 0;
  }
  EXPECT_GT(named, std::size_t{160 * 120 / 4});
}

TEST(Budget, EveryShippedConfigurationHasExactForms) {
  for (const std::string& name : shipped_names) {
    const Config exact = with_exact(shipped_config(name), {{"span.uv", 8}, {"reciprocal.pixel.output", 4}});
    EXPECT_NO_THROW(check_config(exact, name));
    EXPECT_EQ(exact.format(FormatId::span_uv).fraction(),
              shipped_config(name).format(FormatId::span_uv).fraction() + 8);
    EXPECT_EQ(exact.pixel_reciprocal.kind, ReciprocalKind::restoring);
  }
}

TEST(Budget, WrongNamesAreRefused) {
  const PointMeter meter({demo_scene(64, 48)});
  EXPECT_THROW(error_budget(meter, shipped_config("depth16"), {"span.u.nonsense"}), InputError);
  EXPECT_THROW(with_exact(shipped_config("depth16"), {{"span.nonsense", 4}}), InputError);
}

}  // namespace
}  // namespace bitspan
