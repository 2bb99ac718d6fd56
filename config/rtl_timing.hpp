// SPDX-License-Identifier: Apache-2.0
// Clocks and internal widths of the RTL span interpolator, as a pure function of the configuration.
//
// engine/emit_sv writes these numbers into the package that the RTL is built from, the RTL asserts that its
// structure has them, and the timed model counts with them. docs/rtl.md, "Clocks", says what each clock does.
#pragma once

#include "config/config.hpp"
#include "config/grid.hpp"

namespace bitspan {

// Whether a mode exists in RTL at all: delta_f and const_depth_rows.
bool has_rtl(const Config& config);

// Width of the RTL's pixel index and count, unsigned: every pixel in the viewport that a record can name.
int pixel_index_bits(const Config& config);

// The operands of the reciprocal units, as positive numbers.
Grid depth_sum(const Config& config, FormatId h);  // h + B, h on the format named
Grid pixel_operand(const Config& config);          // h + B, h on span.h
Grid row_operand(const Config& config);            // delta_f: L on edge.x; const_depth_rows: h + B

// A restoring unit makes `iterations` * bits_per_cycle quotient bits, `fraction` of them right of the point:
// at least one more than its consumer keeps, so that the last bit and a sticky bit decide every rounding.
struct RestoringShape {
  int iterations = 1;
  int fraction = 0;
};
RestoringShape restoring_shape(const Reciprocal& unit, Grid operand);
// Clocks from a unit's operand to its result: it normalises, makes the result, and quantises.
int reciprocal_latency(const Reciprocal& unit, Grid operand);

// The row's dividers (`row_slope = divide`): h and f run side by side and take equally many iterations.
struct RowDivideShape {
  int iterations = 1;
  int h_fraction = 0;  // fraction bits of the quotient in front of Q[span.h_step]
  int f_fraction = 0;  // the same in front of Q[span.f_step]
};
RowDivideShape row_divide_shape(const Config& config);

struct RtlTiming {
  int pixel_unit = 0;              // latency of the pixel reciprocal, 0 where the mode has none
  int row_unit = 0;                // latency of the row reciprocal or of the row dividers
  bool row_unit_pipelined = true;  // else span_setup holds one record at a time
  int span_setup = 0;              // LS: acceptance to result register
  int span = 0;                    // LP: issue to output
};

// Throws InputError where the mode has no RTL (hyperbolic, affine), and where delta_f has a pixel unit that
// is not pipelined (one pixel per clock could not be held).
RtlTiming rtl_timing(const Config& config);

}  // namespace bitspan
