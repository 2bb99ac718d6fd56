// SPDX-License-Identifier: Apache-2.0
#include "config/rtl_timing.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "config/modes.hpp"
#include "config/reciprocal.hpp"

namespace bitspan {
namespace {

constexpr int ceil_div(int n, int d) { return (n + d - 1) / d; }

constexpr int table_clocks = 2;  // read, and kept in a register

// Table kinds may leave the key at 0; the row dividers then make one bit a clock.
int bits_per_cycle(const Reciprocal& unit) { return std::max(1, unit.bits_per_cycle); }

// rtl/restoring_core.sv: stages that each make some bits, or units in a row that each make one bit per clock
// and take one more clock to take over.
int restoring_clocks(const Reciprocal& unit, int iterations) {
  return unit.pipelined ? iterations : bits_per_cycle(unit) * (iterations + 1);
}

// Channels take dividers of their own.
bool has_channel_dividers(const Config& c) {
  return has_pixel_quotients(c.perspective) && std::ranges::any_of(ChannelList(c), [&](int channel) {
           return line_of(channel_line(channel), c.perspective).span_divides;
         });
}

bool row_divides(const Config& c) {
  return !has_plane_rows(c.perspective) && !shares_reciprocal(form_of(c.row_slope));
}

}  // namespace

bool has_rtl(const Config& config) {
  return is_in_rtl(config.row_slope) && is_in_rtl(config.line_walk) && !has_channel_dividers(config) &&
         (!has_pixel_reciprocal(config.perspective) ||
          (config.pixel_reciprocal.pipelined && !has_subspans(config)));
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

FormatId texture_acc(const Config& config) { return line_of(LineId::fu, config.perspective).row.acc; }
FormatId texture_step(const Config& config) { return line_of(LineId::fu, config.perspective).row.step; }

Grid slope_numerator(const Config& config, LineId id) {
  const Line line = line_of(id, config.perspective);
  const Grid end = grid_of(config.format(line.edge.kept));
  if (!line.row.difference) return end - end;
  const Grid f = grid_of(config.format(*line.row.difference));
  return has_pixel_quotients(config.perspective) ? f - f : f;  // gr - gl, fu_diff
}

RtlLines::RtlLines(const Config& config) {
  for (int i = 0; i < line_count; ++i) {
    const auto line = static_cast<LineId>(i);
    const bool has_line = i < fixed_lines ? line < LineId::r || config.rtl.shades : has_channel(config, line);
    if (has_line) lines_[size_++] = line;
  }
}

RestoringShape restoring_shape(const Reciprocal& unit, Grid operand) {
  // Normalised: 1/n lies in (1/2, 1]. Otherwise 1/d is at most 2^fraction of the operand.
  const int needed = std::max(0, unit.output.fraction() + 1);
  const int integer_bits = unit.normalize ? 1 : operand.fraction + 1;
  const int bits = std::max(1, integer_bits + needed);
  const int iterations = ceil_div(bits, bits_per_cycle(unit));
  return {iterations, iterations * bits_per_cycle(unit) - integer_bits};
}

int reciprocal_latency(const Reciprocal& unit, Grid operand, const RtlShape& shape) {
  if (!has_table(unit.kind)) {
    return shape.normalise_clocks + restoring_clocks(unit, restoring_shape(unit, operand).iterations) + 1;
  }
  const ReciprocalParts parts = parts_of(unit);
  const int products = static_cast<int>(parts.products.size()) * shape.product_clocks;
  return shape.normalise_clocks + table_clocks + products + parts.differences + 1;
}

int multiply_round_clocks(int product_clocks) { return product_clocks + 2 + 1 + 1; }

int shared_product_clocks(const RtlShape& shape) {
  return shape.product_digits > 1 ? shape.product_digits + 1 : shape.product_clocks;
}

RowDivideShape row_divide_shape(const Config& config) {
  const int l_fraction = config.format(FormatId::edge_x).fraction();
  const RtlLines lines(config);
  RowDivideShape shape;
  int bits = 0;
  for (const LineId line : lines) {
    // A numerator extended by k zeros gives a quotient on fraction + k - l_fraction.
    const Grid numerator = as_signed(slope_numerator(config, line));
    const FormatId step = line_of(line, config.perspective).row.step;
    bits = std::max(bits, aligned(numerator, config.format(step).fraction() + 1 + l_fraction).bits());
  }
  shape.iterations = ceil_div(bits, bits_per_cycle(config.row_reciprocal));
  for (const LineId line : lines) {
    const Grid numerator = as_signed(slope_numerator(config, line));
    shape.fractions[static_cast<std::size_t>(line)] =
        shape.iterations * bits_per_cycle(config.row_reciprocal) - numerator.bits() + numerator.fraction -
        l_fraction;
  }
  return shape;
}

RestoringShape pixel_divide_shape(const Config& config) {
  const Grid f = as_signed(grid_of(config.format(FormatId::span_f)));
  const int divisor_fraction = pixel_operand(config).fraction;
  const int bits = aligned(f, config.format(FormatId::span_uv).fraction() + 1 + divisor_fraction).bits();
  const int iterations = ceil_div(bits, bits_per_cycle(config.pixel_reciprocal));
  const int made = iterations * bits_per_cycle(config.pixel_reciprocal);
  return {iterations, made - f.bits() + f.fraction - divisor_fraction};
}

namespace {

// The products of a row, in the order in which they ask for their slots.
constexpr const LineProducts& of_u = products_of(LineId::fu);
constexpr const LineProducts& of_v = products_of(LineId::fv);
constexpr std::array plane_products = {of_u.start, of_v.start,  of_u.slope,
                                       of_v.slope, of_u.slope1, of_v.slope1};
// What u and v are multiplied by before the slopes: those of u and those of v take turns.
std::span<const int> end_products(const Config& config) {
  static constexpr std::array products = {of_u.left, of_v.left, of_u.diff, of_v.diff};
  if (has_linear_texture(config.perspective)) return {};
  return std::span(products).subspan(has_pixel_quotients(config.perspective) ? 0 : 2);
}

// Gives products the first slots that are free. A slot has as many ticks as a product has digits, and the
// interval is a multiple of them.
class Multipliers {
 public:
  Multipliers(int multipliers, int interval, int digits)
      : interval_(interval),
        digits_(digits),
        taken_(static_cast<std::size_t>(multipliers * interval)),
        multipliers_(multipliers) {}
  RowSchedule::Slot take(int first) {
    if (offset_ < 0) offset_ = first % digits_;
    for (int tick = first;; ++tick) {
      if (tick % digits_ != offset_) continue;
      for (int m = 0; m < multipliers_; ++m) {
        const auto place = static_cast<std::size_t>(tick % interval_);
        const std::size_t at = place * static_cast<std::size_t>(multipliers_) + static_cast<std::size_t>(m);
        if (taken_[at]) continue;
        taken_[at] = true;
        return {tick, m};
      }
    }
  }

 private:
  int interval_;
  int digits_;
  int offset_ = -1;  // of the slots: the first product waits for nothing
  std::vector<bool> taken_;
  int multipliers_;
};

// The unit's operand is there at tick 1. Fills in newton; returns the tick of y.
int place_newton(const Config& config, Multipliers& multipliers, RowSchedule& s) {
  int tick = 1 + config.rtl.normalise_clocks + table_clocks;
  for (int k = 0; k < s.newton_products; ++k) {
    const RowSchedule::Slot slot = multipliers.take(tick);
    s.newton[static_cast<std::size_t>(k)] = slot;
    // The factors' register, the product; behind nq y the difference 2 - nq y.
    tick = slot.tick + 1 + shared_product_clocks(config.rtl) + (k % 2 == 0 ? 1 : 0);
  }
  return tick;
}

RowSchedule row_schedule(const Config& config) {
  const Reciprocal& unit = config.row_reciprocal;
  const bool planes = has_plane_rows(config.perspective);
  const bool divides = row_divides(config);
  const std::span<const int> at_ends = end_products(config);
  const RtlLines lines(config);
  auto products =
      static_cast<int>(planes ? plane_products.size() : at_ends.size() + lines.size() * (divides ? 1 : 2));
  RowSchedule s;
  s.product =
      1 + multiply_round_clocks(shared_product_clocks(config.rtl));  // the operands' register in front
  // A unit that is not pipelined is busy with one row.
  const int iterations = divides                ? row_divide_shape(config).iterations
                         : has_table(unit.kind) ? 0
                                                : restoring_shape(unit, row_operand(config)).iterations;
  const auto interval = [&] {
    const int multipliers = std::min(config.rtl.setup_multipliers, products);
    const int busy = unit.pipelined ? 1 : iterations > 0 ? iterations + 1 : s.unit;
    const int digits = config.rtl.product_digits;
    return ceil_div(std::max(ceil_div(products, multipliers) * digits, busy), digits) * digits;
  };
  s.unit = divides ? 1 + restoring_clocks(unit, iterations)  // magnitude, quotient bits
                   : reciprocal_latency(unit, row_operand(config), config.rtl);
  s.interval = interval();
  // Where a row does not come on each clock, Newton's products fit between those of span_setup.
  if (!divides && has_newton_steps(unit.kind) && s.interval > 1) {
    s.newton_products = 2 * unit.steps;
    products += s.newton_products;
    s.unit += s.newton_products;  // as many registers in front of the products
    s.interval = interval();
  }
  Multipliers multipliers(std::min(config.rtl.setup_multipliers, products), s.interval,
                          config.rtl.product_digits);
  if (s.newton_products > 0) s.unit = place_newton(config, multipliers, s);  // tick 1 and Q cancel each other
  const auto place = [&](int product, int first) {
    const RowSchedule::Slot slot = multipliers.take(first);
    s.slots[static_cast<std::size_t>(product)] = slot;
    return slot.tick + s.product;
  };
  // Tick 1 is the first register's: differences and sums.
  if (planes) {
    s.reciprocal = 1 + s.unit + 1;
    for (const int p : plane_products) s.latency = std::max(s.latency, place(p, s.reciprocal));
    return s;
  }
  // Ticks from which each is held. Only u and v have products in front of their slopes; where they have two,
  // the difference takes a register.
  std::array<int, line_count> held{};
  held.fill(1);
  for (std::size_t i = 0; i < at_ends.size(); ++i) {
    int& of_slope = held[static_cast<std::size_t>(i % 2 == 0 ? LineId::fu : LineId::fv)];
    of_slope = std::max(of_slope, place(at_ends[i], 1) + (has_pixel_quotients(config.perspective) ? 1 : 0));
  }
  if (divides) {
    s.divide = *std::ranges::max_element(held);
    held.fill(s.divide + s.unit + 1);  // and Q
  } else {
    s.reciprocal = 1 + s.unit + 1;
    for (const LineId line : lines) {
      int& at = held[static_cast<std::size_t>(line)];
      at = place(products_of(line).slope, std::max(s.reciprocal, at));
    }
  }
  for (const LineId line : lines) {
    s.latency = std::max(s.latency, place(products_of(line).start, held[static_cast<std::size_t>(line)]));
  }
  return s;
}

}  // namespace

RowSchedule row_schedule_by_plane(const Config& config) {
  const RtlLines lines(config);
  const int products = 2 * static_cast<int>(lines.size());
  const int multipliers = std::min(config.rtl.setup_multipliers, products);
  RowSchedule s;
  s.product = 1 + multiply_round_clocks(shared_product_clocks(config.rtl));
  s.interval = ceil_div(products, multipliers) * config.rtl.product_digits;
  Multipliers slots(multipliers, s.interval, config.rtl.product_digits);
  for (const LineId line : lines) {
    for (const int p : {products_of(line).slope, products_of(line).start}) {
      RowSchedule::Slot& slot = s.slots[static_cast<std::size_t>(p)];
      slot = slots.take(1);
      s.latency = std::max(s.latency, slot.tick + s.product + 1);  // and the sum of both
    }
  }
  return s;
}

RtlTiming rtl_timing(const Config& config) {
  if (has_subspans(config)) {
    throw InputError(config.name + ": perspective.subspan_bits is " + std::to_string(config.subspan_bits) +
                     "; the RTL divides at every pixel and needs 0");
  }
  if (!is_in_rtl(config.row_slope)) {
    throw InputError(config.name +
                     ": slope.row is plane, which the RTL does not have; it needs divide or reciprocal");
  }
  if (has_channel_dividers(config)) {
    throw InputError(
        config.name +
        ": perspective.mode is hyperbolic, where the RTL divides u and v alone; channels that are "
        "divided, of perspective.shades and texture.second, need delta_f");
  }
  if (!has_rtl(config)) {
    throw InputError(
        config.name +
        ": reciprocal.pixel.pipelined is false; the RTL makes one pixel per clock and needs true");
  }
  return timing_with_dividers(config);
}

RtlTiming timing_with_dividers(const Config& config) {
  RtlTiming t;
  t.row = row_schedule(config);
  if (has_pixel_reciprocal(config.perspective)) {
    t.pixel_unit = reciprocal_latency(config.pixel_reciprocal, pixel_operand(config), config.rtl);
    t.pixel_interval = config.rtl.pixel_clocks;
    const int h_sum = 1;
    // In turns: v's slot behind u's, and the operands' register.
    t.span = h_sum + t.pixel_unit +
             (t.pixel_interval > 1
                  ? config.rtl.product_digits + 1 + multiply_round_clocks(shared_product_clocks(config.rtl))
                  : multiply_round_clocks(config.rtl.product_clocks));
  } else if (has_pixel_quotients(config.perspective)) {
    t.pixel_unit = 1 + pixel_divide_shape(config).iterations;  // magnitude in front
    t.span = 1 + t.pixel_unit + 1;                             // and Q
  } else {
    t.span = 1;
  }
  return t;
}

}  // namespace bitspan
