// SPDX-License-Identifier: Apache-2.0
#include "study/area_estimate.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "config/grid.hpp"
#include "config/modes.hpp"
#include "config/row_products.hpp"
#include "config/rtl_timing.hpp"
#include "io/data_folder.hpp"

namespace bitspan {
namespace {

constexpr int limb = 17;  // bits of a factor that a multiplier takes: rtl/mul_pipe.sv

int ceil_div(int n, int d) { return (n + d - 1) / d; }
int bits_of(int n) { return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(0, n)))); }

// The difference of two values of a register.
Grid difference_of(const Format& f) { return grid_of(f) - grid_of(f); }

// How rtl/mul_pipe.sv cuts a factor: limbs, and up to 3 bits above them that add the other factor, beside a
// top bit that stands alone.
struct Cut {
  int limbs = 1;
  int low = 0;    // bits of the limbs
  int spare = 0;  // bits above them
};
Cut cut_of(int bits, bool is_signed, bool top_alone) {
  const int sign = is_signed ? 1 : 0;
  const int magnitude = bits - sign;
  const int above = magnitude % limb;
  const bool spares = magnitude > limb && above > 0 && above + sign - (top_alone ? 1 : 0) <= 3;
  const int in_limbs = spares ? magnitude - above : magnitude;
  return {std::max(1, ceil_div(in_limbs, limb)), spares ? in_limbs : bits, spares ? above + sign : 0};
}

// Mirrors rtl/: registers exactly where no tool drops them, and of the logic what LUTs are mostly made of.
class Counter {
 public:
  explicit Counter(const Config& config)
      : c_(config),
        timing_(rtl_timing(config)),
        lines_(config),
        planes_(has_plane_rows(config.perspective)) {}
  AreaShape count() {
    multipliers();
    if (planes_) {
      plane_rows();
    } else {
      row_ends();
    }
    record();
    walk();
    if (has_pixel_reciprocal(c_.perspective)) pixels();
    if (has_pixel_quotients(c_.perspective)) quotients();
    return shape_;
  }

 private:
  using F = FormatId;
  const Format& format(F id) const { return c_.format(id); }
  int word(F id) const { return format(id).word; }

  void add_registers(int bits, int times = 1) { shape_.registers += double(bits) * times; }

  // rtl/quantize_far.sv; half an ulp of SC_RND is added elsewhere.
  void quantize(const Format& to) {
    if (to.overflow != Overflow::wrap) shape_.selects += to.word;
  }

  // Yosys brings more than two terms to two by full adders, two LUTs each, and then adds these.
  void join(int terms, int width) {
    if (terms > 1) shape_.joins += double(width) * (1 + 2 * (terms - 2));
  }

  // rtl/mul_pipe.sv.
  void multiply(int a, bool a_signed, int b, bool b_signed, bool b_top_alone = false) {
    const int clocks = c_.rtl.product_clocks;
    shape_.products += double(a) * b;
    if (clocks == 1) {
      // Yosys cuts into pieces of 18 bits; a last piece of a single bit becomes LUTs.
      const auto pieces = [](int bits) { return bits / (limb + 1) + (bits % (limb + 1) > 1 ? 1 : 0); };
      shape_.blocks += double(pieces(a)) * pieces(b);
      shape_.joins += double(pieces(a) * pieces(b) - 1) * std::max(a, b);
      add_registers(a + b);
      return;
    }
    const Cut of_a = cut_of(a, a_signed, false);
    const Cut of_b = cut_of(b, b_signed, b_top_alone);
    const bool spare = of_a.spare + of_b.spare > 0;
    shape_.blocks += double(of_a.limbs) * of_b.limbs;
    add_registers(of_a.low * of_b.limbs + of_b.low * of_a.limbs);
    // What is above the limbs: the other factor, once per bit.
    shape_.joins += of_a.spare * b + of_b.spare * of_a.low;
    if (of_a.spare > 0) add_registers(b + of_a.spare);
    if (of_b.spare > 0) add_registers(of_a.low + of_b.spare);
    if (clocks == 2) {
      // Two diagonals of partial products meet in each bit.
      const int diagonals = 2 * std::min(of_a.limbs, of_b.limbs) - (of_a.limbs == of_b.limbs ? 1 : 0);
      join(diagonals + (of_a.spare > 0 ? 1 : 0) + (of_b.spare > 0 ? 1 : 0), a + b - limb);
    } else {
      if (of_a.limbs > 1) shape_.joins += double(of_b.limbs) * of_a.low;
      if (of_a.spare > 0 && of_b.spare > 0) join(2, std::max(a, b));
      join(of_b.limbs + (spare ? 1 : 0), std::max(a, b));
    }
    if (clocks >= 3) add_registers(of_a.low * of_b.limbs + of_b.low + (spare ? std::max(a, b) + 3 : 0));
    add_registers(a + b, std::max(1, clocks - 2));
  }

