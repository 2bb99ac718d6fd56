// SPDX-License-Identifier: Apache-2.0
// The estimate of areas: its coefficients against a fit of the runs they come from, its errors, and the runs
// themselves, one of them measured again.
#include "study/area_estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

fs::path csv() { return fs::path(source_path()) / "config/studies/area_fit.csv"; }

class AreaEstimateOf : public testing::TestWithParam<Family> {};
INSTANTIATE_TEST_SUITE_P(Families, AreaEstimateOf, testing::Values(Family::ice40, Family::ecp5),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST_P(AreaEstimateOf, HasTheCoefficientsOfItsRuns) {
  const std::vector<AreaRun> runs = load_area_runs(csv());
  EXPECT_GE(std::ranges::count(runs, GetParam(), &AreaRun::family), 12);
  const AreaFit fitted = fit_area(runs, GetParam());
  const AreaFit& used = area_fit(GetParam());
  ASSERT_EQ(used.luts.size(), fitted.luts.size());
  for (std::size_t i = 0; i < fitted.luts.size(); ++i) EXPECT_NEAR(used.luts[i], fitted.luts[i], 5e-5) << i;
  EXPECT_NEAR(used.ffs, fitted.ffs, 5e-5);
  for (const double coefficient : used.luts) EXPECT_GT(coefficient, 0);
}

// docs/area.md states these.
TEST_P(AreaEstimateOf, ErrsAsDocumented) {
  const AreaFitErrors errors = area_fit_errors(load_area_runs(csv()), GetParam());
  const bool ice40 = GetParam() == Family::ice40;
  EXPECT_NEAR(errors.luts.rms, ice40 ? 3.3 : 5.4, 0.05);
  EXPECT_NEAR(errors.luts.max, ice40 ? 6.6 : 12.0, 0.05);
  EXPECT_NEAR(errors.luts_left_out.rms, ice40 ? 4.1 : 6.0, 0.05);
  EXPECT_NEAR(errors.luts_left_out.max, ice40 ? 7.8 : 13.1, 0.05);
  EXPECT_NEAR(errors.ffs.rms, ice40 ? 0.9 : 1.0, 0.05);
  EXPECT_NEAR(errors.ffs.max, ice40 ? 2.7 : 3.1, 0.05);
  EXPECT_NEAR(errors.ffs_left_out.rms, ice40 ? 0.9 : 1.0, 0.05);
  EXPECT_NEAR(errors.ffs_left_out.max, ice40 ? 2.8 : 3.2, 0.05);
  EXPECT_EQ(errors.multipliers.max, 0);
}

TEST_P(AreaEstimateOf, GrowsWithEveryWidth) {
  const Config base = shipped_config("depth16");
  const AreaEstimate before = estimate_area(base, GetParam());
  EXPECT_GT(before.luts, 1000);
  EXPECT_EQ(before.multipliers, GetParam() == Family::ice40 ? 0 : 16);
  for (const FormatId id :
       {FormatId::edge_x, FormatId::edge_h, FormatId::edge_uv, FormatId::span_f_diff, FormatId::span_h_step,
        FormatId::span_h, FormatId::span_f_step, FormatId::span_f, FormatId::span_uv}) {
    Config wider = base;
    wider.format(id).word += 1;
    const AreaEstimate after = estimate_area(wider, GetParam());
    EXPECT_GT(after.luts, before.luts) << key_of(id);
    EXPECT_GT(after.ffs, before.ffs) << key_of(id);
    EXPECT_GE(after.multipliers, before.multipliers) << key_of(id);
  }
}

TEST(AreaEstimate, KnowsTheKindsOfReciprocal) {
  // Each against depth16's lut_newton of one step.
  const Config base = shipped_config("depth16");
  const AreaShape newton = area_shape(base);
  Config config = base;
  config.pixel_reciprocal.kind = ReciprocalKind::restoring;
  const AreaShape restoring = area_shape(config);
  EXPECT_GT(restoring.steps, newton.steps);
  EXPECT_GT(restoring.registers, newton.registers);
  EXPECT_LT(restoring.products, newton.products);
  config = base;
  config.pixel_reciprocal.steps = 2;
  EXPECT_GT(area_shape(config).blocks, newton.blocks);
  config = base;
  config.row_slope = RowSlope::divide;
  EXPECT_EQ(area_shape(config).blocks, newton.blocks);  // one multiplier forms the products that are left
  EXPECT_GT(area_shape(config).steps, newton.steps);
}

TEST(AreaEstimate, KnowsTheShapeOfTheRtl) {
  const Config base = shipped_config("depth16");
  const AreaShape shipped = area_shape(base);
  Config config = base;
  config.rtl.setup_multipliers = 2;
  EXPECT_EQ(area_shape(config).blocks - shipped.blocks, 6);  // 3 limbs by 2
  EXPECT_GT(area_shape(config).joins, shipped.joins);
  config = base;
  config.rtl.product_clocks = 2;
  EXPECT_LT(area_shape(config).registers, shipped.registers);
  EXPECT_GT(area_shape(config).joins, shipped.joins);
  config = base;
  config.rtl.normalise_clocks = 2;
  EXPECT_LT(area_shape(config).registers, shipped.registers);
  // Digits make multipliers smaller, and turns make one of two.
  config = base;
  config.rtl.product_digits = 2;
  EXPECT_LT(area_shape(config).products, shipped.products);
  EXPECT_EQ(shipped.blocks - area_shape(config).blocks, 3);  // 3 limbs by 1
  const AreaShape digits = area_shape(config);
  config.rtl.pixel_clocks = 4;
  EXPECT_LT(area_shape(config).products, digits.products);
  EXPECT_LT(area_shape(config).registers, digits.registers);
  // The records of a FIFO are flip-flops in iCE40, and memories of LUTs in ECP5.
  config = base;
  config.rtl.fifo = 4;
  EXPECT_GT(estimate_area(config, Family::ice40).ffs, estimate_area(base, Family::ice40).ffs);
  EXPECT_LT(estimate_area(config, Family::ecp5).ffs, estimate_area(base, Family::ecp5).ffs);
  EXPECT_GT(estimate_area(config, Family::ecp5).luts, estimate_area(base, Family::ecp5).luts);
}

TEST(AreaEstimate, CountsShadesAndEveryMode) {
  for (const Perspective mode : all_perspectives) {
    Config config = shipped_config("depth16");
    config.perspective = mode;
    const AreaShape with = area_shape(config);
    config.rtl.shades = false;
    const AreaShape without = area_shape(config);
    EXPECT_GT(with.registers, without.registers);
    EXPECT_GT(with.sums, without.sums);
    // They have no multipliers of their own.
    EXPECT_EQ(with.blocks, without.blocks);
  }
}

TEST(AreaEstimate, RefusesAConfigurationWithoutRtl) {
  Config config = shipped_config("depth16");
  config.pixel_reciprocal.pipelined = false;
  EXPECT_THROW(estimate_area(config, Family::ecp5), InputError);
}

TEST(AreaRuns, AreWrittenAsTheyAreRead) {
  const std::vector<AreaRun> runs = load_area_runs(csv());
  const TemporaryFolder folder;
  write_area_runs(folder.path("copy.csv"), runs);
  EXPECT_EQ(folder.read("copy.csv"), read_file(csv()));
}

TEST(AreaRuns, NameABadLine) {
  const std::string header = "base,settings,family,luts,ffs,multipliers,memory_bits,tools\n";
  const TemporaryFolder folder;
  const auto message = [&folder](const std::string& text) {
    const std::string path = folder.write("bad.csv", text);
    return input_error([&path] { load_area_runs(path); }).substr(path.size());
  };
  EXPECT_EQ(message(header + "narrow,,ice40,1,2,3,4,Yosys\nnarrow,,ice40,1,2,3\n"),
            ":3: expected the 8 columns base,settings,family,luts,ffs,multipliers,memory_bits,tools");
  EXPECT_EQ(message(header + "narrow,,ice40,1,many,3,4,Yosys\n"), ":2: 'many' is no count");
  EXPECT_EQ(message(header + "narrow,,ice40,1,-2,3,4,Yosys\n"), ":2: '-2' is no count");
  EXPECT_EQ(message(header + "narrow,depth.bits,ice40,1,2,3,4,Yosys\n"), ":2: 'depth.bits' sets no key");
  EXPECT_EQ(message(header + "narrow,,xc7,1,2,3,4,Yosys\n"), ":2: 'xc7' is no family; legal: ice40, ecp5");
  EXPECT_EQ(message("something\n").substr(0, 16), ": cannot be read");
  EXPECT_THROW(fit_area({}, Family::ice40), InputError);
}

// Is the file what the tools say? The smallest run, again; the whole file with BITSPAN_AREA_FIT=new.csv.
TEST(AreaRuns, AreWhatTheToolsSay) {
  const std::vector<AreaRun> runs = load_area_runs(csv());
  std::vector<AreaRun> again;
  const char* whole = std::getenv("BITSPAN_AREA_FIT");
  if (whole != nullptr) {
    again = runs;
  } else {
    again.push_back(*std::ranges::min_element(runs, {}, [](const AreaRun& run) { return run.counts.luts; }));
  }
  const std::vector<AreaRun> recorded = again;
  measure_area_runs(again, {});
  if (whole != nullptr) write_area_runs(whole, again);
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (again[i].tools != recorded[i].tools)
      GTEST_SKIP() << again[i].tools << " is not " << recorded[i].tools;
    EXPECT_EQ(again[i].counts, recorded[i].counts) << recorded[i].base;
  }
}

}  // namespace
}  // namespace bitspan
