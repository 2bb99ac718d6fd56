// SPDX-License-Identifier: Apache-2.0
#include "study/shape_cells.hpp"

#include <algorithm>

namespace bitspan {
namespace {

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

}  // namespace

void ShapeCells::quantize(const Format& to) {
  if (to.overflow != Overflow::wrap) shape_.selects += to.word;
}

void ShapeCells::round(const Format& to) {
  if (to.rounding != Rounding::trn) shape_.sums += to.word;
  quantize(to);
}

void ShapeCells::memory(int words, int width, Memory::Kind kind, int reads) {
  shape_.memories.push_back({words, width, kind, reads});
}

void ShapeCells::join(int terms, int width) {
  if (terms > 1) shape_.joins += double(width) * (1 + 2 * (terms - 2));
}

void ShapeCells::multiply(int a, bool a_signed, int b, bool b_signed, const Product& product) {
  const int clocks = product.clocks > 0 ? product.clocks : c_.rtl.product_clocks;
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
  if (clocks == 4) add_registers(a + b - product.elsewhere);
  if (clocks > 4) {
    // The factors, per multiplier and for what is above the limbs; the partial products wait a clock.
    const int factors = of_a.low * of_b.limbs + of_b.low * of_a.limbs;
    add_registers(factors + (of_a.spare > 0 ? of_a.spare + b : 0) +
                  (of_b.spare > 0 ? of_b.spare + of_a.low : 0));
    add_registers(factors - dropped + (spare ? std::max(a, b) + 3 : 0));
  }
  add_registers(read, std::max(1, clocks - (clocks > 4 ? 4 : 3)));
}

void ShapeCells::shift_add(int x, int base, int shift_max, int kept) {
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

void ShapeCells::restoring(const Reciprocal& unit, int divisor, int iterations, int numerator,
                           bool own_divisor) {
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

void ShapeCells::reciprocal(const Reciprocal& unit, Grid operand, const RowSchedule* row) {
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
  round(unit.output);
  add_registers(unit.output.word + (unit.normalize ? shift : 0));
}

void ShapeCells::table(const Reciprocal& unit) {
  const int clocks = c_.rtl.product_clocks;
  const int entry = unit.table_bits + 1;
  const int nq = std::max(unit.operand_bits, unit.index_bits);
  const int t = nq - unit.index_bits;
  const int y = unit.internal_bits + 1;
  switch (unit.kind) {
    case ReciprocalKind::restoring:
      return;
    case ReciprocalKind::lut_linear:
      memory((1 << unit.index_bits) + 1, entry, Memory::Kind::table, 2);
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
      memory(1 << unit.index_bits, entry + c1 + c2, Memory::Kind::table);
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
      memory(1 << unit.index_bits, newton_entry(unit), Memory::Kind::table);
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

int ShapeCells::newton_entry(const Reciprocal& unit) {
  return unit.table_bits > unit.index_bits ? unit.table_bits - 1 : unit.table_bits + 1;
}

void ShapeCells::shared_newton(const Reciprocal& unit, const RowSchedule& row) {
  const int made = 1 + c_.rtl.product_clocks;  // from the factors to the product
  const int nq = std::max(unit.operand_bits, unit.index_bits);
  const auto read = [&](int k) { return row.newton[static_cast<std::size_t>(k)].tick; };
  memory(1 << unit.index_bits, newton_entry(unit), Memory::Kind::table);
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

}  // namespace bitspan
