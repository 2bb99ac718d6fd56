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
  using P = RowProduct;
  Products products;
  const auto of = [&](P p) -> std::optional<Product>& { return products[static_cast<std::size_t>(p)]; };
  const auto grid = [&](F id) { return grid_of(config.format(id)); };
  const Grid from_h = grid_of(offset_h(config));
  const Grid from_f = grid_of(offset_f(config));
  const Grid m = grid_of(config.row_reciprocal.output);
  const Exponents e = exponents_of(config.row_reciprocal, row_operand(config));
  const Grid none{0, 0, false};
  if (has_plane_rows(config.perspective)) {
    for (const P p : {P::fu, P::fv}) {
      of(p) = Product{grid(F::span_f), m, e, none, from_f, config.format(F::span_uv_acc)};
    }
    for (const P p : {P::fu_step, P::fv_step, P::fu_step1, P::fv_step1}) {
      of(p) = Product{grid(F::span_f_step), m, e, none, {}, config.format(F::span_uv_step)};
    }
    return products;
  }
  const Grid sum = as_signed(depth_sum(config, F::edge_h));
  const bool hyperbolic = has_pixel_quotients(config.perspective);
  if (hyperbolic) {
    for (const P p : {P::fu_left, P::fv_left, P::fu_diff, P::fv_diff})
      of(p) = Product{sum, grid(F::edge_uv), {}, none, {}, config.format(F::span_f_diff)};
  } else if (has_pixel_reciprocal(config.perspective)) {
    for (const P p : {P::fu_diff, P::fv_diff}) {
      of(p) = Product{sum, grid(F::edge_uv) - grid(F::edge_uv), {}, none, {}, config.format(F::span_f_diff)};
    }
  }
  // A value that is linear along the row: its slope, and its start from the left end.
  const Grid p = pre_step(config);
  const auto line = [&](P slope, Grid difference, F step, P start, Grid left, Grid offset, F acc) {
    if (shares_reciprocal(form_of(config.row_slope)))
      of(slope) = Product{difference, m, e, none, {}, config.format(step)};
    of(start) = Product{grid(step), p, {}, left, offset, config.format(acc)};
  };
  const Grid h = grid(F::edge_h);
  line(P::h_step, h - h, F::span_h_step, P::h, h, from_h, F::span_h);
  const Grid left = hyperbolic                               ? grid(F::span_f_diff)
                    : has_linear_texture(config.perspective) ? grid(F::edge_uv)
                                                             : none;
  for (const auto& [slope, start] : {std::pair{P::fu_step, P::fu}, {P::fv_step, P::fv}}) {
    line(slope, slope_numerator(config), texture_step(config), start, left, from_f, texture_acc(config));
  }
  if (!config.rtl.shades) return products;
  const Grid shade = grid(F::edge_shade);
  const Grid from_shade = grid_of(offset_shade(config));
  for (const auto& [slope, start] :
       {std::pair{P::r_step, P::r}, {P::g_step, P::g}, {P::b_step, P::b}, {P::a_step, P::a}}) {
    line(slope, shade - shade, F::span_shade_step, start, shade, from_shade, F::span_shade_acc);
  }
  return products;
}

}  // namespace

ExactOffset offset_h(const Config& config) { return exact_offset(config.start_offset.span_h, 0); }

ExactOffset offset_f(const Config& config) {
  const FormatId kept = has_linear_texture(config.perspective) ? FormatId::span_uv : FormatId::span_f;
  return exact_offset(config.start_offset.span_f, config.format(kept).fraction());
}

ExactOffset offset_shade(const Config& config) {
  return exact_offset(config.start_offset.span_shade, config.format(FormatId::span_shade).fraction());
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
