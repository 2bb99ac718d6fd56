// SPDX-License-Identifier: Apache-2.0
// Estimates what a configuration takes in an FPGA from its formats, in microseconds, for use inside a search.
//
// The estimate counts the structure as rtl/ builds it: registers, operands of multipliers, adders, choices,
// divider steps. LUTs and flip-flops are linear in these counts. The coefficients are fitted to the runs in
// config/studies/area_fit.csv (study/area_runs.hpp). docs/area.md has the errors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "study/area_shape.hpp"
#include "study/family.hpp"
#include "study/metrics.hpp"

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
AreaEstimate estimate_area(const Config& config, Family family, AreaPart part = AreaPart::spans);

// The part whose runs a part's coefficients are fitted to, with its own: both orders of the pixel stages are
// fitted as one.
constexpr AreaPart fitted_as(AreaPart part) { return part == AreaPart::spans ? part : AreaPart::pixels; }

// Returns the bits of which LUTs are made. Spans, ice40: products (what joins their parts included), sums,
// selects with memory, steps; ecp5: joins, sums, selects with memories of LUTs, steps, chained. Pixels,
// ice40: products, sums, memory; ecp5: sums, selects, memories of LUTs. There the sums include joins and
// steps.
std::vector<double> lut_terms(const AreaShape& shape, Family family, AreaPart part);
// Returns the bits that flip-flops hold: an iCE40 has no memory of LUTs, and a block has a register behind
// it.
double flip_flop_bits(const AreaShape& shape, Family family);

struct AreaFit {
  std::vector<double> luts;  // per bit of each of lut_terms
  double ffs = 0;            // per bit of flip_flop_bits
  bool operator==(const AreaFit&) const = default;
};
// Returns the coefficients of estimate_area, which fit_area found.
const AreaFit& area_fit(Family family, AreaPart part = AreaPart::spans);
// The errors of what this returns stay 0.
AreaEstimate estimate_area(const AreaShape& shape, Family family, AreaPart part, const AreaFit& fit);

// The ± as shares of the estimates, which left_out_shares found.
struct AreaErrorShares {
  double luts = 0, ffs = 0;
};
const AreaErrorShares& error_shares(Family family, AreaPart part = AreaPart::spans);

// Adds the estimates with their ±, estimate.*, of each part that is in RTL.
void add_estimates(const Config& config, Metrics& metrics);

// Returns "4512 ± 160": the error to two digits, and the value to as many places, at least whole.
std::string estimate_text(double value, double error);

}  // namespace bitspan
