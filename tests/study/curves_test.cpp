// SPDX-License-Identifier: Apache-2.0
#include "study/curves.hpp"

#include <gtest/gtest.h>

#include "scene/bez.hpp"
#include "scene/demo.hpp"
#include "study/point.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

// Registers of so many fraction bits.
Config with_fraction(int fraction) {
  Config config = shipped_config("depth16");
  for (const FormatId id : {FormatId::curve_d0, FormatId::curve_d1, FormatId::curve_d2, FormatId::curve_d3}) {
    config.format(id) = {13 + fraction, 13, true, Rounding::rnd, Overflow::sat, false};
  }
  return config;
}

const PatchSet& teapot() {
  static const PatchSet set = read_bez(source_path("tests/data/teapot.bez"));
  return set;
}

// t^3 in four steps with four fraction bits: 0, 0, 2, 8 and 20 sixteenths. The cubic has 0, 1, 8, 27 and 64
// parts of 64.
TEST(Curves, OneByHand) {
  const auto stage = model::prepare_forward_difference(curve_formats(with_fraction(4)), 0, 2);
  const AdderCurve curve = curve_by_adders(stage, {0, 0, 0, 1}, 0);
  EXPECT_EQ(curve.points, (std::vector<double>{0, 0, 2 / 16.0, 8 / 16.0, 20 / 16.0}));
  EXPECT_EQ(curve.worst, 0.25);
  EXPECT_TRUE(curve.misses_end);
  // 5/64 in the middle is more than a last point that is right.
  const auto exact = model::prepare_forward_difference(curve_formats(with_fraction(6)), 0, 2);
  EXPECT_EQ(curve_by_adders(exact, {0, 0, 0, 1}, 0).worst, 0);
  EXPECT_FALSE(curve_by_adders(exact, {0, 0, 0, 1}, 0).misses_end);
}

TEST(Curves, ThreeGuardBitsPerHalvingAndNoneLess) {
  for (int k = patch_k_least; k <= patch_k_limit; ++k) {
    const CurveSet set = curves_of(teapot(), k);
    EXPECT_EQ(set.curves.size(), 32U * 3 * 8);
    const auto at = [&](int guard) { return curve_metrics(with_fraction(set.fraction + guard), set); };
    Metrics all = at(3 * k);
    EXPECT_EQ(all.at("curve.error_max"), 0) << k;
    EXPECT_EQ(all.at("curve.error_bound"), 0) << k;
    EXPECT_EQ(all.at("curve.missed_ends"), 0) << k;
    EXPECT_EQ(all.at("curve.inexact"), 0) << k;
    EXPECT_EQ(all.at("curve.register_bits"), 4 * (13 + set.fraction + 3 * k));
    double before = 0;
    for (const int missing : {1, 2, 3, 6}) {
      all = at(3 * k - missing);
      EXPECT_GT(all.at("curve.error_max"), before) << k << " " << missing;
      EXPECT_LE(all.at("curve.error_max"), all.at("curve.error_bound")) << k << " " << missing;
      EXPECT_GT(all.at("curve.missed_ends"), 0) << k << " " << missing;
      EXPECT_GE(all.at("curve.inexact"), all.at("curve.missed_ends")) << k << " " << missing;
      before = all.at("curve.error_max");
    }
  }
}

TEST(Curves, SeveralScenesAreOne) {
  Metrics all;
  const Config config = with_fraction(20);
  const Metrics a = curve_metrics(config, curves_of(teapot(), 2)),
                b = curve_metrics(config, curves_of(teapot(), 3));
  add_curve_metrics(a, all);
  EXPECT_EQ(all, a);
  add_curve_metrics(b, all);
  EXPECT_EQ(all.at("curve.curves"), 2 * 768);
  EXPECT_EQ(all.at("curve.missed_ends"), a.at("curve.missed_ends") + b.at("curve.missed_ends"));
  EXPECT_EQ(all.at("curve.error_max"), std::max(a.at("curve.error_max"), b.at("curve.error_max")));
  EXPECT_EQ(all.at("curve.register_bits"), a.at("curve.register_bits"));
}

TEST(Curves, ArePartOfAPoint) {
  Scene pot = demo_scene(32, 24);
  pot.name = "pot";
  const Scene demo = demo_scene(32, 24);
  const auto curves = [](const Scene& scene) -> std::optional<CurveSet> {
    if (scene.name != "pot") return std::nullopt;
    return curves_of(teapot(), 2);
  };
  const Config config = with_fraction(20);
  const PointResult point = PointMeter({pot, demo}, half_of_memory(), {}, curves).measure(config, false);
  const Metrics expected = curve_metrics(config, curves_of(teapot(), 2));
  for (const auto& [name, value] : expected) {
    EXPECT_EQ(point.metrics.at(name), value) << name;
    EXPECT_EQ(point.scenes.at(0).metrics.at(name), value) << name;
    EXPECT_FALSE(point.scenes.at(1).metrics.contains(name)) << name;
    EXPECT_NE(find_metric(name), nullptr) << name;
  }
  const PointResult without = PointMeter({pot, demo}).measure(config, false);
  EXPECT_FALSE(without.metrics.contains("curve.error_max"));
}

TEST(Curves, RefusesAGridWithoutFractionBits) {
  PatchSet set = teapot();
  set.fraction = -1;
  expect_refusal([&] { curves_of(set, 2); }, "fraction bits");
}

}  // namespace
}  // namespace bitspan