  // rtl/mul_digits.sv.
  void multiply_digits(int a, int b) {
    const int digits = c_.rtl.product_digits;
    const int digit = ceil_div(b, digits);
    shape_.products += double(a) * digit;
    const int blocks = ceil_div(a - 1, limb) * ceil_div(digit, limb);
    shape_.blocks += blocks;
    shape_.joins += double(blocks - 1) * std::max(a, digit);
    shape_.sums += a + digit;
    shape_.selects += digits * digit;
    add_registers(2 * (a + digit) + (digits - 1) * (digit + 1));
  }

  // rtl/setup_mac.sv: one multiplier, with a choice of the operands of `products`. Where nothing is added
  // that is no constant, c is of no bits.
  void turns(int products, int a, int b, int c, int shift, int shift_base, int shift_max, int kept) {
    if (c_.rtl.product_digits > 1) {
      multiply_digits(a, b);
      add_registers(a + b + 3 * c + 2 * shift + c_.rtl.product_digits + 2);
    } else {
      const int clocks = c_.rtl.product_clocks;
      add_registers(a + b + c * (3 + clocks) + shift * (1 + clocks));
      multiply(a, true, b, true);
    }
    shift_add(a + b, shift_base, shift_max, kept);
    shape_.selects += double(products) * (a + b + shift);
  }

  // rtl/shift_add.sv: x 2^-(base + shift) + c in `kept` bits.
  void shift_add(int x, int base, int shift_max, int kept) {
    const int aligned = std::max(1, x - base);
    const int coarse = std::min(aligned, kept + std::min(shift_max, 7));
    const int shift = bits_of(shift_max);
    shape_.selects += double(std::max(0, shift - 3)) * coarse + double(std::min(shift, 3)) * kept;
    // Whether what is shifted out, and what stays above, is more than signs.
    shape_.selects += aligned;
    shape_.sums += kept;
    add_registers(coarse + 2 * kept);
  }

  // rtl/row_hold.sv: a value that is written at one tick and last read at another.
  void hold(int width, int written, int last) {
    add_registers(width, (last - written) / timing_.row.interval + 1);
  }
  int tick(int product) const { return timing_.row.slot(product).tick; }
  int done(int product) const { return tick(product) + timing_.row.product; }

  void multipliers() {
    const RowMultipliers m = row_multipliers(c_, timing_.row);
    const int shift = bits_of(m.shift_max);
    for (int i = 0; i < m.count; ++i) {
      // Starts add what is no constant, but those of fu and fv in delta_f.
      const bool adds = std::ranges::any_of(lines_, [&](LineId line) {
        const bool constant = line_of(line).row.difference && has_pixel_reciprocal(c_.perspective);
        return !planes_ && !constant && timing_.row.slot(products_of(line).start).multiplier == i;
      });
      const auto products = std::ranges::count_if(timing_.row.slots, [&](const RowSchedule::Slot& slot) {
        return slot.tick >= 0 && slot.multiplier == i;
      });
      turns(static_cast<int>(products), m.a, m.b, adds ? m.c : 0, shift, m.shift_base, m.shift_max, m.sum);
    }
    shape_.selects += double(timing_.row.newton_products) * (m.a + m.b);
    add_registers(bits_of(timing_.row.interval - 1) + (timing_.row.latency - 1) / timing_.row.interval + 1);
  }

  // rtl/row_result.sv.
  void result(int product, const Format& to, int last) {
    hold(to.word, done(product), last);
    quantize(to);
  }

  // Bits of the numerator of a line's slope.
  int numerator(LineId line) const { return as_signed(slope_numerator(c_, line)).bits(); }
  Line line_of(LineId line) const { return bitspan::line_of(line, c_.perspective); }

