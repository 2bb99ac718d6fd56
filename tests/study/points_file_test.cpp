// SPDX-License-Identifier: Apache-2.0
#include "study/points_file.hpp"

#include <gtest/gtest.h>

#include "tests/study/sweep_support.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {
namespace {

using Settings = std::vector<KeySetting>;

class PointsFile : public testing::Test {
 protected:
  StudyPlan plan(const std::string& csv, const std::string& rest = "", const std::string& study = "") const {
    folder_.write("p.csv", csv);
    return parse_study("[study]\nname = \"s\"\nbase = \"depth16\"\npoints = \"p.csv\"\n" + study + rest,
                       folder_.path("s.toml"), find_shipped);
  }
  void refuses(const std::string& csv, const std::string& part) const {
    expect_refusal([&] { static_cast<void>(plan(csv)); }, part);
  }

  TemporaryFolder folder_;
};

const std::string two = "depth.bits,reciprocal.pixel.kind\n";

TEST_F(PointsFile, EachLineIsAPoint) {
  const Settings first{{"depth.bits", std::int64_t{14}}, {"reciprocal.pixel.kind", std::string("restoring")}};
  // A blank cell is the base's value.
  const Settings second{{"depth.bits", std::int64_t{16}},
                        {"reciprocal.pixel.kind", std::string("lut_newton")}};
  for (const std::string& csv :
       {two + "14,restoring\n,lut_newton\n", two + "14,restoring\r\n16,lut_newton",
        "\xEF\xBB\xBF" + two + "\n14 , \"restoring\"\n\n,lut_newton\n\n",
        // As a study writes it: with the results beside the keys.
        std::string(
            "i,depth.bits,reciprocal.pixel.kind,status,span.u.p999,replay\n"
            "0,14,restoring,ok,0.5,\"bitspan study --db \"\"a b\"\" --replay 1\"\n1,,lut_newton,ok,,\n")}) {
    EXPECT_EQ(points_of(plan(csv)), (std::vector<Settings>{first, second})) << csv;
  }
  const StudyPlan stretched = plan("scene.s_ratio,rtl.shades\n10,true\n2.5e3,false\n");
  EXPECT_EQ(points_of(stretched)[1], (Settings{{"scene.s_ratio", 2500.0}, {"rtl.shades", false}}));
  EXPECT_TRUE(varies_scenes(stretched.axes[0]));
}

TEST_F(PointsFile, EqualPointsAndIllegalOnesArePoints) {
  Bench b;
  const SweepResult result = b.sweep(plan("formats.span.h.word\n18\n24\n24\n1000\n"));
  EXPECT_EQ(result.points, 4U);
  EXPECT_EQ(result.refused, 2U) << "one by the meter, one by the rules";
  EXPECT_EQ(b.fake.calls, 3) << "and the base";
}

TEST_F(PointsFile, WhatIsNoPointIsRefusedByItsLine) {
  refuses(two + "14,restoring\n15\n", "p.csv:3: has 1 cells; legal: 2, as the first line");
  refuses(two + "x,restoring\n", "p.csv:2: depth.bits: is \"x\"; legal: an integer, or blank");
  refuses(two + "14.5,restoring\n", "p.csv:2: depth.bits: is \"14.5\"");
  refuses(two + "99999999999999999999,restoring\n", "p.csv:2: depth.bits: is \"99999999999999999999\"");
  refuses("rtl.shades\nyes\n", "p.csv:2: rtl.shades: is \"yes\"; legal: true, false, or blank");
  for (const char* ratio : {"1", "nan", "inf", "1e7", "", "x"}) {
    refuses(std::string("scene.s_ratio,i\n") + ratio + ",0\n", "p.csv:2: scene.s_ratio: is");
  }
  refuses("depth.bit\n1\n", "p.csv:1: depth.bit: no such key of a configuration; nearest: depth.bits");
  refuses("depth.bits,depth.bits\n1,1\n", "p.csv:1: depth.bits: is there twice");
  refuses("i,status\n1,ok\n", "p.csv:1: names no key");
  refuses("", "p.csv: has no point");
  refuses("depth.bits\n", "p.csv: has no point");
  refuses("depth.bits\n\"14\n", "p.csv:2: has a quote that does not end");
  refuses("depth.bits\n\"1\"4\n", "p.csv:2: has a quote that does not end");
  refuses("depth.bits\n" + std::string(2 << 20, '1') + "\n", "p.csv:2: has 2097152 bytes");
  expect_refusal(
      [] {
        parse_study("[study]\nname = \"s\"\nbase = \"depth16\"\npoints = \"none.csv\"\n", "s.toml",
                    find_shipped);
      },
      "none.csv: cannot be read: No such file");
  expect_refusal(
      [] {
        parse_study("[study]\nname = \"s\"\nbase = \"depth16\"\npoints = \".\"\n", "s.toml", find_shipped);
      },
      "is a folder; expected a CSV file");
}

TEST_F(PointsFile, StandsAlone) {
  const std::string csv = "depth.bits\n14\n";
  expect_refusal([&] { static_cast<void>(plan(csv, words)); }, "study.points: is given beside [vary]");
  expect_refusal([&] { static_cast<void>(plan(csv, "[search]\n")); },
                 "study.points: is given beside [search]");
  expect_refusal([&] { static_cast<void>(plan(csv, "", "arrangement = \"list\"\n")); },
                 "study.arrangement: is given");
}

}  // namespace
}  // namespace bitspan
