// SPDX-License-Identifier: Apache-2.0
// Estimates what a configuration takes in an FPGA from its formats, in microseconds, for use inside a search.
//
// The estimate counts the structure as rtl/ builds it: registers, operands of multipliers, adders, choices,
// divider steps. LUTs and flip-flops are linear in these counts. The coefficients are fitted to the runs in
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
  // The ±: at least 68 % of the fitted runs, each left out of its fit, lay within it.
  double luts_error = 0;
  double ffs_error = 0;
};
// Throws InputError where the configuration has no RTL.
AreaEstimate estimate_area(const Config& config, Family family);

// The counts that the estimate is linear in, taken from the configuration. All but `blocks` are bits.
struct AreaShape {
  double registers = 0;    // flip-flops
  double products = 0;     // products of the operands' widths, over all multipliers
  double blocks = 0;       // 18x18 multipliers that these products are cut into
  double joins = 0;        // adders that join the blocks' results
  double sums = 0;         // other adders: differences, roundings, accumulators
  double selects = 0;      // two-way choices: shifters, operands of span_setup's multipliers, saturation
  double steps = 0;        // restoring division: a bit subtracted and chosen
  double chained = 0;      // steps behind another one of the same clock; doubled where the numerator varies
  double memory = 0;       // a FIFO of more than one span record; flip-flops in iCE40
  double memory_luts = 0;  // the same as ECP5's LUTs hold it, 16 records each
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
// Reads config/studies/area_fit.csv, which has one line per run. Throws InputError, which names the line.
std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv);
void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs);
// Measures each run again, one after the other. Throws InputError where one is not `ok`.
void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits);

struct AreaFit {
  // LUTs per bit: of products (what joins their parts included), sums, selects with memory, and steps in
  // ice40; of joins, sums, selects with memory_luts, steps and chained in ecp5.
  std::vector<double> luts;
  double ffs = 0;  // flip-flops per bit of registers
  bool operator==(const AreaFit&) const = default;
};
// area_fit has the coefficients of estimate_area. fit_area finds those that least squares of relative errors
// gives for the runs.
const AreaFit& area_fit(Family family);
AreaFit fit_area(std::span<const AreaRun> runs, Family family);
// The errors of what this returns stay 0.
AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit);

// Errors are relative to the measured values, in percent. "left_out" compares each run with the fit to the
// others.
struct AreaFitError {
  double max = 0, rms = 0;
};
struct AreaFitErrors {
  AreaFitError luts, luts_left_out, ffs, ffs_left_out, multipliers;
};
AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family);

// The ± as shares of the estimates. left_out_shares returns the least that hold for at least 68 % of the
// runs, each against the fit to the others. error_shares has those of config/studies/area_fit.csv.
inline constexpr double held_share = 0.68;
struct AreaErrorShares {
  double luts = 0, ffs = 0;
};
const AreaErrorShares& error_shares(Family family);
AreaErrorShares left_out_shares(std::span<const AreaRun> runs, Family family);

// Returns "4512 ± 160": the error to two digits, and the value to as many places, at least whole.
std::string estimate_text(double value, double error);

}  // namespace bitspan