  // The row's ends.
  void row_ends() {
    const RowSchedule& row = timing_.row;
    const Format& f_diff = format(F::span_f_diff);
    const LineProducts& of_u = products_of(LineId::fu);
    const LineProducts& of_v = products_of(LineId::fv);
    const int uv_difference = difference_of(format(F::edge_uv)).bits();
    const int sum = as_signed(depth_sum(c_, F::edge_h)).bits();
    const int p = pre_step(c_).bits();
    const int length = row_operand(c_).bits();
    const bool divides = !shares_reciprocal(form_of(c_.row_slope));
    const bool hyperbolic = has_pixel_quotients(c_.perspective);
    const bool affine = has_linear_texture(c_.perspective);
    const auto slope_tick = [&](LineId line) { return divides ? row.divide : tick(products_of(line).slope); };
    shape_.sums += length + p;
    hold(length, 1, divides ? row.divide : 1);
    int last_start = 1;
    int last_slope = 1;
    for (const LineId line : lines_) {
      last_start = std::max(last_start, tick(products_of(line).start));
      last_slope = std::max(last_slope, slope_tick(line));
      if (line_of(line).row.difference) continue;
      // Differences, and the left end for the start.
      shape_.sums += numerator(line);
      hold(numerator(line), 1, slope_tick(line));
      hold(word(line_of(line).edge.kept), 1, tick(products_of(line).start));
    }
    hold(p, 1, last_start);
    hold(2 * pixel_index_bits(c_), 1, row.latency);
    if (hyperbolic) {
      shape_.sums += 2 * sum;
      for (const int end : {of_u.left, of_v.left}) hold(sum + word(F::edge_uv), 1, tick(end));
      hold(sum + 2 * word(F::edge_uv), 1, std::max(tick(of_u.diff), tick(of_v.diff)));
      for (const LineId line : {LineId::fu, LineId::fv}) {
        const LineProducts& p = products_of(line);
        const int both = std::max(done(p.left), done(p.diff));
        result(p.left, f_diff, tick(p.start));
        result(p.diff, f_diff, both);
        shape_.sums += numerator(line);
        hold(numerator(line), both + 1, slope_tick(line));
      }
    } else if (!affine) {
      shape_.sums += 2 * uv_difference + sum;
      hold(sum + 2 * uv_difference, 1, std::max(tick(of_u.diff), tick(of_v.diff)));
      hold(2 * word(F::edge_uv), 1, row.latency);
      for (const LineId line : {LineId::fu, LineId::fv})
        result(products_of(line).diff, f_diff, slope_tick(line));
    }
    if (divides) {
      const RowDivideShape divide = row_divide_shape(c_);
      const int made = row.divide + timing_.row.unit + 1;
      bool first = true;  // the others have the same divisor and the same control
      for (const LineId line : lines_) {
        const Format& step = format(line_of(line).row.step);
        const int bits = divide.iterations * std::max(1, c_.row_reciprocal.bits_per_cycle);
        add_registers(numerator(line) + (first ? length : 0));
        shape_.sums += numerator(line) + bits;  // magnitude, sign of the quotient
        restoring(c_.row_reciprocal, length, divide.iterations, false, first);
        first = false;
        if (step.rounding != Rounding::trn) shape_.sums += step.word;
        quantize(step);
        hold(step.word, made, row.latency);
      }
    } else {
      reciprocal(c_.row_reciprocal, row_operand(c_), &row);
      hold(c_.row_reciprocal.output.word + bits_of(row_operand(c_).bits()), row.reciprocal, last_slope);
      for (const LineId line : lines_)
        result(products_of(line).slope, format(line_of(line).row.step), row.latency);
    }
    for (const LineId line : lines_)
      result(products_of(line).start, format(line_of(line).row.acc), row.latency);
  }

  // const_depth_rows.
  void plane_rows() {
    const RowSchedule& row = timing_.row;
    const Grid sum = row_operand(c_);
    shape_.sums += sum.bits();
    add_registers(sum.bits());
    hold(2 * pixel_index_bits(c_) + line() + word(F::span_h) + sides(2), 1, row.latency);
    reciprocal(c_.row_reciprocal, sum, &row);
    int last = row.reciprocal;
    for (const LineId line : {LineId::fu, LineId::fv}) {
      const LineProducts& of_line = products_of(line);
      for (const int p : {of_line.start, of_line.slope, of_line.slope1}) {
        const bool start = p == of_line.start;
        hold(word(start ? F::span_f : F::span_f_step), 1, tick(p));
        result(p, format(start ? F::span_uv_acc : F::span_uv_step), row.latency);
        last = std::max(last, tick(p));
      }
    }
    hold(c_.row_reciprocal.output.word + bits_of(sum.bits()), row.reciprocal, last);
  }
  // The digital line: its phase and k.
  int line() const { return std::max(1, format(F::plane_k).fraction()) + word(F::plane_k); }

