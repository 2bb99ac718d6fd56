// SPDX-License-Identifier: Apache-2.0
// The estimate of areas: its coefficients against a fit of the runs they come from, its errors, and the runs
// themselves, one of them measured again.
#include "study/area_estimate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "config/rtl_timing.hpp"
#include "study/area_runs.hpp"
#include "tests/support/files.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

fs::path csv() { return fs::path(source_path()) / "config/studies/area_fit.csv"; }

// Points that no coefficient was fitted to: a shipped configuration with widths and keys of the RTL drawn at
// random, each of which may stay as it is. A draw that makes no legal configuration with RTL is left out.
fs::path unseen_csv() { return fs::path(source_path()) / "config/studies/area_unseen.csv"; }
constexpr std::uint64_t unseen_seed = 24;
constexpr int unseen_ice40 = 10, unseen_ecp5 = 20;

std::vector<AreaRun> drawn_runs(std::uint64_t seed, Family family, int count) {
  std::mt19937_64 random(seed + (family == Family::ecp5 ? 1000 : 0));
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::vector<std::string> words;
  for (const std::string& key : all_keys()) {
    const bool of_rtl = key.starts_with("formats.setup.") || key.starts_with("formats.edge.") ||
                        key.starts_with("formats.span.");
    if (of_rtl && key.ends_with(".word")) words.push_back(key);
  }
  for (const char* key :
       {"reciprocal.row.output.word", "reciprocal.pixel.output.word", "reciprocal.pixel.internal_bits",
        "reciprocal.pixel.operand_bits", "reciprocal.pixel.table_bits", "reciprocal.pixel.index_bits"}) {
    words.emplace_back(key);
  }
  const std::vector<std::pair<std::string, std::vector<KeyValue>>> choices = {
      {"rtl.shades", {true, false}},
      {"rtl.setup_multipliers", {std::int64_t{1}, std::int64_t{2}, std::int64_t{3}}},
      {"rtl.product_clocks", {std::int64_t{2}, std::int64_t{3}, std::int64_t{4}}},
      {"reciprocal.row.bits_per_cycle", {std::int64_t{1}, std::int64_t{2}, std::int64_t{4}}},
      {"slope.row", {std::string("divide"), std::string("reciprocal")}},
      {"perspective.mode", {std::string("delta_f"), std::string("affine"), std::string("const_depth_rows")}},
  };
  std::vector<AreaRun> out;
  while (std::ssize(out) < count) {
    AreaRun run;
    run.family = family;
    // depth20 takes Yosys more than a minute in iCE40.
    run.base = std::array{"narrow", "depth16", "depth20"}[below(family == Family::ice40 ? 2 : 3)];
    const Config base = shipped_config(run.base);
    const auto try_key = [&](const std::string& key, const KeyValue& value) {
      if (value_of_key(base, key) == value) return;
      run.settings.push_back({key, value});
      try {
        if (has_rtl(with_keys(base, run.settings))) return;
      } catch (const InputError&) {
      }
      run.settings.pop_back();
    };
    for (const std::string& key : words) {
      if (below(2) == 0) continue;
      const auto step = static_cast<std::int64_t>(below(7)) - 3;
      try_key(key, std::get<std::int64_t>(value_of_key(base, key)) + step);
    }
    for (const auto& [key, values] : choices) {
      if (below(3) == 0) try_key(key, values[below(values.size())]);
    }
    out.push_back(std::move(run));
  }
  return out;
}

// Errors in percent of the measured values, and how many lay within their ±.
class Summary {
 public:
  void add(double estimated, double error, std::int64_t measured) {
    const double counted = static_cast<double>(measured);
    errors_.push_back(std::abs(100 * (estimated / counted - 1)));
    held_ += std::abs(estimated - counted) <= error ? 1 : 0;
  }
  std::string text(int of) const {
    std::vector<double> sorted = errors_;
    std::ranges::sort(sorted);
    double squares = 0;
    for (const double e : sorted) squares += e * e;
    return fmt::format("{:.1f}, {:.1f}, {:.1f} | {} of {}", sorted[sorted.size() / 2],
                       std::sqrt(squares / static_cast<double>(sorted.size())), sorted.back(), held_, of);
  }

 private:
  std::vector<double> errors_;
  int held_ = 0;
};

std::vector<AreaRun> drawn_runs() {
  std::vector<AreaRun> out = drawn_runs(unseen_seed, Family::ecp5, unseen_ecp5);
  std::ranges::move(drawn_runs(unseen_seed, Family::ice40, unseen_ice40), std::back_inserter(out));
  return out;
}

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
  EXPECT_NEAR(errors.ffs.rms, ice40 ? 0.6 : 0.4, 0.05);
  EXPECT_NEAR(errors.ffs.max, ice40 ? 1.7 : 1.5, 0.05);
  EXPECT_NEAR(errors.ffs_left_out.rms, ice40 ? 0.6 : 0.4, 0.05);
  EXPECT_NEAR(errors.ffs_left_out.max, ice40 ? 1.8 : 1.5, 0.05);
  EXPECT_EQ(errors.multipliers.max, 0);
}

