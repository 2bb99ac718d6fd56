#include "config/rtl_timing.hpp"

#include <algorithm>
#include <string>

#include "config/modes.hpp"

namespace bitspan {
namespace {

constexpr int ceil_div(int n, int d) { return (n + d - 1) / d; }

// Table kinds may leave the key at 0; the row dividers then make one bit a clock.
int bits_per_cycle(const Reciprocal& unit) { return std::max(1, unit.bits_per_cycle); }

// Integer bits of the largest positive value.
int magnitude_bits(const Format& f) { return f.integer - (f.is_signed ? 1 : 0); }

bool row_divides(const Config& c) {
  return has_pixel_reciprocal(c.perspective) && !shares_reciprocal(c.row_slope);
}

int reciprocal_latency(const Reciprocal& unit, const OperandGrid& operand) {
  switch (unit.kind) {
    case ReciprocalKind::restoring:  // normalise, quotient bits, Q
      return 2 + restoring_shape(unit, operand).iterations;
    case ReciprocalKind::lut_linear:  // normalise, table, interpolation, Q
      return 4;
    case ReciprocalKind::lut_newton:  // normalise, table, two products a step, Q
      return 3 + 2 * unit.steps;
  }
  unreachable();
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

OperandGrid depth_sum(const Config& config, FormatId h) {
  const Format& b = config.format(FormatId::setup_b);
  const int fraction = std::max(config.format(h).fraction(), b.fraction());
  const int integer = std::max(magnitude_bits(config.format(h)), magnitude_bits(b)) + 1;
  return {integer + fraction, fraction};
}

OperandGrid pixel_operand(const Config& config) { return depth_sum(config, FormatId::span_h); }

OperandGrid row_operand(const Config& config) {
  if (has_plane_rows(config.perspective)) return pixel_operand(config);
  // x_r - x_l > 0 needs as many bits as x has, signed or not.
  const Format& x = config.format(FormatId::edge_x);
  return {x.word, x.fraction()};
}

RestoringShape restoring_shape(const Reciprocal& unit, const OperandGrid& operand) {
  // Normalised: 1/n lies in (1/2, 1]. Otherwise 1/d is at most 2^fraction of the operand.
  const int needed = std::max(0, unit.output.fraction() + 1);
  const int integer_bits = unit.normalize ? 1 : operand.fraction + 1;
  const int bits = std::max(1, integer_bits + needed);
  const int iterations = ceil_div(bits, bits_per_cycle(unit));
  return {iterations, iterations * bits_per_cycle(unit) - integer_bits};
}

RowDivideShape row_divide_shape(const Config& config) {
  const Format& h = config.format(FormatId::edge_h);
  const Format& f = config.format(FormatId::span_f_diff);
  const int l_fraction = config.format(FormatId::edge_x).fraction();
  const int h_word = h.word + 1;
  const int f_word = f.word + (f.is_signed ? 0 : 1);
  // A numerator of word bits on `fraction`, extended by k zeros, gives a quotient on fraction + k -
  // l_fraction.
  const auto extension = [&](const Format& step, int fraction) {
    return std::max(0, step.fraction() + 1 + l_fraction - fraction);
  };
  const int bits = std::max(h_word + extension(config.format(FormatId::span_h_step), h.fraction()),
                            f_word + extension(config.format(FormatId::span_f_step), f.fraction()));
  const int iterations = ceil_div(bits, bits_per_cycle(config.row_reciprocal));
  const int made = iterations * bits_per_cycle(config.row_reciprocal);
  return {iterations, made - h_word + h.fraction() - l_fraction, made - f_word + f.fraction() - l_fraction};
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
          ": reciprocal.pixel.pipelined is false; the RTL makes one pixel a clock and needs true");
    }
    t.pixel_unit = reciprocal_latency(config.pixel_reciprocal, pixel_operand(config));
    t.span = 1 + t.pixel_unit + 1;
  } else {
    t.span = 1;
  }
  return t;
}

}  // namespace bitspan
