// SPDX-License-Identifier: Apache-2.0
// What the cells of rtl/ are made of, which the counts of its parts share.
#pragma once

#include <algorithm>
#include <bit>

#include "config/config.hpp"
#include "config/grid.hpp"
#include "config/rtl_timing.hpp"
#include "study/area_shape.hpp"

namespace bitspan {

constexpr int bits_of(int n) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(0, n))));
}

constexpr int limb = 17;  // bits of a factor that a multiplier takes: rtl/mul_pipe.sv

struct Product {
  bool b_top_alone = false;
  int low = 0, high = 0;  // bits at the ends of the product that nobody reads
  int elsewhere = 0;      // bits of the factors that another register holds, too: Yosys merges them
  int clocks = 0;         // 0: rtl.product_clocks
};

// Mirrors rtl/: registers exactly where no tool drops them, and of the logic what LUTs are mostly made of.
class ShapeCells {
 protected:
  explicit ShapeCells(const Config& config) : c_(config) {}

  const Format& format(FormatId id) const { return c_.format(id); }
  int word(FormatId id) const { return format(id).word; }

  void add_registers(int bits, int times = 1) { shape_.registers += double(bits) * times; }
  // rtl/quantize_far.sv; half an ulp of SC_RND is added elsewhere.
  void quantize(const Format& to);
  // The same with the adder of what rounds.
  void round(const Format& to);
  void memory(int words, int width, Memory::Kind kind, int reads = 1);
  // Yosys brings more than two terms to two by full adders, two LUTs each, and then adds these.
  void join(int terms, int width);
  // rtl/mul_pipe.sv.
  void multiply(int a, bool a_signed, int b, bool b_signed, const Product& product = {});
  // rtl/shift_add.sv: x 2^-(base + shift) + c in `kept` bits.
  void shift_add(int x, int base, int shift_max, int kept);
  // rtl/restoring_core.sv, for a numerator of so many bits in front of zeros; 0: it is a constant, and leaves
  // no register of its own.
  void restoring(const Reciprocal& unit, int divisor, int iterations, int numerator, bool own_divisor);
  // rtl/reciprocal.sv; with the schedule of a row, whose multipliers it may share.
  void reciprocal(const Reciprocal& unit, Grid operand, const RowSchedule* row = nullptr);

  const Config& c_;
  AreaShape shape_;

 private:
  // What stands between the table and y. Each product comes product_clocks behind its factors.
  void table(const Reciprocal& unit);
  // Bits of an entry of a Newton table that are no constants: all lie from 1/2 to below 1.
  static int newton_entry(const Reciprocal& unit);
  // A Newton unit whose products are formed by span_setup's multipliers.
  void shared_newton(const Reciprocal& unit, const RowSchedule& row);
};

}  // namespace bitspan
