// SPDX-License-Identifier: Apache-2.0
#include "study/metrics.hpp"

#include <gtest/gtest.h>

#include <set>

#include "scene/demo.hpp"
#include "study/point.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

TEST(Metrics, NamesAreUniqueAndFound) {
  std::set<std::string> names;
  for (const Metric& metric : known_metrics()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
    EXPECT_EQ(find_metric(metric.name), &metric);
    EXPECT_FALSE(metric.unit.empty() || metric.meaning.empty()) << metric.name;
  }
  EXPECT_EQ(find_metric("span.u"), nullptr);
  EXPECT_EQ(find_metric("span.u.max")->unit, "texel");
  EXPECT_EQ(find_metric("span.u.max_ulp")->unit, "ULP");
  EXPECT_EQ(find_metric("span.u.max_ulp")->field, "span.u");
  EXPECT_EQ(find_metric("span.u.sqnr_db")->better, Better::high);
  EXPECT_TRUE(find_metric("span.u.rms")->squares_add && !find_metric("span.u.max")->squares_add);
  EXPECT_EQ(find_metric("area.ice40.fmax_mhz")->role, MetricRole::cost);
}

TEST(Metrics, EveryMetricOfAPointIsKnown) {
  const Config config = shipped_config("depth16");
  const PointResult point = PointMeter({demo_scene(64, 48)}).measure(config);
  EXPECT_GT(point.metrics.size(), 100U);
  for (const auto& [name, value] : point.metrics) EXPECT_NE(find_metric(name), nullptr) << name;
  for (const Metric& metric : known_metrics()) {
    // The area is asked for, and curves are of scenes of patches.
    if (metric.name.starts_with("area.") || metric.name.starts_with("curve.")) continue;
    if (metric.role != MetricRole::cost) continue;
    EXPECT_TRUE(point.metrics.contains(metric.name)) << metric.name;
  }
  for (const FieldError& f : point.fields) {
    const std::string field = f.stage + "." + f.quantity;
    for (const StatisticColumn& c : statistic_columns()) {
      const std::string name = field + "." + c.ending;
      EXPECT_TRUE(point.metrics.contains(name)) << name;
      ASSERT_NE(find_metric(name), nullptr) << name;
      EXPECT_EQ(find_metric(name)->label, c.label);
      EXPECT_EQ(find_metric(name)->field, field);
    }
    EXPECT_EQ(find_metric(field + ".max")->unit, f.unit);
  }
}

TEST(Metrics, TheDocumentationShowsThem) {
  const std::string path = source_path("docs/study.md");
  EXPECT_NE(read_file(path).find("\n" + metrics_markdown() + "\n"), std::string::npos)
      << "docs/study.md lacks this table:\n"
      << metrics_markdown();
}

}  // namespace
}  // namespace bitspan
