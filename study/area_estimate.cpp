// SPDX-License-Identifier: Apache-2.0
#include "study/area_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "config/grid.hpp"
#include "config/modes.hpp"
#include "config/row_products.hpp"
#include "config/rtl_timing.hpp"

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

struct Product {
  bool b_top_alone = false;
  int low = 0, high = 0;  // bits at the ends of the product that nobody reads
  int elsewhere = 0;      // bits of the factors that another register holds, too: Yosys merges them
};

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
  void multiply(int a, bool a_signed, int b, bool b_signed, const Product& product = {}) {
    const int clocks = c_.rtl.product_clocks;
    const int read = a + b - product.low - product.high;
    shape_.products += double(a) * b;
    if (clocks == 1) {
      // Yosys cuts into pieces of 18 bits; a last piece of a single bit becomes LUTs.
      const auto pieces = [](int bits) { return bits / (limb + 1) + (bits % (limb + 1) > 1 ? 1 : 0); };
      shape_.blocks += double(pieces(a)) * pieces(b);
      shape_.joins += double(pieces(a) * pieces(b) - 1) * std::max(a, b);
      add_registers(read);
      return;
    }
    const Cut of_a = cut_of(a, a_signed, false);
    const Cut of_b = cut_of(b, b_signed, product.b_top_alone);
    const bool spare = of_a.spare + of_b.spare > 0;
    // Bits that are not read are in no register, but for those whose carry is read.
    const int dropped = std::min(product.low, limb) + product.high;
    shape_.blocks += double(of_a.limbs) * of_b.limbs;
    add_registers(of_a.low * of_b.limbs + of_b.low * of_a.limbs - dropped);
    // What is above the limbs: the other factor, once per bit; from the third bit on in a second register.
    shape_.joins += of_a.spare * b + of_b.spare * of_a.low;
    if (of_a.spare > 0) add_registers(b + of_a.spare);
    if (of_b.spare > 0) add_registers(of_a.low + of_b.spare);
    if (of_b.spare > 2) add_registers(of_a.low + of_b.spare - 2);
    if (clocks == 2) {
      // Two diagonals of partial products meet in each bit.
      const int diagonals = 2 * std::min(of_a.limbs, of_b.limbs) - (of_a.limbs == of_b.limbs ? 1 : 0);
      join(diagonals + (of_a.spare > 0 ? 1 : 0) + (of_b.spare > 0 ? 1 : 0), a + b - limb);
    } else {
      if (of_a.limbs > 1) shape_.joins += double(of_b.limbs) * of_a.low;
      if (of_a.spare > 0 && of_b.spare > 0) join(2, std::max(a, b));
      join(of_b.limbs + (spare ? 1 : 0), std::max(a, b));
      // Rows: a single one is the product.
      const bool single = of_b.limbs == 1 && !spare;
      add_registers(of_a.low * of_b.limbs + of_b.low + (spare ? std::max(a, b) + 3 : 0) -
                    (single ? product.low + product.high : dropped));
      // Yosys keeps the zeros below a row that is a sum of three.
      if (of_a.limbs > 2) add_registers(limb, of_b.limbs * (of_b.limbs - 1) / 2);
    }
    if (clocks > 3) add_registers(a + b - product.elsewhere);
    add_registers(read, std::max(1, clocks - 3));
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
      multiply(a, true, b, true, {.low = std::max(0, shift_base)});
    }
    add_registers(products);
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
    // Half an ulp is added with the rest, so that the lowest bit of the sum is not read. Beside these: what
    // is left to shift, two signs and what tells a far value.
    add_registers(coarse + 2 * kept - 1 + std::min(shift, 3) + 6);
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
      // Bits of what is added, where it is no constant: of starts, but for those of fu and fv in delta_f.
      int top = 0;
      int low = m.c;
      bool is_signed = false;
      for (const LineId id : lines_) {
        const Line line = line_of(id);
        const bool constant = line.row.difference && has_pixel_reciprocal(c_.perspective);
        if (planes_ || constant || timing_.row.slot(products_of(id).start).multiplier != i) continue;
        const Format& left = format(line.row.difference ? *line.row.difference : line.edge.kept);
        const int behind = format(line.row.acc).fraction() + m.below;
        top = std::max(top, grid_of(left).integer + behind + 1);
        low = std::min(low, std::max(0, behind - left.fraction()));
        is_signed = is_signed || left.is_signed;
      }
      const int added = std::max(0, std::min(m.c, top + (is_signed ? 1 : 0)) - low);
      const auto products = std::ranges::count_if(timing_.row.slots, [&](const RowSchedule::Slot& slot) {
        return slot.tick >= 0 && slot.multiplier == i;
      });
      turns(static_cast<int>(products), m.a, m.b, added, shift, m.shift_base, m.shift_max, m.sum);
    }
    // All have the reciprocal as a factor, and its exponent as the shift: one register serves them all.
    const int clocks = c_.rtl.product_clocks;
    if (planes_) add_registers(-(m.b * (clocks > 3 ? 2 : 1) + shift * (1 + clocks)), m.count - 1);
    shape_.selects += double(timing_.row.newton_products) * (m.a + m.b);
    add_registers(timing_.row.newton_products);
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
    hold(1, 1, divides ? row.divide + row.unit : row.reciprocal - 1);  // whether there is a length
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
        restoring(c_.row_reciprocal, length, divide.iterations, numerator(line), first);
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
      shape_.memories.push_back({c_.rtl.fifo, bits, Memory::Kind::unclocked});
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
      restoring(unit, operand.bits(), divide.iterations, f, i == 0);
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
      // Both have the same mantissa.
      multiply(f.word, f.is_signed, m.word, m.is_signed,
               {.b_top_alone = top_alone, .elsewhere = i == 0 ? 0 : m.word});
      shift_add(f.word + m.word, shift_base, shift_max, kept);
      add_registers(uv.word + 1, clocks + 2);
      quantize(to);
      add_registers(to.word);
    }
  }
  // rtl/span_delay.sv.
  void span_delay(int width, int ticks) { add_registers(width, ceil_div(ticks, timing_.pixel_interval)); }

  // rtl/restoring_core.sv, for a numerator of so many bits in front of zeros; 0: it is a constant, and leaves
  // no register of its own.
  void restoring(const Reciprocal& unit, int divisor, int iterations, int numerator, bool own_divisor) {
    const int per_cycle = std::max(1, unit.bits_per_cycle);
    const int bits = iterations * per_cycle;
    if (unit.pipelined) {
      shape_.steps += double(bits) * divisor;
      // A step behind another of the same clock chooses among what both may leave; where the numerator is a
      // constant, half of that is known.
      shape_.chained += double(divisor) * (per_cycle - 1) * iterations * (numerator == 0 ? 1 : 2);
      for (int i = 1; i <= iterations; ++i) add_registers(divisor + std::max(numerator, i * per_cycle));
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
      if (normalise > 1) add_registers(op + shift);
      // What the first shift leaves for the second one, of at most 7.
      if (normalise > 2) add_registers((lut ? std::min(op, unit.operand_bits + 8) : op) + shift);
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
      restoring(unit, op, restoring_shape(unit, operand).iterations, 0, true);
    }
    if (lut && !unit.normalize) shape_.selects += double(shift) * (unit.internal_bits + op);
    if (unit.output.rounding != Rounding::trn) shape_.sums += unit.output.word;
    quantize(unit.output);
    add_registers(unit.output.word + (unit.normalize ? shift : 0));
  }

  void table_of(int words, int width, int reads = 1) {
    shape_.memories.push_back({words, width, Memory::Kind::table, reads});
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
        table_of((1 << unit.index_bits) + 1, entry, 2);
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
        table_of(1 << unit.index_bits, entry + c1 + c2);
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
        table_of(1 << unit.index_bits, newton_entry(unit));
        add_registers(newton_entry(unit) + nq, 2);
        for (int s = 0; s < unit.steps; ++s) {
          // nq y is floored to the internal bits, and so is y (2 - a), which is at most 1.
          const int in = s == 0 ? entry : y;
          const bool last = s + 1 == unit.steps;
          multiply(
              nq + 1, false, in, false,
              {.low = std::max(0, nq + in - 1 - unit.internal_bits), .elsewhere = in + (last ? 0 : nq + 1)});
          multiply(unit.internal_bits + 2, false, in, false, {.low = in - 1, .high = 2});
          shape_.sums += unit.internal_bits + 2;
          add_registers(unit.internal_bits + 2);
          add_registers(s == 0 ? newton_entry(unit) : y, clocks + 1);
          if (!last) add_registers(nq, 2 * clocks + 1);
        }
        return;
    }
  }
  // Bits of an entry of a Newton table that are no constants: all lie from 1/2 to below 1.
  static int newton_entry(const Reciprocal& unit) {
    return unit.table_bits > unit.index_bits ? unit.table_bits - 1 : unit.table_bits + 1;
  }
  // A Newton unit whose products are formed by span_setup's multipliers.
  void shared_newton(const Reciprocal& unit, const RowSchedule& row) {
    const int made = 1 + c_.rtl.product_clocks;  // from the factors to the product
    const int nq = std::max(unit.operand_bits, unit.index_bits);
    const auto read = [&](int k) { return row.newton[static_cast<std::size_t>(k)].tick; };
    table_of(1 << unit.index_bits, newton_entry(unit));
    add_registers(newton_entry(unit) + nq, 2);
    for (int s = 0; s < unit.steps; ++s) {
      const int factor = unit.internal_bits + 2;
      shape_.sums += factor;
      add_registers(factor, read(2 * s + 1) - read(2 * s) - made);
      add_registers(s == 0 ? newton_entry(unit) : unit.internal_bits + 1, read(2 * s + 1) - read(2 * s));
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

}  // namespace

AreaShape area_shape(const Config& config) { return Counter(config).count(); }

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

// LUTs of ECP5, in which memory of 16 words by 4 bits has one port to read.
int memory_luts(const Memory& m) { return 4 * ceil_div(m.words, 16) * ceil_div(m.width, 4) * m.reads; }

}  // namespace

