// SPDX-License-Identifier: Apache-2.0
#include "study/area_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "study/area.hpp"

namespace bitspan {

AreaShape area_shape(const Config& config, AreaTarget target) {
  return target.part == AreaPart::spans ? span_shape(config) : pixel_shape(config, target);
}

namespace {

// Bits of a word that a block has for so many words, of its narrower and of its widest shape; 0 where it has
// fewer words.
int block_width(int words, Family family) {
  const bool ice40 = family == Family::ice40;
  int width = ice40 ? 16 : 36;
  for (int has = ice40 ? 256 : 512; has < words; has *= 2) width /= 2;
  return width;
}

bool is_table(const Memory& m) { return m.kind == Memory::Kind::table; }

double bits_of(const Memory& m) { return double(m.words) * m.width; }

// LUTs of ECP5, in which memory of 16 words by 4 bits has one port to read.
int memory_luts(const Memory& m) { return 4 * ceil_div(m.words, 16) * ceil_div(m.width, 4) * m.reads; }

// What is no block is in memories of LUTs, unless flip-flops are as few.
bool is_in_luts(const Memory& m, Family family) {
  if (family == Family::ice40 || is_table(m)) return false;
  return m.kind == Memory::Kind::line || memory_luts(m) < bits_of(m);
}

}  // namespace

// As memory_libmap of Yosys chooses: a bit of logic costs 1, and 1/16 in a table, a block 64 in iCE40 and 128
// in ECP5.
int memory_blocks(const Memory& m, Family family) {
  const bool ice40 = family == Family::ice40;
  if (m.kind == Memory::Kind::unclocked || (m.kind == Memory::Kind::line && !ice40)) return 0;
  // A block of ECP5 reads a table at two ports, of half the width.
  const int reads = is_table(m) && !ice40 ? ceil_div(m.reads, 2) : m.reads;
  const int width =
      std::max(1, block_width(m.words, family) / (is_table(m) && m.reads > 1 && !ice40 ? 2 : 1));
  const int blocks = reads * ceil_div(m.width, width);
  const double bits = bits_of(m);
  const double otherwise = is_table(m) ? bits / 16 : ice40 ? bits : std::min(bits, double(memory_luts(m)));
  return blocks * (ice40 ? 64 : 128) < otherwise ? blocks : 0;
}

// iCE40's division steps cost the same behind one another; ECP5's wide multiplexers do not. The runs of the
// pixel stages have no division, so a step counts there as many sums as the spans' coefficients make of it.
std::vector<double> lut_terms(const AreaShape& s, Family family, AreaPart part) {
  double memory = 0;
  for (const Memory& m : s.memories) {
    if (is_table(m) || memory_blocks(m, family) > 0) continue;
    if (family == Family::ice40) memory += bits_of(m);
    if (is_in_luts(m, family)) memory += memory_luts(m);
  }
  const bool ice40 = family == Family::ice40;
  if (fitted_as(part) == AreaPart::pixels) {
    if (ice40) return {s.products, s.sums + s.steps, memory};
    return {s.joins + s.sums + 2.6 * s.steps + s.chained, s.selects, memory};
  }
  if (ice40) return {s.products, s.sums, s.selects + memory, s.steps};
  return {s.joins, s.sums, s.selects + memory, s.steps, s.chained};
}

double flip_flop_bits(const AreaShape& s, Family family) {
  double bits = s.registers;
  for (const Memory& m : s.memories) {
    if (memory_blocks(m, family) > 0) {
      // A table has the register behind it. Another block reads what is being written, and registers on both
      // sides give what was there.
      const int beside = family == Family::ice40 ? 1 : 2;
      bits += double(m.width) * (is_table(m) ? -m.reads : beside);
    } else if (!is_table(m) && !is_in_luts(m, family)) {
      bits += bits_of(m);
    }
  }
  return bits;
}

namespace {

struct Fitted {
  AreaFit fit;
  AreaErrorShares shares;
};
// Least squares over config/studies/area_fit.csv; tests/study/area_estimate_test.cpp fits again and compares.
const Fitted& fitted(Family family, AreaPart part) {
  static const Fitted ice40_spans = {{{2.69466, 3.32031, 0.27047, 3.36911}, 0.99713}, {0.04984, 0.00372}};
  static const Fitted ecp5_spans = {{{1.31916, 1.99213, 0.67005, 5.36658, 2.21095}, 0.99837},
                                    {0.06118, 0.00404}};
  static const Fitted ice40_pixels = {{{2.75306, 1.92405, 0.80900}, 0.99135}, {0.02161, 0.00788}};
  static const Fitted ecp5_pixels = {{{1.95411, 0.45793, 1.93769}, 1.00157}, {0.03940, 0.00587}};
  const bool ice40 = family == Family::ice40;
  if (fitted_as(part) == AreaPart::pixels) return ice40 ? ice40_pixels : ecp5_pixels;
  return ice40 ? ice40_spans : ecp5_spans;
}

}  // namespace

const AreaFit& area_fit(Family family, AreaPart part) { return fitted(family, part).fit; }
const AreaErrorShares& error_shares(Family family, AreaPart part) { return fitted(family, part).shares; }

AreaEstimate estimate_area(const AreaShape& shape, Family family, AreaPart part, const AreaFit& fit) {
  AreaEstimate estimate;
  const std::vector<double> terms = lut_terms(shape, family, part);
  for (std::size_t i = 0; i < terms.size(); ++i) estimate.luts += fit.luts[i] * terms[i];
  estimate.ffs = fit.ffs * flip_flop_bits(shape, family);
  estimate.multipliers = family == Family::ice40 ? 0 : shape.blocks;
  return estimate;
}

AreaEstimate estimate_area(const Config& config, Family family, AreaPart part) {
  AreaEstimate estimate =
      estimate_area(area_shape(config, {family, part}), family, part, area_fit(family, part));
  estimate.luts_error = error_shares(family, part).luts * estimate.luts;
  estimate.ffs_error = error_shares(family, part).ffs * estimate.ffs;
  return estimate;
}

void add_estimates(const Config& config, Metrics& metrics) {
  for (const AreaPart part : area_parts) {
    if (!has_part(config, part)) continue;
    for (const Family family : families) {
      const AreaEstimate e = estimate_area(config, family, part);
      const std::string prefix = metric_prefix("estimate", {family, part});
      metrics[prefix + "luts"] = e.luts;
      metrics[plus_minus_of(prefix + "luts")] = e.luts_error;
      metrics[prefix + "ffs"] = e.ffs;
      metrics[plus_minus_of(prefix + "ffs")] = e.ffs_error;
      metrics[prefix + "multipliers"] = e.multipliers;
    }
  }
}

std::string estimate_text(double value, double error) {
  if (!(error > 0)) return fmt::format("{:.0f}", value);
  const double digit = std::floor(std::log10(error)) - 1;  // the second one's power of ten
  const double unit = std::pow(10.0, digit);
  return fmt::format("{:.{}f} ± {:.{}f}", value, std::max(0, static_cast<int>(-digit)),
                     std::round(error / unit) * unit, std::max(0, static_cast<int>(-digit)));
}

}  // namespace bitspan
