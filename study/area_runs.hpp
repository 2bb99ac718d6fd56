// SPDX-License-Identifier: Apache-2.0
// The measured runs that the estimate of areas is fitted to, the fit, and its errors.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "study/area.hpp"
#include "study/area_estimate.hpp"
#include "study/keys.hpp"

namespace bitspan {

// A measured run: a shipped configuration with keys set, a part of it, and its netlist.
struct AreaRun {
  std::string base;  // stem of a file of config/
  std::vector<KeySetting> settings;
  Family family = Family::ice40;
  AreaPart part = AreaPart::spans;
  AreaCounts counts;
  std::string tools;
};
Config config_of(const AreaRun& run);
// Reads config/studies/area_fit.csv, which has one line per run. Throws InputError, which names the line.
std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv);
void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs);
// Measures each run again, one after the other. Throws InputError where one is not `ok`.
void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits);

// Returns the coefficients that least squares of relative errors gives for the runs of the family and of the
// parts that are fitted as one (fitted_as).
AreaFit fit_area(std::span<const AreaRun> runs, Family family, AreaPart part = AreaPart::spans);

// Errors are relative to the measured values, in percent. "left_out" compares each run with the fit to the
// others.
struct AreaFitError {
  double max = 0, rms = 0;
};
struct AreaFitErrors {
  AreaFitError luts, luts_left_out, ffs, ffs_left_out, multipliers;
};
AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family, AreaPart part = AreaPart::spans);

// Returns the least shares of the estimates that hold for at least held_share of the runs, each against the
// fit to the others.
inline constexpr double held_share = 0.68;
AreaErrorShares left_out_shares(std::span<const AreaRun> runs, Family family,
                                AreaPart part = AreaPart::spans);

}  // namespace bitspan
