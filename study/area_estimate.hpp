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
AreaEstimate estimate_area(const Config& config, Family family);

// A memory or a table, as it may become blocks, memories of LUTs or flip-flops.
struct Memory {
  enum class Kind : std::uint8_t {
    table,      // constants, read into registers
    clocked,    // read into registers
    unclocked,  // read in the same clock, which no block does
  };
  int words = 0, width = 0;
  Kind kind = Kind::clocked;
  int reads = 1;  // ports
};
// Returns the blocks that it takes, 0 where it is in LUTs or flip-flops.
int memory_blocks(const Memory& memory, Family family);

// The counts that the estimate is linear in, taken from the configuration. All but `blocks` are bits.
struct AreaShape {
  double registers = 0;  // flip-flops
  double products = 0;   // products of the operands' widths, over all multipliers
  double blocks = 0;     // 18x18 multipliers that these products are cut into
  double joins = 0;      // adders that join the blocks' results
  double sums = 0;       // other adders: differences, roundings, accumulators
  double selects = 0;    // two-way choices: shifters, operands of span_setup's multipliers, saturation
  double steps = 0;      // restoring division: a bit subtracted and chosen
  double chained = 0;    // steps behind another one of the same clock; doubled where the numerator varies
  std::vector<Memory> memories;
};
AreaShape area_shape(const Config& config);

// Returns the bits of which LUTs are made in a family: of products (what joins their parts included), sums,
// selects with memory, and steps in ice40; of joins, sums, selects with memories of LUTs, steps and chained
// in ecp5.
std::vector<double> lut_terms(const AreaShape& shape, Family family);
// Returns the bits that flip-flops hold: an iCE40 has no memory of LUTs, and a block has a register behind
// it.
double flip_flop_bits(const AreaShape& shape, Family family);

struct AreaFit {
  std::vector<double> luts;  // per bit of each of lut_terms
  double ffs = 0;            // per bit of flip_flop_bits
  bool operator==(const AreaFit&) const = default;
};
// Returns the coefficients of estimate_area, which fit_area found.
const AreaFit& area_fit(Family family);
// The errors of what this returns stay 0.
AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit);

// The ± as shares of the estimates, which left_out_shares found.
struct AreaErrorShares {
  double luts = 0, ffs = 0;
};
const AreaErrorShares& error_shares(Family family);

// Returns "estimate.ice40.", which the names of a family's estimates begin with.
std::string estimate_prefix(Family family);
// Adds the estimates with their ±, estimate.*, where the mode has RTL.
void add_estimates(const Config& config, Metrics& metrics);

// Returns "4512 ± 160": the error to two digits, and the value to as many places, at least whole.
std::string estimate_text(double value, double error);

}  // namespace bitspan