// The fit is made anew without each run in turn.
TEST_P(AreaEstimateOf, HasTheErrorOfAPointLeftOut) {
  const std::vector<AreaRun> runs = load_area_runs(csv());
  const AreaErrorShares shares = left_out_shares(runs, GetParam());
  EXPECT_NEAR(error_shares(GetParam()).luts, shares.luts, 5e-5);
  EXPECT_NEAR(error_shares(GetParam()).ffs, shares.ffs, 5e-5);
  // Counted by a second way: 68 % of the runs lie within, and no smaller share does that.
  int of = 0, within = 0, clearly_within = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].family != GetParam()) continue;
    std::vector<AreaRun> others = runs;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const AreaEstimate e =
        estimate_area(area_shape(config_of(runs[i])), GetParam(), fit_area(others, GetParam()));
    const double off = std::abs(static_cast<double>(runs[i].counts.luts) - e.luts);
    ++of;
    within += off <= shares.luts * e.luts * (1 + 1e-9) ? 1 : 0;
    clearly_within += off < shares.luts * e.luts * (1 - 1e-9) ? 1 : 0;
  }
  EXPECT_GE(within, 0.68 * of);
  EXPECT_LT(clearly_within, 0.68 * of);
  const AreaEstimate e = estimate_area(shipped_config("depth16"), GetParam());
  EXPECT_DOUBLE_EQ(e.luts_error, error_shares(GetParam()).luts * e.luts);
  EXPECT_DOUBLE_EQ(e.ffs_error, error_shares(GetParam()).ffs * e.ffs);
}

TEST(AreaEstimate, IsWrittenWithItsError) {
  EXPECT_EQ(estimate_text(4512.3, 163.7), "4512 ± 160");
  EXPECT_EQ(estimate_text(951.6, 9.66), "951.6 ± 9.7");
  EXPECT_EQ(estimate_text(12345.6, 1249), "12346 ± 1200");
  EXPECT_EQ(estimate_text(4.5123, 0.1637), "4.51 ± 0.16");
  EXPECT_EQ(estimate_text(16, 0), "16");
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

// docs/area.md has this table. BITSPAN_AREA_UNSEEN=new.csv draws the points and measures them, which takes 20
// minutes on two cores; without it the recorded counts are taken.
TEST(AreaUnseen, ErrsAsDocumented) {
  std::vector<AreaRun> drawn = drawn_runs();
  if (const char* whole = std::getenv("BITSPAN_AREA_UNSEEN")) {
    measure_area_runs(drawn, {});
    write_area_runs(whole, drawn);
  }
  const std::vector<AreaRun> runs = load_area_runs(unseen_csv());
  const std::vector<AreaRun> fitted = load_area_runs(csv());
  ASSERT_EQ(runs.size(), drawn.size());
  std::string table =
      "| family | base | LUTs | measured | flip-flops | measured | multipliers | measured |\n";
  table += "|---|---|---|---|---|---|---|---|\n";
  std::string summary;
  for (const Family family : {Family::ecp5, Family::ice40}) {
    Summary luts, ffs;
    int of = 0, exact = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const AreaRun& run = runs[i];
      if (run.family != family) continue;
      EXPECT_EQ(run.base, drawn[i].base);
      EXPECT_EQ(run.settings, drawn[i].settings) << i;  // those of the seed
      EXPECT_TRUE(std::ranges::none_of(fitted, [&](const AreaRun& f) {
        return f.family == family && f.base == run.base && f.settings == run.settings;
      })) << i;
      const AreaEstimate e = estimate_area(config_of(run), family);
      const AreaCounts& m = run.counts;
      table += fmt::format("| {} | {} | {} | {} | {} | {} | {:.0f} | {} |\n", to_string(family), run.base,
                           estimate_text(e.luts, e.luts_error), m.luts, estimate_text(e.ffs, e.ffs_error),
                           m.ffs, e.multipliers, m.multipliers);
      luts.add(e.luts, e.luts_error, m.luts);
      ffs.add(e.ffs, e.ffs_error, m.ffs);
      ++of;
      exact += e.multipliers == static_cast<double>(m.multipliers) ? 1 : 0;
    }
    summary += fmt::format("| {} | {} | {} | {} | {} |\n", to_string(family), of, luts.text(of), ffs.text(of),
                           family == Family::ice40 ? "" : fmt::format("{} exact", exact));
  }
  const std::string page = read_file(source_path("docs/area.md"));
  EXPECT_NE(page.find("\n" + table + "\n"), std::string::npos) << "docs/area.md lacks\n" << table;
  EXPECT_NE(page.find("\n" + summary + "\n"), std::string::npos) << "docs/area.md lacks\n" << summary;
}

}  // namespace
}  // namespace bitspan
