// SPDX-License-Identifier: Apache-2.0
#include "config/row_products.hpp"

#include <algorithm>
#include <bit>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <utility>

#include "config/modes.hpp"

namespace bitspan {
namespace {

ExactOffset exact_offset(const StartOffset& offset, int kept_fraction) {
  if (offset.half_ulp) return {1, kept_fraction + 1};
  if (offset.value == 0) return {};
  int exponent = 0;
  ExactOffset exact{static_cast<std::int64_t>(std::ldexp(std::frexp(offset.value, &exponent), 53)), 0};
  exact.fraction = 53 - exponent;
  while (exact.raw % 2 == 0) {
    exact.raw /= 2;
    --exact.fraction;
  }
  return exact;
}

Grid grid_of(const ExactOffset& offset) {
  const auto bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(std::abs(offset.raw))));
  return {bits - offset.fraction, offset.fraction, true};
}

// One product: Q[out](a b 2^-e + c). a is the wider factor.
struct Product {
  Grid a, b;
  Exponents e;
  Grid c;  // of no bits where nothing is added
  Grid offset{};
  Format out;
};

// Empty where the configuration has no such product.
using Products = std::array<std::optional<Product>, row_product_count>;
Products row_products(const Config& config) {
  using F = FormatId;
  Products products;
  const auto of = [&](int place) -> std::optional<Product>& {
    return products[static_cast<std::size_t>(place)];
  };
  const auto grid = [&](F id) { return grid_of(config.format(id)); };
  const Grid m = grid_of(config.row_reciprocal.output);
  const Exponents e = exponents_of(config.row_reciprocal, row_operand(config));
  const Grid none{0, 0, false};
  if (has_plane_rows(config.perspective)) {
    for (const LineId id : {LineId::fu, LineId::fv}) {
      const Line line = line_of(id, config.perspective);
      const LineProducts& p = products_of(id);
      of(p.start) = Product{
          grid(F::span_f), m, e, none, grid_of(start_offset(config, line)), config.format(line.row.acc)};
      for (const int step : {p.slope, p.slope1})
        of(step) = Product{grid(F::span_f_step), m, e, none, {}, config.format(line.row.step)};
    }
    return products;
  }
  const Grid sum = as_signed(depth_sum(config, F::edge_h));
  const Grid pre = pre_step(config);
  const bool hyperbolic = has_pixel_quotients(config.perspective);
  for (const LineId id : RtlLines(config)) {
    const Line line = line_of(id, config.perspective);
    const LineProducts& p = products_of(id);
    const Grid end = grid(line.edge.kept);
    Grid left = end;
    if (line.row.difference) {
      const Format& difference = config.format(*line.row.difference);
      left = hyperbolic ? grid_of(difference) : none;
      of(p.diff) = Product{sum, hyperbolic ? end : end - end, {}, none, {}, difference};
      if (hyperbolic) of(p.left) = of(p.diff);
    }
    // Its slope, and its start from the left end.
    if (shares_reciprocal(form_of(config.row_slope)))
      of(p.slope) = Product{slope_numerator(config, id), m, e, none, {}, config.format(line.row.step)};
    of(p.start) = Product{grid(line.row.step),        pre, {}, left, grid_of(start_offset(config, line)),
                          config.format(line.row.acc)};
  }
  return products;
}

}  // namespace

ExactOffset start_offset(const Config& config, const Line& line) {
  if (line.row.offset == nullptr) return {};
  const int kept = line.row.half_ulp_of ? config.format(*line.row.half_ulp_of).fraction() : 0;
  return exact_offset(config.start_offset.*line.row.offset, kept);
}

Grid pre_step(const Config& config) {
  const Grid x = grid_of(config.format(FormatId::edge_x));
  return aligned(
      Grid{std::max(pixel_index_bits(config), x.integer + (x.is_signed ? 1 : 0)) + 1, x.fraction, true}, 1);
}

RowMultipliers row_multipliers(const Config& config, const RowSchedule& schedule) {
  const Products products = row_products(config);
  RowMultipliers m;
  // Every sum lies on the grid of its own output with so many bits below it.
  for (const auto& p : products) {
    if (p) {
      m.below =
          std::max({m.below, p->c.fraction - p->out.fraction(), p->offset.fraction - p->out.fraction()});
    }
  }
  const auto shift_of = [&](const Product& p, int exponent) {
    return p.a.fraction + p.b.fraction + exponent - p.out.fraction() - m.below;
  };
  int out_bits = 1;
  int base = INT_MAX;
  int most = INT_MIN;
  for (std::size_t i = 0; i < products.size(); ++i) {
    if (!products[i]) continue;
    const Product& p = *products[i];
    m.a = std::max(m.a, as_signed(p.a).bits());
    m.b = std::max(m.b, as_signed(p.b).bits());
    // c, the offset and half an ulp together, on the sum's grid.
    const int fraction = p.out.fraction() + m.below;
    m.c = std::max(m.c, std::max(p.c.integer, p.offset.integer) + fraction + 3);
    out_bits = std::max(out_bits, p.out.word);
    base = std::min(base, shift_of(p, p.e.low));
    most = std::max(most, shift_of(p, p.e.high));
    m.count = std::max(m.count, schedule.slots[i].multiplier + 1);
    m.products = static_cast<int>(i) + 1;
  }
  // Bits for far sums to be told from near ones: shift_add.
  for (std::size_t k = 0; k < static_cast<std::size_t>(schedule.newton_products); ++k)
    m.count = std::max(m.count, schedule.newton[k].multiplier + 1);
  if (schedule.newton_products > 0) {
    // nq or 2 - nq y, times y; both positive.
    const Reciprocal& unit = config.row_reciprocal;
    m.a = std::max({m.a, std::max(unit.operand_bits, unit.index_bits) + 2, unit.internal_bits + 3});
    m.b = std::max(m.b, std::max(unit.table_bits, unit.internal_bits) + 2);
  }
  m.sum = std::max(out_bits + m.below + 5, m.c + 4);
  m.shift_base = base;
  m.shift_max = most - base;
  for (std::size_t i = 0; i < products.size(); ++i)
    if (products[i]) m.shifts[i] = shift_of(*products[i], 0) - base;
  return m;
}

}  // namespace bitspan