  // The lines behind u and v: shades and channels.
  std::span<const LineId> side_lines() const { return std::span(lines_.begin(), lines_.size()).subspan(3); }
  // Their registers in a record that has so many steps of each.
  int sides(int steps) const {
    int bits = 0;
    for (const LineId line : side_lines()) {
      bits += word(line_of(line).row.acc) + steps * word(line_of(line).row.step);
    }
    return bits;
  }
  // A pixel as it leaves: x, step, last, h, u, v, the shades and the channels.
  int pixel_bits() const {
    int bits = pixel_index_bits(c_) + 2 + word(F::span_h) + 2 * word(F::span_uv);
    for (const LineId line : side_lines()) bits += word(line_of(line).row.kept);
    return bits;
  }

  // rtl/fifo.sv between span_setup and span: what span reads of a record.
  void record() {
    const int common = 2 * pixel_index_bits(c_) + word(F::span_h) + sides(planes_ ? 2 : 1);
    const int base = has_pixel_reciprocal(c_.perspective) ? word(F::edge_uv) : 0;  // u1, v1
    const int ends = word(F::span_h_step) + 2 * (base + word(texture_acc(c_)) + word(texture_step(c_)));
    const int plane = line() + 2 * word(F::span_uv_acc) + 4 * word(F::span_uv_step);
    const int bits = common + (planes_ ? plane : ends);
    if (c_.rtl.fifo == 1) {
      add_registers(bits);
    } else {
      shape_.memory += double(bits) * c_.rtl.fifo;
      shape_.memory_luts += double(bits) * ceil_div(c_.rtl.fifo, 16);
    }
    // The same fields are in the registers of the span that is walked.
    add_registers(bits + timing_.span);
  }

  // rtl/accumulate.sv, with the choice between a start value and the next one.
  void accumulate(const Format& step, const Format& to) {
    shape_.sums += std::max(to.word, step.word);
    quantize(to);
    shape_.selects += to.word;
  }

  // rtl/span.sv up to the issue, and the buffer of two pixels at its output.
  void walk() {
    const int index = pixel_index_bits(c_);
    shape_.sums += 2 * index;
    shape_.selects += 2 * index;
    for (int i = 0; i < 2; ++i) accumulate(format(texture_step(c_)), format(texture_acc(c_)));
    add_registers(pixel_bits(), 2);
    shape_.selects += pixel_bits();
    for (const LineId id : side_lines()) {
      const Line line = line_of(id);
      const Format& kept = format(line.row.kept);
      accumulate(format(line.row.step), format(line.row.acc));
      if (kept.rounding != Rounding::trn) shape_.sums += kept.word;
      quantize(kept);
      span_delay(kept.word, timing_.span);
      if (planes_) shape_.selects += word(line.row.step);
    }
    if (planes_) {
      shape_.sums += line();
      shape_.selects += 2 * word(F::span_uv_step) + line();
    } else {
      accumulate(format(F::span_h_step), format(F::span_h));
    }
    if (!has_linear_texture(c_.perspective)) return;
    add_registers(index + 2 + word(F::span_h) + 2 * word(F::span_uv));
    for (int i = 0; i < 2; ++i) {
      if (format(F::span_uv).rounding != Rounding::trn) shape_.sums += word(F::span_uv);
      quantize(format(F::span_uv));
    }
  }

  // rtl/span.sv behind the issue, in hyperbolic.
  void quotients() {
    const int f = signed_grid(format(F::span_f)).bits();
    const Grid operand = pixel_operand(c_);
    const RestoringShape divide = pixel_divide_shape(c_);
    Reciprocal unit = c_.pixel_reciprocal;
    unit.pipelined = true;
    const int bits = divide.iterations * std::max(1, unit.bits_per_cycle);
    shape_.sums += operand.bits();
    add_registers(2 * operand.bits());
    add_registers(2 * (word(F::span_f) + f));
    add_registers(pixel_index_bits(c_) + 1 + word(F::span_h), timing_.span);
    for (int i = 0; i < 2; ++i) {
      const Format& to = format(F::span_uv);
      shape_.sums += f + bits;  // magnitude, sign of the quotient
      restoring(unit, operand.bits(), divide.iterations, false, i == 0);
      add_registers(1, divide.iterations);
      if (to.rounding != Rounding::trn) shape_.sums += to.word;
      quantize(to);
      add_registers(to.word);
    }
  }

