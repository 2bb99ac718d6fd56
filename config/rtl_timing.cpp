// SPDX-License-Identifier: Apache-2.0
#include "config/rtl_timing.hpp"

#include <algorithm>
#include <string>

#include "config/modes.hpp"
#include "config/reciprocal.hpp"

namespace bitspan {
namespace {

constexpr int ceil_div(int n, int d) { return (n + d - 1) / d; }

// Table kinds may leave the key at 0; the row dividers then make one bit a clock.
int bits_per_cycle(const Reciprocal& unit) { return std::max(1, unit.bits_per_cycle); }

bool row_divides(const Config& c) {
  return has_pixel_reciprocal(c.perspective) && !shares_reciprocal(c.row_slope);
}

}  // namespace

bool has_rtl(const Config& config) {
  switch (config.perspective) {
    case Perspective::delta_f:
    case Perspective::const_depth_rows:
      return true;
    case Perspective::hyperbolic:
    case Perspective::affine:
      return false;
  }
  unreachable();
}

int pixel_index_bits(const Config& config) {
  // Pixels lie inside the coordinate range or, a dda edge's accumulator being free, inside that one's.
  int bits = config.coordinate_bits;
  if (has_x_step(config)) bits = std::max(bits, config.format(FormatId::edge_x_acc).integer);
  return std::clamp(bits, 2, 31);
}

Grid depth_sum(const Config& config, FormatId h) {
  return positive(grid_of(config.format(h))) + positive(grid_of(config.format(FormatId::setup_b)));
}

Grid pixel_operand(const Config& config) { return depth_sum(config, FormatId::span_h); }

Grid row_operand(const Config& config) {
  if (has_plane_rows(config.perspective)) return pixel_operand(config);
  const Grid x = grid_of(config.format(FormatId::edge_x));
  return positive(x - x);  // x_r - x_l
}

RestoringShape restoring_shape(const Reciprocal& unit, Grid operand) {
  // Normalised: 1/n lies in (1/2, 1]. Otherwise 1/d is at most 2^fraction of the operand.
  const int needed = std::max(0, unit.output.fraction() + 1);
  const int integer_bits = unit.normalize ? 1 : operand.fraction + 1;
  const int bits = std::max(1, integer_bits + needed);
  const int iterations = ceil_div(bits, bits_per_cycle(unit));
  return {iterations, iterations * bits_per_cycle(unit) - integer_bits};
}

int reciprocal_latency(const Reciprocal& unit, Grid operand) {
  const int made = has_table(unit.kind) ? parts_of(unit).clocks : restoring_shape(unit, operand).iterations;
  return 1 + made + 1;  // normalise, make the result, Q
}

RowDivideShape row_divide_shape(const Config& config) {
  const Grid end_h = grid_of(config.format(FormatId::edge_h));
  const Grid h = end_h - end_h;
  const Grid f = as_signed(grid_of(config.format(FormatId::span_f_diff)));
  const int l_fraction = config.format(FormatId::edge_x).fraction();
  // A numerator extended by k zeros gives a quotient on fraction + k - l_fraction.
  const auto extended = [&](Grid numerator, FormatId step) {
    return aligned(numerator, config.format(step).fraction() + 1 + l_fraction).bits();
  };
  const int bits = std::max(extended(h, FormatId::span_h_step), extended(f, FormatId::span_f_step));
  const int iterations = ceil_div(bits, bits_per_cycle(config.row_reciprocal));
  const int made = iterations * bits_per_cycle(config.row_reciprocal);
  return {iterations, made - h.bits() + h.fraction - l_fraction, made - f.bits() + f.fraction - l_fraction};
}

RtlTiming rtl_timing(const Config& config) {
  if (!has_rtl(config)) {
    throw InputError(config.name + ": perspective.mode " + std::string(to_string(config.perspective)) +
                     " has no RTL; expected delta_f or const_depth_rows");
  }
  RtlTiming t;
  t.row_unit_pipelined = config.row_reciprocal.pipelined;
  t.row_unit = row_divides(config) ? 1 + row_divide_shape(config).iterations  // magnitude, quotient bits
                                   : reciprocal_latency(config.row_reciprocal, row_operand(config));
  t.span_setup = 1 + t.row_unit + 1 + 1;
  if (has_pixel_reciprocal(config.perspective)) {
    if (!config.pixel_reciprocal.pipelined) {
      throw InputError(
          config.name +
          ": reciprocal.pixel.pipelined is false; the RTL makes one pixel per clock and needs true");
    }
    t.pixel_unit = reciprocal_latency(config.pixel_reciprocal, pixel_operand(config));
    t.span = 1 + t.pixel_unit + 1;
  } else {
    t.span = 1;
  }
  return t;
}

}  // namespace bitspan
