// SPDX-License-Identifier: Apache-2.0
// What a configuration takes in an FPGA, estimated from its formats in microseconds: for the inside of a
// search.
//
// The structure is counted as rtl/ builds it (registers, operands of multipliers, adders, shifters, divider
// steps); LUTs and flip-flops are linear in these counts, with coefficients fitted to the runs in
// config/studies/area_fit.csv. docs/area.md has the errors.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "study/area.hpp"
#include "study/keys.hpp"

namespace bitspan {

struct AreaEstimate {
  double luts = 0;
  double ffs = 0;
  double multipliers = 0;  // counted, not fitted
};
// Throws InputError where the mode has no RTL.
AreaEstimate estimate_area(const Config& config, Family family);

// What the estimate is linear in, counted from the configuration. Bits but for `blocks`.
struct AreaShape {
  double registers = 0;   // flip-flops
  double products = 0;    // products of the operands' widths, over all multipliers
  double blocks = 0;      // 18x18 multipliers that these products are cut into
  double block_sums = 0;  // adders that join the blocks' results
  double sums = 0;        // other adders: differences, roundings, accumulators
  double selects = 0;     // two-way choices: shifters, saturation
  double steps = 0;       // restoring division: a bit subtracted and chosen
  double chained = 0;     // those behind another step of the same clock; twice where the numerator varies
  double table = 0;       // tables
};
AreaShape area_shape(const Config& config);

// A measured run: a shipped configuration with keys set, and its netlist.
struct AreaRun {
  std::string base;  // stem of a file of config/
  std::vector<KeySetting> settings;
  Family family = Family::ice40;
  AreaCounts counts;
  std::string tools;
};
Config config_of(const AreaRun& run);
// config/studies/area_fit.csv: a line a run. Throws InputError naming the line.
std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv);
void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs);
// Measures each run again, one after the other; throws InputError where one is not `ok`.
void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits);

struct AreaFit {
  // LUTs a bit of products, sums, selects, steps in ice40; of block_sums, sums, selects, steps, chained in
  // ecp5.
  std::vector<double> luts;
  double ffs = 0;  // flip-flops per bit of registers
  bool operator==(const AreaFit&) const = default;
};
// The coefficients that estimate_area has, and those that least squares of relative errors gives for some
// runs.
const AreaFit& area_fit(Family family);
AreaFit fit_area(std::span<const AreaRun> runs, Family family);
AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit);

// Errors relative to the measured, in percent; left out: each run against the fit to the others.
struct AreaFitError {
  double max = 0, rms = 0;
};
struct AreaFitErrors {
  AreaFitError luts, luts_left_out, ffs, ffs_left_out, multipliers;
};
AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family);

}  // namespace bitspan
