// SPDX-License-Identifier: Apache-2.0
#include "report/metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>

#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Four pixels: equal; equal but another texel; another triangle won; nothing was drawn, and the background
// differs.
PictureTally tally_of(const PictureMetric& metric, TextureFilter filter) {
  Scene scene;
  scene.triangles.resize(2);
  scene.triangles[0].texture = 0;
  Frame engine{4, 1, {}, {9, 9, 9, 0}, {1, 2, 3, 0}, {5, 6, 7, 0}, {0, 0, 1, -1}};
  Frame ideal{4, 1, {}, {9, 8, 9, 0}, {1.5, 1.5, 3, 0}, {5, 6, 7, 0}, {0, 0, 0, -1}};
  engine.color = {1, 2, 3, 255, 4, 5, 6, 255, 7, 8, 9, 255, 0, 0, 0, 255};
  ideal.color = {1, 2, 3, 255, 4, 5, 5, 255, 7, 6, 9, 255, 0, 0, 4, 255};
  return metric.tally({engine, ideal, scene, filter});
}

double value_in(std::string_view name, TextureFilter filter = TextureFilter::nearest) {
  ErrorReport report;
  report.missed = 3;
  report.doubled = 4;
  for (const PictureMetric& metric : picture_metrics()) report.picture.push_back(tally_of(metric, filter));
  return picture_value(report, name).value_or(-1);
}

TEST(PictureMetrics, EachIsWhatItsNameSays) {
  const std::map<std::string_view, double> expected{
      {"picture.psnr_db", 10 * std::log10(255.0 * 255.0 * 12 / 21)},
      {"picture.color_max", 4},
      {"picture.drawn", 3},
      {"picture.wrong_order", 1},
      {"picture.wrong_order_rate", 1.0 / 3},
      {"picture.wrong_texel", 1},
      {"picture.wrong_texel_rate", 0.5},
      // u is 1 against 1.5, and 2 against 1.5.
      {"picture.wrong_subtexel_rate_1", 1},
      {"picture.wrong_subtexel_rate_2", 1},
      {"picture.wrong_subtexel_rate_3", 1},
      {"picture.wrong_subtexel_rate_4", 1},
      {"picture.wrong_subtexel_rate_5", 1},
      {"picture.wrong_subtexel_rate_6", 1},
      {"picture.wrong_subtexel_rate_7", 1},
      {"picture.wrong_subtexel_rate_8", 1},
      {"picture.changed_rate", 0.75},
      {"picture.coverage_differences", 7},
  };
  ASSERT_EQ(expected.size(), picture_metrics().size());
  for (const PictureMetric& metric : picture_metrics()) {
    ASSERT_TRUE(expected.contains(metric.name)) << metric.name;
    EXPECT_EQ(value_in(metric.name), expected.at(metric.name)) << metric.name;
  }
  EXPECT_EQ(value_in("picture.wrong_texel", TextureFilter::bilinear), -1)
      << "no value without nearest texels";
}

// Each rate against a count by floor, on coordinates of both signs, beside and on the parts' edges.
TEST(PictureMetrics, SubtexelsAreThoseThatFloorGives) {
  constexpr int pixels = 20'000;
  Scene scene;
  scene.triangles.resize(2);
  scene.triangles[0].texture = 0;
  Frame engine{pixels, 1, {}, {}, {}, {}, {}};
  Frame ideal = engine;
  std::mt19937_64 random(7);
  const auto coordinate = [&] { return std::ldexp(static_cast<double>(random() % 4096) - 2048, -9); };
  for (int i = 0; i < pixels; ++i) {
    for (Frame* frame : {&engine, &ideal}) frame->triangle.push_back(random() % 10 == 0 ? 1 : 0);
    ideal.u.push_back(coordinate());
    ideal.v.push_back(coordinate());
    engine.u.push_back(ideal.u.back() + std::ldexp(coordinate(), -static_cast<int>(random() % 12)));
    engine.v.push_back(ideal.v.back() + std::ldexp(coordinate(), -static_cast<int>(random() % 12)));
    engine.depth.push_back(0);
    ideal.depth.push_back(0);
    engine.color.insert(engine.color.end(), 4, 0);
    ideal.color.insert(ideal.color.end(), 4, 0);
  }
  std::set<double> seen;
  for (int k = 1; k <= subtexel_bits; ++k) {
    double wrong = 0;
    double all = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      if (engine.triangle[i] != 0 || ideal.triangle[i] != 0) continue;
      const auto part = [&](double x) { return std::floor(std::ldexp(x, k)); };
      ++all;
      if (part(engine.u[i]) != part(ideal.u[i]) || part(engine.v[i]) != part(ideal.v[i])) ++wrong;
    }
    const std::string name = "picture.wrong_subtexel_rate_" + std::to_string(k);
    const auto metric = std::ranges::find(picture_metrics(), name, &PictureMetric::name);
    ASSERT_NE(metric, picture_metrics().end()) << name;
    for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear}) {
      const PictureTally tally = metric->tally({engine, ideal, scene, filter});
      EXPECT_EQ(tally.counted, wrong) << name;
      EXPECT_EQ(tally.base, all) << name;
    }
    seen.insert(wrong);
  }
  EXPECT_EQ(seen.size(), subtexel_bits) << "each bit more is wrong more often";
}

TEST(PictureMetrics, ScenesAddUp) {
  ErrorReport one;
  for (const PictureMetric& metric : picture_metrics()) {
    one.picture.push_back(tally_of(metric, TextureFilter::nearest));
  }
  ErrorReport two = one;
  two.add(one);
  EXPECT_EQ(picture_value(two, "picture.color_max"), 4);
  EXPECT_EQ(picture_value(two, "picture.wrong_order"), 2);
  EXPECT_EQ(picture_value(two, "picture.wrong_order_rate"), 1.0 / 3);
  EXPECT_EQ(picture_value(two, "picture.psnr_db"), picture_value(one, "picture.psnr_db"));
}

TEST(PictureMetrics, WithoutPicturesOrByAnotherNameThereIsNoValue) {
  EXPECT_FALSE(picture_value({}, "picture.drawn"));
  EXPECT_EQ(picture_words({}), "");
  EXPECT_THROW(picture_value({}, "picture.colour"), InputError);
}

TEST(PictureMetrics, WordsTellThreeOfThem) {
  ErrorReport report;
  for (const PictureMetric& metric : picture_metrics()) {
    report.picture.push_back(tally_of(metric, TextureFilter::nearest));
  }
  EXPECT_TRUE(picture_words(report).ends_with(
      " dB, colour off by 4 at most, another triangle won 1 of 3 drawn pixels"))
      << picture_words(report);
}

TEST(FieldStatistics, EachIsWhatItsNameSays) {
  ErrorStat stat;
  for (const double error : {3.0, -4.0, -1.0, 0.0}) stat.add(10 + error, 10);
  const std::map<std::string_view, double> expected{{"bias", -0.5},
                                                    {"max", 4},
                                                    {"mean", 2},
                                                    {"median", 1.125},
                                                    {"rms", std::sqrt(26.0 / 4)},
                                                    {"p999", 4},
                                                    {"sqnr_db", 10 * std::log10(400.0 / 26)}};
  ASSERT_EQ(expected.size(), field_statistics().size());
  for (const FieldStatistic& s : field_statistics()) {
    ASSERT_TRUE(expected.contains(s.name)) << s.name;
    EXPECT_DOUBLE_EQ(s.value(stat), expected.at(s.name)) << s.name;
  }
}

}  // namespace
}  // namespace bitspan