  // rtl/span.sv behind the issue, in delta_f.
  void pixels() {
    const Format& f = format(F::span_f);
    const Format& m = c_.pixel_reciprocal.output;
    const Format& uv = format(F::edge_uv);
    const Format& to = format(F::span_uv);
    const int clocks = c_.rtl.product_clocks;
    const Grid operand = pixel_operand(c_);
    const Exponents e = exponents_of(c_.pixel_reciprocal, operand);
    shape_.sums += operand.bits();
    add_registers(operand.bits());
    reciprocal(c_.pixel_reciprocal, operand);
    const int recip = 1 + timing_.pixel_unit;
    const int v_slot = recip + (timing_.pixel_interval > 1 ? c_.rtl.product_digits : 0);
    span_delay(f.word + uv.word, recip);
    span_delay(f.word + uv.word, v_slot);
    span_delay(pixel_index_bits(c_) + 1 + word(F::span_h), timing_.span);
    // A normalised mantissa is at most 1.
    const bool top_alone = c_.pixel_reciprocal.normalize && !m.is_signed && m.word == m.fraction() + 1;
    const int fraction = std::max(uv.fraction(), to.fraction() + 1);
    const int added = uv.word + 1 + fraction - uv.fraction() + 1;
    const int kept = std::max(to.word + fraction - to.fraction() + 1, added) + 4;
    const int shift_base = f.fraction() + m.fraction() + e.low - fraction;
    const int shift_max = e.high - e.low;
    if (timing_.pixel_interval > 1) {
      span_delay(m.word + bits_of(shift_max), v_slot - recip);
      turns(2, as_signed(grid_of(f)).bits(), as_signed(grid_of(m)).bits(), added, bits_of(shift_max),
            shift_base, shift_max, kept);
      quantize(to);
      span_delay(to.word, c_.rtl.product_digits + 1);
      span_delay(to.word, 1);
      add_registers(bits_of(timing_.pixel_interval - 1) + 2);
      return;
    }
    // rtl/multiply_round.sv, twice; both have the same shift.
    add_registers(bits_of(shift_max), clocks);
    for (int i = 0; i < 2; ++i) {
      multiply(f.word, f.is_signed, m.word, m.is_signed, top_alone);
      shift_add(f.word + m.word, shift_base, shift_max, kept);
      add_registers(uv.word + 1, clocks + 2);
      quantize(to);
      add_registers(to.word);
    }
  }
  // rtl/span_delay.sv.
  void span_delay(int width, int ticks) { add_registers(width, ceil_div(ticks, timing_.pixel_interval)); }

  // rtl/restoring_core.sv. A numerator that is a constant leaves no register of its own.
  void restoring(const Reciprocal& unit, int divisor, int iterations, bool constant_numerator,
                 bool own_divisor) {
    const int per_cycle = std::max(1, unit.bits_per_cycle);
    const int bits = iterations * per_cycle;
    if (unit.pipelined) {
      shape_.steps += double(bits) * divisor;
      // A step behind another of the same clock chooses among what both may leave; where the numerator is a
      // constant, half of that is known.
      shape_.chained += double(divisor) * (per_cycle - 1) * iterations * (constant_numerator ? 1 : 2);
      for (int i = 1; i <= iterations; ++i) {
        const int made = i * per_cycle;
        add_registers(constant_numerator ? divisor + made : std::min(divisor, made) + bits);
      }
      if (own_divisor) add_registers(divisor, iterations - 1);
      return;
    }
    // Units in a row.
    shape_.steps += double(per_cycle) * divisor;
    shape_.selects += double(per_cycle) * (divisor + bits);
    add_registers(divisor + bits + (own_divisor ? divisor + iterations + 1 : 0), per_cycle);
  }

  // rtl/reciprocal.sv; with the schedule of a row, whose multipliers it may share.
  void reciprocal(const Reciprocal& unit, Grid operand, const RowSchedule* row = nullptr) {
    const int op = operand.bits();
    const int shift = bits_of(op);
    const int normalise = c_.rtl.normalise_clocks;
    const int core = (row != nullptr ? row->unit : reciprocal_latency(unit, operand, c_.rtl)) - normalise - 1;
    const bool lut = has_table(unit.kind);
    if (lut || unit.normalize) {
      shape_.sums += op;  // leading zeros
      shape_.selects += double(shift) * (lut ? std::min(op, (op + unit.operand_bits) / 2) : op);
      add_registers(op + shift, normalise - 1);
      add_registers(shift, lut || unit.pipelined ? 1 + core : 1 + std::max(1, unit.bits_per_cycle));
      add_registers(lut ? std::min(op - 1, unit.operand_bits) : op);
    } else {
      add_registers(op, normalise);
    }
    if (lut) {
      if (row != nullptr && row->newton_products > 0) {
        shared_newton(unit, *row);
      } else {
        table(unit);
      }
    } else {
      restoring(unit, op, restoring_shape(unit, operand).iterations, true, true);
    }
    if (lut && !unit.normalize) shape_.selects += double(shift) * (unit.internal_bits + op);
    if (unit.output.rounding != Rounding::trn) shape_.sums += unit.output.word;
    quantize(unit.output);
    add_registers(unit.output.word + (unit.normalize ? shift : 0));
  }