// As memory_libmap of Yosys chooses: a bit of logic costs 1, and 1/16 in a table, a block 64 in iCE40 and 128
// in ECP5.
int memory_blocks(const Memory& m, Family family) {
  if (m.kind == Memory::Kind::unclocked) return 0;
  const bool ice40 = family == Family::ice40;
  // A block of ECP5 reads a table at two ports, of half the width.
  const int reads = is_table(m) && !ice40 ? ceil_div(m.reads, 2) : m.reads;
  const int width =
      std::max(1, block_width(m.words, family) / (is_table(m) && m.reads > 1 && !ice40 ? 2 : 1));
  const int blocks = reads * ceil_div(m.width, width);
  const double bits = double(m.words) * m.width;
  const double otherwise = is_table(m) ? bits / 16 : ice40 ? bits : std::min(bits, double(memory_luts(m)));
  return blocks * (ice40 ? 64 : 128) < otherwise ? blocks : 0;
}

// iCE40's division steps cost the same behind one another; ECP5's wide multiplexers do not.
std::vector<double> lut_terms(const AreaShape& s, Family family) {
  double memory = 0;
  for (const Memory& m : s.memories) {
    if (is_table(m) || memory_blocks(m, family) > 0) continue;
    memory += family == Family::ice40 ? double(m.words) * m.width : memory_luts(m);
  }
  if (family == Family::ice40) return {s.products, s.sums, s.selects + memory, s.steps};
  return {s.joins, s.sums, s.selects + memory, s.steps, s.chained};
}

