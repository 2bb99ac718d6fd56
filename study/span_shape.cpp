// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <span>

#include "config/lines.hpp"
#include "config/modes.hpp"
#include "config/row_products.hpp"
#include "study/shape_cells.hpp"

namespace bitspan {
namespace {

// The difference of two values of a register.
Grid difference_of(const Format& f) { return grid_of(f) - grid_of(f); }

// rtl/span_interpolator.sv.
class SpanCounter : private ShapeCells {
 public:
  explicit SpanCounter(const Config& config)
      : ShapeCells(config),
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
    if (has_line()) hold(line(), 1, row.latency);
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
        round(step);
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
  // Lines follow one beside horizontal rows.
  bool has_line() const { return has_line_slope(c_.line_walk); }
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
    const int bits = common + (planes_ ? plane : ends + (has_line() ? line() : 0));
    if (c_.rtl.fifo == 1) {
      add_registers(bits);
    } else {
      memory(c_.rtl.fifo, bits, Memory::Kind::unclocked);
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
      if (line.span_divides) continue;
      round(kept);
      span_delay(kept.word, timing_.span);
      if (planes_) shape_.selects += word(line.row.step);
    }
    if (has_line()) {
      shape_.sums += line();
      shape_.selects += line();
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
      round(format(F::span_uv));
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
      round(to);
      add_registers(to.word);
    }
  }

  // rtl/span.sv behind the issue, in delta_f.
  void pixels() {
    const Grid operand = pixel_operand(c_);
    shape_.sums += operand.bits();
    add_registers(operand.bits());
    reciprocal(c_.pixel_reciprocal, operand);
    span_delay(pixel_index_bits(c_) + 1 + word(F::span_h), timing_.span);
    pair(format(F::span_f), &format(F::edge_uv), format(F::span_uv), true);
    for (const LineId id : side_lines()) {
      const Line line = line_of(id);
      const bool is_first = id == LineId::shade_r || id == LineId::shade_b || id == LineId::u2;
      if (line.span_divides && is_first) pair(format(line.row.acc), nullptr, format(line.row.kept), false);
    }
  }

  // rtl/span_quotients.sv. base: null for none. is_first: the others share what follows from m and e.
  void pair(const Format& f, const Format* base, const Format& to, bool is_first) {
    const Format& m = c_.pixel_reciprocal.output;
    const int clocks = c_.rtl.product_clocks;
    const Exponents e = exponents_of(c_.pixel_reciprocal, pixel_operand(c_));
    const int recip = 1 + timing_.pixel_unit;
    const int last_slot = recip + (timing_.pixel_interval > 1 ? c_.rtl.product_digits : 0);
    const int base_word = base == nullptr ? 0 : base->word;
    const int base_fraction = base == nullptr ? 0 : base->fraction();
    span_delay(f.word + base_word, recip);
    span_delay(f.word + base_word, last_slot);
    // A normalised mantissa is at most 1.
    const bool top_alone = c_.pixel_reciprocal.normalize && !m.is_signed && m.word == m.fraction() + 1;
    const int fraction = std::max(base_fraction, to.fraction() + 1);
    const int added = base == nullptr ? 1 : base_word + 1 + fraction - base_fraction + 1;
    const int kept = std::max(to.word + fraction - to.fraction() + 1, added) + 4;
    const int shift_base = f.fraction() + m.fraction() + e.low - fraction;
    const int shift_max = e.high - e.low;
    if (timing_.pixel_interval > 1) {
      if (is_first) span_delay(m.word + bits_of(shift_max), last_slot - recip);
      turns(2, as_signed(grid_of(f)).bits(), as_signed(grid_of(m)).bits(), added, bits_of(shift_max),
            shift_base, shift_max, kept);
      quantize(to);
      span_delay(to.word, c_.rtl.product_digits + 1);
      span_delay(to.word, 1);
      if (is_first) add_registers(bits_of(timing_.pixel_interval - 1) + 2);
      return;
    }
    // rtl/multiply_round.sv, twice; both have the same shift.
    if (is_first) add_registers(bits_of(shift_max), clocks);
    for (int i = 0; i < 2; ++i) {
      // All have the same mantissa.
      multiply(f.word, f.is_signed, m.word, m.is_signed,
               {.b_top_alone = top_alone, .elsewhere = is_first && i == 0 ? 0 : m.word});
      shift_add(f.word + m.word, shift_base, shift_max, kept);
      if (base != nullptr) add_registers(base_word + 1, clocks + 2);
      quantize(to);
      add_registers(to.word);
    }
  }
  // rtl/span_delay.sv.
  void span_delay(int width, int ticks) { add_registers(width, ceil_div(ticks, timing_.pixel_interval)); }

  RtlTiming timing_;
  RtlLines lines_;
  bool planes_;
};

}  // namespace

AreaShape span_shape(const Config& config) { return SpanCounter(config).count(); }

}  // namespace bitspan