  // What stands between the table and y. Each product comes product_clocks behind its factors.
  void table(const Reciprocal& unit) {
    const int clocks = c_.rtl.product_clocks;
    const int entry = unit.table_bits + 1;
    const int nq = std::max(unit.operand_bits, unit.index_bits);
    const int t = nq - unit.index_bits;
    const int y = unit.internal_bits + 1;
    switch (unit.kind) {
      case ReciprocalKind::restoring:
        return;
      case ReciprocalKind::lut_linear:
        add_registers(2 * entry + t, 2);
        add_registers(entry, clocks);
        add_registers(y);
        shape_.sums += entry + entry + t;
        multiply(entry, false, t, false);
        return;
      case ReciprocalKind::lut_quadratic: {
        const int c1 = std::max(1, entry - unit.index_bits);
        const int c2 = std::max(1, entry - 2 * unit.index_bits);
        const int g = std::max(1, y - unit.index_bits);
        add_registers(entry + c1 + c2 + t, 2);
        add_registers(c1 + entry + t, clocks);
        add_registers(entry + t + g + y);
        add_registers(entry, clocks);
        multiply(c2, false, t, false);
        multiply(g, false, t, false);
        shape_.sums += c1 + t + std::max(entry, unit.internal_bits + t + 1);
        return;
      }
      case ReciprocalKind::lut_newton:
        add_registers(entry + nq, 2);
        for (int s = 0; s < unit.steps; ++s) {
          const int in = s == 0 ? entry : y;
          multiply(nq + 1, false, in, false);
          multiply(unit.internal_bits + 2, false, in, false);
          shape_.sums += unit.internal_bits + 2;
          add_registers(unit.internal_bits + 2);
          add_registers(in, clocks + 1);
          if (s + 1 < unit.steps) add_registers(nq, 2 * clocks + 1);
        }
        return;
    }
  }
  // A Newton unit whose products are formed by span_setup's multipliers.
  void shared_newton(const Reciprocal& unit, const RowSchedule& row) {
    const int made = 1 + c_.rtl.product_clocks;  // from the factors to the product
    const int nq = std::max(unit.operand_bits, unit.index_bits);
    const auto read = [&](int k) { return row.newton[static_cast<std::size_t>(k)].tick; };
    add_registers(unit.table_bits + 1 + nq, 2);
    for (int s = 0; s < unit.steps; ++s) {
      const int factor = unit.internal_bits + 2;
      shape_.sums += factor;
      add_registers(factor, read(2 * s + 1) - read(2 * s) - made);
      add_registers((s == 0 ? unit.table_bits : unit.internal_bits) + 1, read(2 * s + 1) - read(2 * s));
      if (s + 1 == unit.steps) break;
      add_registers(nq, read(2 * s + 2) - read(2 * s));
      add_registers(unit.internal_bits + 1, read(2 * s + 2) - read(2 * s + 1) - made);
    }
  }

  const Config& c_;
  RtlTiming timing_;
  RtlLines lines_;
  bool planes_;
  AreaShape shape_;
};

// What LUTs are made of. iCE40's division steps cost the same behind one another; ECP5's wide multiplexers do
// not.
std::vector<double> lut_terms_of(const AreaShape& s, Family family) {
  if (family == Family::ice40) return {s.products, s.sums, s.selects + s.memory, s.steps};
  return {s.joins, s.sums, s.selects + s.memory_luts, s.steps, s.chained};
}

// An iCE40 has no memory of LUTs.
double ffs_of(const AreaShape& s, Family family) {
  return s.registers + (family == Family::ice40 ? s.memory : 0);
}

using Matrix = std::vector<std::vector<double>>;

// Solves the normal equations of least squares, A x = b, by elimination with pivots.
std::vector<double> solve(Matrix a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    }
    if (a[pivot][column] == 0) throw InputError("area fit: the runs do not determine every coefficient");
    std::swap(a[pivot], a[column]);
    std::swap(b[pivot], b[column]);
    for (std::size_t row = column + 1; row < n; ++row) {
      const double factor = a[row][column] / a[column][column];
      for (std::size_t k = column; k < n; ++k) a[row][k] -= factor * a[column][k];
      b[row] -= factor * b[column];
    }
  }
  std::vector<double> x(n);
  for (std::size_t row = n; row-- > 0;) {
    x[row] = b[row];
    for (std::size_t k = row + 1; k < n; ++k) x[row] -= a[row][k] * x[k];
    x[row] /= a[row][row];
  }
  return x;
}

