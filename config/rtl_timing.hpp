// SPDX-License-Identifier: Apache-2.0
// Clocks and internal widths of the RTL span interpolator, as a pure function of the configuration.
//
// engine/emit_sv writes these numbers into the package that the RTL is built from, the RTL asserts that its
// structure has them, and the timed model counts with them. docs/rtl.md, "Clocks", says what each clock does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/config.hpp"
#include "config/grid.hpp"
#include "config/lines.hpp"

namespace bitspan {

// Whether the RTL has the configuration: no rows by a triangle's plane, no dividers but those of u and v,
// and, where there is a pixel unit, one that is pipelined, for one pixel per clock, and that every pixel
// takes.
bool has_rtl(const Config& config);

// Width of the RTL's pixel index and count, unsigned: every pixel in the viewport that a record can name.
int pixel_index_bits(const Config& config);

// The operands of the reciprocal units, as positive numbers.
Grid depth_sum(const Config& config, FormatId h);  // h + B, h on the format named
Grid pixel_operand(const Config& config);          // h + B, h on span.h
Grid row_operand(const Config& config);            // L on edge.x; const_depth_rows: h + B

// The registers that u and v are made of, by mode.
FormatId texture_acc(const Config& config);   // span.f, or span.uv_acc where they are linear
FormatId texture_step(const Config& config);  // span.f_step, or span.uv_step
// What a line's slope along a row divides by L, in the modes with row ends.
Grid slope_numerator(const Config& config, LineId line);

// A restoring unit makes `iterations` * bits_per_cycle quotient bits, `fraction` of them right of the point:
// at least one more than its consumer keeps, so that the last bit and a sticky bit decide every rounding.
struct RestoringShape {
  int iterations = 1;
  int fraction = 0;
};
RestoringShape restoring_shape(const Reciprocal& unit, Grid operand);
// Clocks from a unit's operand to its result: it normalises, makes the result, and quantises.
int reciprocal_latency(const Reciprocal& unit, Grid operand, const RtlShape& shape);

// rtl/multiply_round.sv, and a product of setup_mac behind its operands: product, shift (2), sum, Q.
int multiply_round_clocks(int product_clocks);
// Clocks of a product whose multiplier others use, too: that of rtl/mul_pipe.sv or of mul_digits.sv.
int shared_product_clocks(const RtlShape& shape);

// The row's dividers (`row_slope = divide`): all run side by side and take equally many iterations.
struct RowDivideShape {
  int iterations = 1;
  std::array<int, line_count> fractions{};  // of a line's quotient, in front of Q of its step
};
RowDivideShape row_divide_shape(const Config& config);

// The dividers of a pixel in hyperbolic, fu / (h + B) and fv / (h + B), in front of Q[span.uv].
RestoringShape pixel_divide_shape(const Config& config);

// The lines that the RTL has: h, u and v, with [rtl] shades those, and the configuration's channels.
class RtlLines {
 public:
  explicit RtlLines(const Config& config);
  const LineId* begin() const { return lines_.data(); }
  const LineId* end() const { return lines_.data() + size_; }
  std::size_t size() const { return size_; }

 private:
  std::array<LineId, line_count> lines_{};
  std::size_t size_ = 0;
};

// The products of a line that the multipliers of span_setup form, by their places; -1 where the line never
// has one. Modes and slope forms have some of them. In hyperbolic `left` is gl and `diff` is gr, as in the
// record.
struct LineProducts {
  int diff = -1, slope = -1, start = -1, slope1 = -1, left = -1;
};
inline constexpr auto line_products = [] {
  std::array<LineProducts, line_count> products{};
  int place = 0;
  const auto add = [&](LineId first, LineId end, int LineProducts::*product) {
    for (auto line = static_cast<std::size_t>(first); line < static_cast<std::size_t>(end); ++line)
      products[line].*product = place++;
  };
  using P = LineProducts;
  add(LineId::fu, LineId::r, &P::diff);
  add(LineId::h, LineId::r, &P::slope);
  add(LineId::h, LineId::r, &P::start);
  add(LineId::fu, LineId::r, &P::slope1);
  add(LineId::fu, LineId::r, &P::left);
  add(LineId::r, LineId::fog, &P::slope);
  add(LineId::r, LineId::fog, &P::start);
  add(LineId::fog, LineId::count, &P::slope);
  add(LineId::fog, LineId::count, &P::start);
  return products;
}();
constexpr const LineProducts& products_of(LineId line) {
  return line_products[static_cast<std::size_t>(line)];
}
inline constexpr std::size_t row_product_count = line_products.back().start + 1;

// When span_setup does what for a row that it accepts at tick 0. A tick is a clock on which span_setup is not
// held up. Rows are accepted where the tick is a multiple of `interval`, and the multipliers repeat their
// work with that period: no two rows meet in one.
struct RowSchedule {
  struct Slot {
    int tick = -1;  // at which the operands are read; -1: the configuration has no such product
    int multiplier = 0;
  };
  std::array<Slot, row_product_count> slots{};
  // Of a Newton unit whose products take turns with the others; without any it has multipliers of its own.
  // The products are nq y and y (2 - nq y) of each step.
  std::array<Slot, 8> newton{};
  int newton_products = 0;
  int interval = 1;
  int product = 1;     // ticks from a slot to the product's register
  int unit = 0;        // ticks from the operand of the reciprocal unit or of the dividers to the result
  int reciprocal = 0;  // tick from which the row's reciprocal is held; 0 where there is none
  int divide = 0;      // tick at which the row's dividers start; 0 where there are none
  int latency = 1;     // LS: tick at which the span record leaves
  const Slot& slot(int product) const { return slots[static_cast<std::size_t>(product)]; }
};

struct RtlTiming {
  int pixel_unit = 0;      // latency of the pixel reciprocal or of the dividers, 0 where the mode has none
  int pixel_interval = 1;  // N: clocks from one pixel's issue to the next, in delta_f
  int span = 0;            // LP: issue to the buffer at the output
  RowSchedule row;
};

// Throws InputError where the configuration has no RTL.
RtlTiming rtl_timing(const Config& config);
// The timed model's clocks in hyperbolic with channels that are divided, which the RTL does not have: by
// dividers of their own, beside those of u and v. Elsewhere those of rtl_timing.
RtlTiming timing_with_dividers(const Config& config);

// The timed model's clocks of span_setup with slope.row = plane, which the RTL does not have: in the place of
// a slope's product stands gradient times Y, in that of a start's gradient times X; docs/timing.md.
RowSchedule row_schedule_by_plane(const Config& config);

}  // namespace bitspan