double flip_flop_bits(const AreaShape& s, Family family) {
  double bits = s.registers;
  for (const Memory& m : s.memories) {
    if (memory_blocks(m, family) > 0) {
      bits -= double(m.width) * m.reads;  // a block has the register behind it
    } else if (!is_table(m) && family == Family::ice40) {
      bits += double(m.words) * m.width;
    }
  }
  return bits;
}

const AreaFit& area_fit(Family family) {
  // Least squares over config/studies/area_fit.csv; tests/study/area_estimate_test.cpp fits again and
  // compares.
  static const AreaFit ice40 = {{2.69466, 3.32031, 0.27047, 3.36911}, 0.99713};
  static const AreaFit ecp5 = {{1.23501, 2.03297, 0.67955, 5.35458, 2.16701}, 0.99933};
  return family == Family::ice40 ? ice40 : ecp5;
}

AreaEstimate estimate_area(const AreaShape& shape, Family family, const AreaFit& fit) {
  AreaEstimate estimate;
  const std::vector<double> terms = lut_terms(shape, family);
  for (std::size_t i = 0; i < terms.size(); ++i) estimate.luts += fit.luts[i] * terms[i];
  estimate.ffs = fit.ffs * flip_flop_bits(shape, family);
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
  static const AreaErrorShares ice40 = {0.04984, 0.00372};
  static const AreaErrorShares ecp5 = {0.06317, 0.00366};
  return family == Family::ice40 ? ice40 : ecp5;
}

std::string estimate_prefix(Family family) { return fmt::format("estimate.{}.", to_string(family)); }

void add_estimates(const Config& config, Metrics& metrics) {
  if (!has_rtl(config)) return;
  for (const Family family : families) {
    const AreaEstimate e = estimate_area(config, family);
    const std::string prefix = estimate_prefix(family);
    metrics[prefix + "luts"] = e.luts;
    metrics[plus_minus_of(prefix + "luts")] = e.luts_error;
    metrics[prefix + "ffs"] = e.ffs;
    metrics[plus_minus_of(prefix + "ffs")] = e.ffs_error;
    metrics[prefix + "multipliers"] = e.multipliers;
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