struct Sample {
  AreaShape shape;
  AreaCounts counts;
};

std::vector<Sample> samples_of(std::span<const AreaRun> runs, Family family) {
  std::vector<Sample> samples;
  for (const AreaRun& run : runs) {
    if (run.family == family) samples.push_back({area_shape(config_of(run)), run.counts});
  }
  return samples;
}

// The relative error counts, so a large run weighs no more than a small one.
AreaFit fit_samples(std::span<const Sample> samples, Family family) {
  const std::size_t n = lut_terms_of({}, family).size();
  Matrix a(n, std::vector<double>(n));
  std::vector<double> b(n);
  double ff_square = 0;
  double ff_sum = 0;
  for (const Sample& s : samples) {
    const std::vector<double> terms = lut_terms_of(s.shape, family);
    const auto luts = static_cast<double>(s.counts.luts);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] += terms[i] / luts;
      for (std::size_t k = 0; k < n; ++k) a[i][k] += terms[i] / luts * terms[k] / luts;
    }
    const double ratio = ffs_of(s.shape, family) / static_cast<double>(s.counts.ffs);
    ff_square += ratio * ratio;
    ff_sum += ratio;
  }
  if (samples.empty()) throw InputError(fmt::format("area fit: no runs of {}", to_string(family)));
  return {solve(a, b), ff_sum / ff_square};
}

class ErrorSum {
 public:
  void add(double estimated, double measured) {
    const double percent = measured == 0 ? (estimated == 0 ? 0 : 100) : 100 * (estimated / measured - 1);
    max_ = std::max(max_, std::abs(percent));
    squares_ += percent * percent;
    ++count_;
  }
  AreaFitError error() const { return {max_, std::sqrt(squares_ / std::max(1, count_))}; }

 private:
  double max_ = 0;
  double squares_ = 0;
  int count_ = 0;
};

constexpr std::string_view csv_header = "base,settings,family,luts,ffs,multipliers,memory_bits,tools";

std::int64_t count_in(const std::string& text) {
  std::int64_t value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0)
    throw InputError(fmt::format("'{}' is no count", text));
  return value;
}

AreaRun run_in(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  if (cells.size() != 8) throw InputError(fmt::format("expected the 8 columns {}", csv_header));
  AreaRun run;
  run.base = cells[0];
  std::istringstream settings(cells[1]);
  for (std::string setting; settings >> setting;) {
    const std::size_t equal = setting.find('=');
    if (equal == std::string::npos) throw InputError(fmt::format("'{}' sets no key", setting));
    run.settings.push_back({setting.substr(0, equal), value_in(std::string_view(setting).substr(equal + 1))});
  }
  run.family = family_named(cells[2]);
  run.counts = {count_in(cells[3]), count_in(cells[4]), count_in(cells[5]), count_in(cells[6])};
  run.tools = cells[7];
  return run;
}

}  // namespace

AreaShape area_shape(const Config& config) { return Counter(config).count(); }

const AreaFit& area_fit(Family family) {
  // Least squares over config/studies/area_fit.csv; tests/study/area_estimate_test.cpp fits again and
  // compares.
  static const AreaFit ice40 = {{2.69466, 3.32031, 0.27047, 3.36911}, 0.99760};
  static const AreaFit ecp5 = {{1.23511, 2.03297, 0.67955, 5.35458, 2.16701}, 0.99352};
  return family == Family::ice40 ? ice40 : ecp5;
}

AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit) {
  AreaEstimate estimate;
  const std::vector<double> terms = lut_terms_of(shape, family);
  for (std::size_t i = 0; i < terms.size(); ++i) estimate.luts += fit.luts[i] * terms[i];
  estimate.ffs = fit.ffs * ffs_of(shape, family);
  estimate.multipliers = family == Family::ice40 ? 0 : shape.blocks;
  return estimate;
}

AreaEstimate estimate_area(const Config& config, Family family) {
  AreaEstimate estimate = estimate_area(area_shape(config), family, area_fit(family));
  estimate.luts_error = error_shares(family).luts * estimate.luts;
  estimate.ffs_error = error_shares(family).ffs * estimate.ffs;
  return estimate;
}

const AreaErrorShares& error_shares(Family family) {
  // The test that compares area_fit with its runs compares these too.
  static const AreaErrorShares ice40 = {0.04984, 0.00547};
  static const AreaErrorShares ecp5 = {0.06317, 0.00905};
  return family == Family::ice40 ? ice40 : ecp5;
}

namespace {

// Estimates each sample by a fit to all others.
std::vector<AreaEstimate> left_out_estimates(const std::vector<Sample>& samples, Family family) {
  std::vector<AreaEstimate> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::vector<Sample> others = samples;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    out.push_back(estimate_area(samples[i].shape, family, fit_samples(others, family)));
  }
  return out;
}

// Returns the least of the shares that at least held_share of them do not exceed.
double share_that_holds(std::vector<double> shares) {
  std::ranges::sort(shares);
  return shares.at(static_cast<std::size_t>(std::ceil(held_share * double(shares.size()))) - 1);
}

}  // namespace

AreaErrorShares left_out_shares(std::span<const AreaRun> runs, Family family) {
  const std::vector<Sample> samples = samples_of(runs, family);
  const std::vector<AreaEstimate> left_out = left_out_estimates(samples, family);
  std::vector<double> luts;
  std::vector<double> ffs;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    luts.push_back(std::abs(double(samples[i].counts.luts) / left_out[i].luts - 1));
    ffs.push_back(std::abs(double(samples[i].counts.ffs) / left_out[i].ffs - 1));
  }
  return {share_that_holds(std::move(luts)), share_that_holds(std::move(ffs))};
}

std::string estimate_text(double value, double error) {
  if (!(error > 0)) return fmt::format("{:.0f}", value);
  const double digit = std::floor(std::log10(error)) - 1;  // the second one's power of ten
  const double unit = std::pow(10.0, digit);
  return fmt::format("{:.{}f} ± {:.{}f}", value, std::max(0, static_cast<int>(-digit)),
                     std::round(error / unit) * unit, std::max(0, static_cast<int>(-digit)));
}

AreaFit fit_area(std::span<const AreaRun> runs, Family family) {
  return fit_samples(samples_of(runs, family), family);
}

AreaFitErrors area_fit_errors(std::span<const AreaRun> runs, Family family) {
  const std::vector<Sample> samples = samples_of(runs, family);
  const AreaFit whole = fit_samples(samples, family);
  const std::vector<AreaEstimate> left_out = left_out_estimates(samples, family);
  ErrorSum luts;
  ErrorSum luts_left_out;
  ErrorSum ffs;
  ErrorSum ffs_left_out;
  ErrorSum multipliers;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const AreaEstimate in = estimate_area(samples[i].shape, family, whole);
    const AreaEstimate& out = left_out[i];
    const AreaCounts& measured = samples[i].counts;
    luts.add(in.luts, static_cast<double>(measured.luts));
    luts_left_out.add(out.luts, static_cast<double>(measured.luts));
    ffs.add(in.ffs, static_cast<double>(measured.ffs));
    ffs_left_out.add(out.ffs, static_cast<double>(measured.ffs));
    multipliers.add(in.multipliers, static_cast<double>(measured.multipliers));
  }
  return {luts.error(), luts_left_out.error(), ffs.error(), ffs_left_out.error(), multipliers.error()};
}

Config config_of(const AreaRun& run) {
  const std::filesystem::path file = data_folder() / "config" / (run.base + ".toml");
  return with_keys(load_config(file.string()), run.settings);
}

std::vector<AreaRun> load_area_runs(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::string line;
  if (!in || !std::getline(in, line) || line != csv_header)
    throw InputError(fmt::format("{}: cannot be read, or does not begin with {}", csv.string(), csv_header));
  std::vector<AreaRun> runs;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      runs.push_back(run_in(line));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}:{}: {}", csv.string(), number, error.what()));
    }
  }
  return runs;
}

void write_area_runs(const std::filesystem::path& csv, std::span<const AreaRun> runs) {
  std::ofstream out(csv);
  out << csv_header << '\n';
  for (const AreaRun& run : runs) {
    std::string settings;
    for (const KeySetting& setting : run.settings)
      settings += fmt::format("{}{}={}", settings.empty() ? "" : " ", setting.path, to_string(setting.value));
    out << fmt::format("{},{},{},{},{},{},{},{}\n", run.base, settings, to_string(run.family),
                       run.counts.luts, run.counts.ffs, run.counts.multipliers, run.counts.memory_bits,
                       run.tools);
  }
  out.close();
  if (!out) throw InputError(fmt::format("{}: cannot be written", csv.string()));
}

void measure_area_runs(std::span<AreaRun> runs, const AreaLimits& limits) {
  tbb::parallel_for_each(runs.begin(), runs.end(), [&limits](AreaRun& run) {
    const AreaResult result = measure_area(config_of(run), run.family, false, limits);
    if (result.status != AreaStatus::ok)
      throw InputError(fmt::format("{} in {}: {}", run.base, to_string(run.family), result.message));
    run.counts = result.counts;
    run.tools = result.tools;
  });
}

}  // namespace bitspan
