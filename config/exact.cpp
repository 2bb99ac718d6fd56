// SPDX-License-Identifier: Apache-2.0
#include "config/exact.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "config/grid.hpp"
#include "config/lines.hpp"
#include "config/modes.hpp"
#include "config/pixel_timing.hpp"
#include "config/reciprocal.hpp"

namespace bitspan {
namespace {

using F = FormatId;

std::string describe(const Format& f) {
  return std::string(f.is_signed ? "fixed<" : "ufixed<") + std::to_string(f.word) + "," +
         std::to_string(f.integer) + ">";
}

// A reciprocal unit and the grid of its operand, which is positive.
struct Unit {
  std::string name;
  const Reciprocal& r;
  Grid operand;
};

// The table of one configuration. Every width is that of a signed integer.
class List {
 public:
  explicit List(const Config& config) : config_(config) {}

  Grid of(FormatId id) const { return signed_grid(config_.format(id)); }

  // A value narrowed to a register: aligned with it where the register's last place is finer.
  void value(std::string stage, std::string expression, std::initializer_list<FormatId> made_of, Grid g,
             FormatId into) {
    value(std::move(stage), std::move(expression), made_of, g, config_.format(into), key(into));
  }
  void value(std::string stage, std::string expression, std::initializer_list<FormatId> made_of, Grid g,
             const Format& into, std::string into_key) {
    add({std::move(into_key), std::move(stage), std::move(expression), formats(made_of), bits_for(g, into)});
  }

  // n / d narrowed to a register: n or d scaled so that the quotient ends at the register's last place.
  void quotient(std::string stage, std::string expression, std::initializer_list<FormatId> made_of, Grid n,
                Grid d, FormatId into) {
    const int shift = config_.format(into).fraction() - n.fraction + d.fraction;
    add({key(into), std::move(stage), std::move(expression), formats(made_of),
         std::max(n.bits() + std::max(shift, 0), d.bits() + std::max(-shift, 0))});
  }

  // base + n m 2^-e over every exponent that the unit can deliver; no base where it is null.
  void product(std::string stage, std::string expression, std::initializer_list<FormatId> made_of,
               const Grid* base, Grid n, const Unit& unit, FormatId into) {
    product(std::move(stage), std::move(expression), made_of, base, n, unit, config_.format(into), key(into));
  }
  void product(std::string stage, std::string expression, std::initializer_list<FormatId> made_of,
               const Grid* base, Grid n, const Unit& unit, const Format& into, std::string into_key) {
    int bits = 0;
    const Exponents exponents = exponents_of(unit.r, unit.operand);
    for (int e = exponents.low; e <= exponents.high; ++e) {
      const Grid p = scaled(n * signed_grid(unit.r.output), e);
      bits = std::max(bits, bits_for(base == nullptr ? p : *base + p, into));
    }
    add({std::move(into_key), std::move(stage), std::move(expression), formats(made_of, &unit), bits});
  }

  // The one way a slope is formed.
  void slope(const std::string& stage, const std::string& name, const std::string& numerator,
             std::initializer_list<FormatId> made_of, Grid n, Grid d, SlopeForm form, const Unit& unit,
             FormatId into) {
    if (!shares_reciprocal(form)) {
      quotient(stage, name + " = " + numerator + " / length", made_of, n, d, into);
    } else {
      product(stage, name + " = " + numerator + " m 2^-e", made_of, nullptr, n, unit, into);
    }
  }

  // What a unit does inside.
  void unit(const Unit& u) {
    const Reciprocal& r = u.r;
    const auto inside = [&](std::string expression, int bits) {
      add({u.name, u.name, std::move(expression), formats({}, &u), bits});
    };
    if (!has_table(r.kind)) {
      // 2^k / d, k so that the quotient ends at the output's last place.
      const int out = r.output.fraction();
      const int k = r.normalize ? out + u.operand.bits() - 1 : out + u.operand.fraction;
      inside("1 / d", std::max(std::max(k, 0) + 2, as_signed(u.operand).bits() + std::max(-k, 0)));
      return;
    }
    const ReciprocalParts parts = parts_of(r);
    for (const auto& [expression, width] : parts.exact) inside(std::string(expression), width);
    const Grid y{2, parts.fraction, true};
    int bits = bits_for(y, r.output);
    if (!r.normalize) {
      const Exponents exponents = exponents_on(u.operand);
      for (int e = exponents.low; e <= exponents.high; ++e)
        bits = std::max(bits, bits_for(scaled(y, e), r.output));
    }
    inside(r.normalize ? "y" : "y 2^-e", bits);
  }

  std::vector<ExactIntermediate> take() { return std::move(list_); }

 private:
  // On the grid of the register, too, where that one is finer.
  static int bits_for(Grid g, const Format& into) { return aligned(g, into.fraction()).bits(); }
  static std::string key(FormatId id) { return "formats." + std::string(key_of(id)); }

  std::string formats(std::initializer_list<FormatId> made_of, const Unit* unit = nullptr) const {
    std::string text;
    const auto append = [&text](const std::string& name, const Format& f) {
      if (!text.empty()) text += ", ";
      text += name + " " + describe(f);
    };
    for (const FormatId id : made_of) append(std::string(key_of(id)), config_.format(id));
    if (unit != nullptr) append(unit->name + ".output", unit->r.output);
    return text;
  }

  void add(ExactIntermediate x) { list_.push_back(std::move(x)); }

  const Config& config_;
  std::vector<ExactIntermediate> list_;
};

// A start offset lies on the grid of half an ulp of its accumulator.
Grid with_offset(Grid g, const StartOffset& offset, const Format& accumulator) {
  if (!offset.half_ulp && offset.value == 0) return g;
  return g + aligned(signed_grid(accumulator), accumulator.fraction() + 1);
}

Grid with_offset(const Config& c, Grid g, const LineWalk& walk) {
  return walk.offset == nullptr ? g : with_offset(g, c.start_offset.*walk.offset, c.format(walk.acc));
}

// What stands for the lines of one arithmetic in expressions: h, r for the shades, w for a channel.
struct LinearLine {
  std::string w;
  Line line;
};
LinearLine linear_line(const Config& c, LineId id, std::string w) {
  return {std::move(w), line_of(id, c.perspective)};
}

// A linear line along an edge: its slope; its start, its steps, and what is kept of them.
void edge_slope(const Config& c, List& list, const std::string& stage, const LinearLine& l, Grid dy,
                const Unit& unit) {
  const Grid vertex = list.of(l.line.walked());
  list.slope(stage, l.w + "_step", "(" + l.w + "2 - " + l.w + "1)", {l.line.walked(), l.line.edge.step},
             vertex - vertex, dy, c.edge_slope, unit, l.line.edge.step);
}
void walk_of_edge(const Config& c, List& list, const std::string& stage, const LinearLine& l, Grid t) {
  const auto& [w, line] = l;
  const LineWalk& walk = line.edge;
  const std::string offset = walk.offset == nullptr ? "" : " + offset";
  list.value(stage, w + "_acc = " + w + "1 + " + w + "_step t0" + offset,
             {line.walked(), walk.step, walk.acc},
             with_offset(c, list.of(line.walked()) + list.of(walk.step) * t, walk), walk.acc);
  list.value(stage, w + "_acc + " + w + "_step", {walk.acc, walk.step},
             list.of(walk.acc) + list.of(walk.step), walk.acc);
  if (walk.kept != walk.acc) {
    list.value(stage, w + " = " + w + "_acc", {walk.acc, walk.kept}, list.of(walk.acc), walk.kept);
  }
}
// The gradients of a linear line.
void plane_gradient(List& list, const std::string& stage, const LinearLine& l, Grid d) {
  const Grid w = list.of(l.line.walked());
  list.quotient(stage, l.w + "_x = nx(" + l.w + ") / area", {l.line.walked(), l.line.gradient},
                (w - w) * d - (w - w) * d, d * d - d * d, l.line.gradient);
}
// Its slope between a row's ends and its start; its start on the triangle's plane; its steps along the row.
void row_from_ends(const Config& c, List& list, const std::string& stage, const LinearLine& l, Grid length,
                   Grid p, SlopeForm form, const Unit& unit) {
  const auto& [w, line] = l;
  const F end = line.edge.kept;
  const std::string offset = line.row.offset == nullptr ? "" : " + offset";
  list.slope(stage, w + "_step", "(" + w + "_r - " + w + "_l)", {end, F::edge_x, line.row.step},
             list.of(end) - list.of(end), length, form, unit, line.row.step);
  list.value(stage, w + " = " + w + "_l + " + w + "_step p" + offset,
             {end, line.row.step, F::edge_x, line.row.acc},
             with_offset(c, list.of(end) + list.of(line.row.step) * p, line.row), line.row.acc);
}
void row_from_plane(const Config& c, List& list, const std::string& stage, const std::string& w, F from,
                    const Line& line, Grid centre) {
  const Grid g = list.of(line.gradient);
  const std::string offset = line.row.offset == nullptr ? "" : " + offset";
  list.value(stage, w + " = " + w + "0 + " + w + "_x X + " + w + "_y Y" + offset,
             {from, line.gradient, line.row.acc},
             with_offset(c, list.of(from) + g * centre + g * centre, line.row), line.row.acc);
  list.value(stage, w + "_step = " + w + "_x", {line.gradient, line.row.step}, g, line.row.step);
}
void steps_of_row(List& list, const std::string& stage, const LinearLine& l) {
  const auto& [w, line] = l;
  const LineWalk& walk = line.row;
  list.value(stage, w + " + " + w + "_step", {walk.acc, walk.step}, list.of(walk.acc) + list.of(walk.step),
             walk.acc);
  if (walk.kept != walk.acc) {
    list.value(stage, w + " = " + w + " register", {walk.acc, walk.kept}, list.of(walk.acc), walk.kept);
  }
}

void constants(const Config& c, List& list) {
  const Grid hmax{c.depth_bits, 0, true};
  const Grid s = list.of(F::setup_s);
  list.quotient("constants", "B = hmax s_min' / (s_max' - s_min')", {F::setup_s, F::setup_b}, hmax * s, s - s,
                F::setup_b);
  if (is_linear_in_distance(c.depth_code)) {
    list.quotient("constants", "c1 = hmax B s_max' / (s_max' - s_min')",
                  {F::setup_b, F::setup_s, F::depth_c1}, hmax * list.of(F::setup_b) * s, s - s, F::depth_c1);
    list.quotient("constants", "c0 = hmax s_min' / (s_max' - s_min')", {F::setup_s, F::depth_c0}, hmax * s,
                  s - s, F::depth_c0);
  }
  list.quotient("setup", "h = B (s_max' - s') / s'", {F::setup_b, F::setup_s, F::setup_h},
                list.of(F::setup_b) * (s - s), s, F::setup_h);
}

void setup_edge(const Config& c, List& list, const Unit& edge_unit, Grid coordinate) {
  const Grid dy = coordinate - coordinate;
  const Grid h = list.of(F::setup_h);
  const Grid uv = list.of(F::setup_uv);
  const bool affine = has_linear_edges(c.perspective);
  const bool by_plane = has_setup_plane(c);
  if (shares_reciprocal(c.edge_slope) && (!by_plane || has_x_step(c))) list.unit(edge_unit);
  if (by_plane) {
    if (has_x_step(c)) {
      list.slope("setup.edge", "x_step", "(x2 - x1)", {F::edge_x_step}, dy, dy, c.edge_slope, edge_unit,
                 F::edge_x_step);
    }
    return;
  }
  edge_slope(c, list, "setup.edge", linear_line(c, LineId::h, "h"), dy, edge_unit);
  if (has_x_step(c)) {
    list.slope("setup.edge", "x_step", "(x2 - x1)", {F::edge_x_step}, dy, dy, c.edge_slope, edge_unit,
               F::edge_x_step);
  }
  if (affine) {
    list.value("setup.edge", "fu_diff = u2 - u1", {F::setup_uv, F::edge_f_diff}, uv - uv, F::edge_f_diff);
  } else {
    list.value("setup.edge", "fu_diff = (u2 - u1)(h2 + B)",
               {F::setup_uv, F::setup_h, F::setup_b, F::edge_f_diff}, (uv - uv) * (h + list.of(F::setup_b)),
               F::edge_f_diff);
  }
  list.slope("setup.edge", "fu_step", "fu_diff", {F::edge_f_diff, F::edge_f_step}, list.of(F::edge_f_diff),
             dy, c.edge_slope, edge_unit, F::edge_f_step);
  edge_slope(c, list, "setup.edge", linear_line(c, LineId::r, "r"), dy, edge_unit);
}

void setup_plane(const Config& c, List& list, const Unit& area_unit, Grid coordinate) {
  const Grid d = coordinate - coordinate;
  const Grid area = d * d - d * d;
  const Grid uv = list.of(F::setup_uv);
  const Grid q = list.of(F::setup_h) + list.of(F::setup_b);
  if (shares_reciprocal(c.edge_slope)) list.unit(area_unit);
  if (has_pixel_reciprocal(c.perspective)) {
    list.value("setup.plane", "u1 = u of vertex 0", {F::setup_uv, F::edge_uv}, uv, F::edge_uv);
    list.value("setup.plane", "fu_i = (u_i - u1)(h_i + B)",
               {F::setup_uv, F::edge_uv, F::setup_h, F::setup_b, F::plane_g}, (uv - list.of(F::edge_uv)) * q,
               F::plane_g);
  } else if (has_pixel_quotients(c.perspective)) {
    list.value("setup.plane", "fu_i = u_i (h_i + B)", {F::setup_uv, F::setup_h, F::setup_b, F::plane_g},
               uv * q, F::plane_g);
  } else {
    list.value("setup.plane", "fu_i = u_i", {F::setup_uv, F::plane_g}, uv, F::plane_g);
  }
  const auto gradient = [&](const std::string& w, F of, F into) {
    const Grid rise = list.of(of) - list.of(of);
    list.slope("setup.plane", w + "_x", "nx(" + w + ")", {of, into}, rise * d - rise * d, area, c.edge_slope,
               area_unit, into);
  };
  gradient("h", F::setup_h, F::plane_h_grad);
  gradient("fu", F::plane_g, F::plane_g_grad);
  gradient("r", F::setup_shade, F::plane_shade_grad);
}

void end_values(const Config& c, List& list, const Unit& pixel_unit, Grid t) {
  const bool affine = has_linear_edges(c.perspective);
  walk_of_edge(c, list, "edge_walk", linear_line(c, LineId::h, "h"), t);
  Grid f = list.of(F::edge_f_step) * t;
  if (affine) f = f + list.of(F::setup_uv);
  list.value("edge_walk", affine ? "fu = u1 + fu_step t0 + offset" : "fu = fu_step t0 + offset",
             {F::setup_uv, F::edge_f_step, F::edge_f},
             with_offset(f, c.start_offset.edge_f, c.format(F::edge_f)), F::edge_f);
  list.value("edge_walk", "fu + fu_step", {F::edge_f, F::edge_f_step},
             list.of(F::edge_f) + list.of(F::edge_f_step), F::edge_f);
  walk_of_edge(c, list, "edge_walk", linear_line(c, LineId::r, "r"), t);
  if (affine) {
    list.value("edge_walk", "u = fu", {F::edge_f, F::edge_uv}, list.of(F::edge_f), F::edge_uv);
  } else {
    list.unit(pixel_unit);
    const Grid base = list.of(F::setup_uv);
    list.product("edge_walk", "u = u1 + fu m 2^-e",
                 {F::setup_uv, F::edge_h, F::setup_b, F::edge_f, F::edge_uv}, &base, list.of(F::edge_f),
                 pixel_unit, F::edge_uv);
  }
}

void edge_walk(const Config& c, List& list, const Unit& pixel_unit, Grid coordinate) {
  // t = y + 1/2 - y1
  const Grid t = Grid{coordinate.integer, 1, true} - coordinate;
  if (!has_setup_plane(c)) end_values(c, list, pixel_unit, t);
  const Grid dx = coordinate - coordinate;
  if (!has_x_step(c)) {
    list.quotient("edge_walk", "x = (x1 dy + (x2 - x1) t) / dy", {F::edge_x}, coordinate * dx + dx * t, dx,
                  F::edge_x);
    return;
  }
  list.value(
      "edge_walk", "x_acc = x1 + x_step t + offset", {F::edge_x_step, F::edge_x_acc},
      with_offset(coordinate + list.of(F::edge_x_step) * t, c.start_offset.edge_x, c.format(F::edge_x_acc)),
      F::edge_x_acc);
  switch (edge_x_of(c)) {
    case EdgeX::summed:
      list.value("edge_walk", "x_acc + x_step", {F::edge_x_acc, F::edge_x_step},
                 list.of(F::edge_x_acc) + list.of(F::edge_x_step), F::edge_x_acc);
      break;
    case EdgeX::quotient:
    case EdgeX::multiplied:
      break;
  }
  list.value("edge_walk", "x = x_acc", {F::edge_x_acc, F::edge_x}, list.of(F::edge_x_acc), F::edge_x);
}

void plane_walk(const Config& c, List& list, Grid coordinate) {
  const Grid d = coordinate - coordinate;
  const Grid area = d * d - d * d;
  const auto n = [&d](Grid w) { return (w - w) * d - (w - w) * d; };
  const Grid h = list.of(F::setup_h);
  const Grid shade = list.of(F::setup_shade);
  const Grid g = list.of(F::plane_g);
  const Grid k = list.of(F::plane_k);
  list.value("plane_walk", "gu_i = u_i (h_i + B)", {F::setup_uv, F::setup_h, F::setup_b, F::plane_g},
             list.of(F::setup_uv) * (h + list.of(F::setup_b)), F::plane_g);
  list.quotient("plane_walk", "h_x = nx(h) / area", {F::setup_h, F::plane_h_grad}, n(h), area,
                F::plane_h_grad);
  list.quotient("plane_walk", "gu_x = nx(gu) / area", {F::plane_g, F::plane_g_grad}, n(g), area,
                F::plane_g_grad);
  plane_gradient(list, "plane_walk", linear_line(c, LineId::r, "r"), d);
  list.quotient("plane_walk", "k = -nx(h) / ny(h)", {F::setup_h, F::plane_k}, n(h), n(h), F::plane_k);
  const Grid centre = d + Grid{d.integer, 1, true};                           // Mc - M0, Np - N0
  const Grid line = centre + Grid{coordinate.integer + 1, k.fraction, true};  // Nl - N0: |k| <= 1
  const bool ideal = is_on_ideal_line(c.numerator);
  list.value("plane_walk", "h = h0 + h_M (Mc - M0) + h_N (Nl - N0)",
             {F::setup_h, F::plane_h_grad, F::plane_k, F::span_h},
             h + list.of(F::plane_h_grad) * centre + list.of(F::plane_h_grad) * line, F::span_h);
  list.value(
      "plane_walk",
      ideal ? "gu = gu0 + gu_M (Mc - M0) + gu_N (Nl - N0)" : "gu = gu0 + gu_M (Mc - M0) + gu_N (Np - N0)",
      {F::plane_g, F::plane_g_grad, F::plane_k, F::span_f},
      g + list.of(F::plane_g_grad) * centre + list.of(F::plane_g_grad) * (ideal ? line : centre), F::span_f);
  const Grid gg = list.of(F::plane_g_grad);
  list.value("plane_walk", ideal ? "gu_step = gu_M + k gu_N" : "gu_step1 = gu_M + sg gu_N",
             {F::plane_g_grad, F::plane_k, F::span_f_step}, ideal ? gg + k * gg : gg + gg, F::span_f_step);
  const Grid sg = list.of(F::plane_shade_grad);
  list.value(
      "plane_walk", "r = r0 + r_M (Mc - M0) + r_N (Np - N0) + offset",
      {F::setup_shade, F::plane_shade_grad, F::span_shade_acc},
      with_offset(shade + sg * centre + sg * centre, c.start_offset.span_shade, c.format(F::span_shade_acc)),
      F::span_shade_acc);
  list.value("plane_walk", "r_step1 = r_M + sg r_N", {F::plane_shade_grad, F::span_shade_step}, sg + sg,
             F::span_shade_step);
}

// span_setup, where slope.row = plane.
void span_of_plane(const Config& c, List& list, Grid coordinate) {
  // From a vertex to a pixel's centre.
  const Grid centre = Grid{coordinate.integer, 1, true} - coordinate;
  const auto line = [&](const std::string& w, LineId id, F from) {
    row_from_plane(c, list, "span_setup", w, from, line_of(id, c.perspective), centre);
  };
  line("h", LineId::h, F::setup_h);
  line("fu", LineId::fu, F::plane_g);
  line("r", LineId::r, F::setup_shade);
}

void span_setup(const Config& c, List& list, const Unit& row_unit, Grid coordinate) {
  if (has_plane_rows(c.perspective)) {
    list.unit(row_unit);
    const Format& acc = c.format(F::span_uv_acc);
    const Grid base = with_offset(Grid{0, 0, true}, c.start_offset.span_f, acc);
    list.product("span_setup", "fu = gu m 2^-e + offset", {F::span_f, F::span_h, F::setup_b, F::span_uv_acc},
                 &base, list.of(F::span_f), row_unit, F::span_uv_acc);
    list.product("span_setup", "fu_step = gu_step m 2^-e",
                 {F::span_f_step, F::span_h, F::setup_b, F::span_uv_step}, nullptr, list.of(F::span_f_step),
                 row_unit, F::span_uv_step);
    return;
  }
  if (has_setup_plane(c)) {
    span_of_plane(c, list, coordinate);
    return;
  }
  const SlopeForm form = form_of(c.row_slope);
  const Grid length = list.of(F::edge_x) - list.of(F::edge_x);
  const Grid p = Grid{coordinate.integer, 1, true} - list.of(F::edge_x);
  if (shares_reciprocal(form)) list.unit(row_unit);
  const Grid h = list.of(F::edge_h);
  const Grid uv = list.of(F::edge_uv);
  row_from_ends(c, list, "span_setup", linear_line(c, LineId::h, "h"), length, p, form, row_unit);
  const Grid q = h + list.of(F::setup_b);
  if (has_linear_edges(c.perspective)) {
    list.slope("span_setup", "fu_step", "(u_r - u_l)", {F::edge_uv, F::edge_x, F::span_uv_step}, uv - uv,
               length, form, row_unit, F::span_uv_step);
    list.value(
        "span_setup", "fu = u_l + fu_step p + offset",
        {F::edge_uv, F::span_uv_step, F::edge_x, F::span_uv_acc},
        with_offset(uv + list.of(F::span_uv_step) * p, c.start_offset.span_f, c.format(F::span_uv_acc)),
        F::span_uv_acc);
  } else {
    const bool hyperbolic = has_pixel_quotients(c.perspective);
    const Grid f = list.of(F::span_f_diff);
    list.value("span_setup", hyperbolic ? "gl = u_l (h_l + B)" : "fu_diff = (u_r - u_l)(h_r + B)",
               {F::edge_uv, F::edge_h, F::setup_b, F::span_f_diff}, hyperbolic ? uv * q : (uv - uv) * q,
               F::span_f_diff);
    list.slope("span_setup", "fu_step", hyperbolic ? "(gr - gl)" : "fu_diff",
               {F::span_f_diff, F::edge_x, F::span_f_step}, hyperbolic ? f - f : f, length, form, row_unit,
               F::span_f_step);
    Grid start = list.of(F::span_f_step) * p;
    if (hyperbolic) start = start + f;
    list.value("span_setup", hyperbolic ? "fu = gl + fu_step p + offset" : "fu = fu_step p + offset",
               {F::span_f_diff, F::span_f_step, F::edge_x, F::span_f},
               with_offset(start, c.start_offset.span_f, c.format(F::span_f)), F::span_f);
  }
  row_from_ends(c, list, "span_setup", linear_line(c, LineId::r, "r"), length, p, form, row_unit);
}

void span(const Config& c, List& list, const Unit& pixel_unit) {
  const Grid q = list.of(F::span_h) + list.of(F::setup_b);
  switch (c.perspective) {
    case Perspective::delta_f: {
      list.unit(pixel_unit);
      const Grid base = list.of(F::edge_uv);
      list.product("span", "u = u1 + fu m 2^-e", {F::edge_uv, F::span_h, F::setup_b, F::span_f, F::span_uv},
                   &base, list.of(F::span_f), pixel_unit, F::span_uv);
      break;
    }
    case Perspective::hyperbolic:
      list.quotient("span", "u = fu / (h + B)", {F::span_f, F::span_h, F::setup_b, F::span_uv},
                    list.of(F::span_f), q, F::span_uv);
      break;
    case Perspective::affine:
    case Perspective::const_depth_rows:
      list.value("span", "u = fu", {F::span_uv_acc, F::span_uv}, list.of(F::span_uv_acc), F::span_uv);
      break;
  }
  const LineWalk texture = line_of(LineId::fu, c.perspective).row;
  steps_of_row(list, "span", linear_line(c, LineId::h, "h"));
  list.value("span", "fu + fu_step", {texture.acc, texture.step},
             list.of(texture.acc) + list.of(texture.step), texture.acc);
  steps_of_row(list, "span", linear_line(c, LineId::r, "r"));
}

// The channels, stage by stage.
std::vector<LinearLine> channel_lines(const Config& c) {
  std::vector<LinearLine> out;
  for (const int channel : ChannelList(c)) out.push_back(linear_line(c, channel_line(channel), "w"));
  return out;
}
void setup_channels(const Config& c, List& list, const Unit& edge_unit, const Unit& area_unit,
                    Grid coordinate) {
  const Grid d = coordinate - coordinate;
  for (const LinearLine& l : channel_lines(c)) {
    if (l.line.is_homogeneous()) {
      list.value("setup.channel", "f = w (h + B)", {l.line.vertex, F::setup_h, F::setup_b, *l.line.product},
                 list.of(l.line.vertex) * (list.of(F::setup_h) + list.of(F::setup_b)), *l.line.product);
    }
    if (has_plane_rows(c.perspective)) {
      plane_gradient(list, "setup.channel", l, d);
    } else if (has_setup_plane(c)) {
      const Grid rise = list.of(l.line.walked()) - list.of(l.line.walked());
      list.slope("setup.channel", "w_x", "nx(w)", {l.line.walked(), l.line.gradient}, rise * d - rise * d,
                 d * d - d * d, c.edge_slope, area_unit, l.line.gradient);
    } else {
      edge_slope(c, list, "setup.channel", l, d, edge_unit);
    }
  }
}
void edge_walk_channels(const Config& c, List& list, Grid coordinate) {
  if (has_plane_rows(c.perspective) || has_setup_plane(c)) return;
  const Grid t = Grid{coordinate.integer, 1, true} - coordinate;
  for (const LinearLine& l : channel_lines(c)) walk_of_edge(c, list, "edge_walk.channel", l, t);
}
void span_setup_channels(const Config& c, List& list, const Unit& row_unit, Grid coordinate) {
  const Grid centre = Grid{coordinate.integer, 1, true} - coordinate;
  for (const LinearLine& l : channel_lines(c)) {
    if (has_plane_rows(c.perspective) || has_setup_plane(c)) {
      row_from_plane(c, list, "span_setup.channel", l.w, l.line.walked(), l.line, centre);
    } else {
      row_from_ends(c, list, "span_setup.channel", l, list.of(F::edge_x) - list.of(F::edge_x),
                    Grid{coordinate.integer, 1, true} - list.of(F::edge_x), form_of(c.row_slope), row_unit);
    }
    if (has_plane_rows(c.perspective)) {
      const Grid g = list.of(l.line.gradient);
      list.value("span_setup.channel", "w_step1 = w_M + sg w_N", {l.line.gradient, l.line.row.step}, g + g,
                 l.line.row.step);
    }
  }
}
void span_channels(const Config& c, List& list, const Unit& pixel_unit) {
  for (const LinearLine& l : channel_lines(c)) {
    steps_of_row(list, "span.channel", l);
    if (!l.line.span_divides) continue;
    const F acc = l.line.row.acc;
    const F kept = l.line.row.kept;
    const Grid q = list.of(F::span_h) + list.of(F::setup_b);
    if (has_pixel_reciprocal(c.perspective)) {
      list.product("span.channel", "w = w m 2^-e", {acc, F::span_h, F::setup_b, kept}, nullptr, list.of(acc),
                   pixel_unit, kept);
    } else {
      list.quotient("span.channel", "w = w / (h + B)", {acc, F::span_h, F::setup_b, kept}, list.of(acc), q,
                    kept);
    }
  }
}

void depth(const Config& c, List& list, const Unit& pixel_unit) {
  const Grid h = list.of(F::span_h);
  switch (c.depth_code) {
    case DepthCode::inverse:
      list.value("depth", "z = h", {F::span_h}, h, c.depth_format(), "depth");
      break;
    case DepthCode::opengl:
    case DepthCode::float_dz:
      list.value("depth", "z = zmax - h", {F::span_h}, Grid{c.depth_bits, 0, true} - h, c.depth_format(),
                 "depth");
      break;
    case DepthCode::linear: {
      if (!has_pixel_reciprocal(c.perspective)) list.unit(pixel_unit);
      const Grid base = list.of(F::depth_c0);
      list.product("depth", "z = c1 m 2^-e - c0", {F::depth_c1, F::depth_c0, F::span_h, F::setup_b}, &base,
                   list.of(F::depth_c1), pixel_unit, c.depth_format(), "depth");
      break;
    }
    case DepthCode::w_float: {
      // K is at most one more than the places of hmax or B.
      const Grid q = h + list.of(F::setup_b);
      const int top = std::max(c.depth_bits, list.of(F::setup_b).integer) + q.fraction;
      list.value("depth", "z = 2^p (L + 2 - (h + B) 2^(L+1-K))", {F::span_h, F::setup_b},
                 Grid{c.depth_bits + 1, top - (c.depth_bits - w_float_exponent_bits), true}, c.depth_format(),
                 "depth");
      break;
    }
  }
}

void gradients(List& list, Grid coordinate) {
  const Grid d = coordinate - coordinate;
  const Grid area = d * d - d * d;
  const auto n = [&d](Grid w) { return (w - w) * d - (w - w) * d; };
  const Grid h = list.of(F::setup_h);
  list.value("setup.gradient", "gu_i = u_i (h_i + B)", {F::setup_uv, F::setup_h, F::setup_b, F::plane_g},
             list.of(F::setup_uv) * (h + list.of(F::setup_b)), F::plane_g);
  list.quotient("setup.gradient", "h_x = nx(h) / area", {F::setup_h, F::plane_h_grad}, n(h), area,
                F::plane_h_grad);
  list.quotient("setup.gradient", "gu_x = nx(gu) / area", {F::plane_g, F::plane_g_grad},
                n(list.of(F::plane_g)), area, F::plane_g_grad);
}

bool span_or_depth_has_unit(const Config& c) {
  return has_pixel_reciprocal(c.perspective) || is_linear_in_distance(c.depth_code);
}

// s of a stage.
void along_axis(const Config& c, List& list, const Unit& pixel_unit, const std::string& stage) {
  if (!span_or_depth_has_unit(c)) list.unit(pixel_unit);
  list.value(stage, "A' = B s_max'", {F::setup_b, F::setup_s, F::distance_a},
             list.of(F::setup_b) * list.of(F::setup_s), F::distance_a);
  list.product(stage, "s = A' m 2^-e", {F::distance_a, F::span_h, F::setup_b, F::distance_s}, nullptr,
               list.of(F::distance_a), pixel_unit, F::distance_s);
}

void distance(const Config& c, List& list, const Unit& pixel_unit) {
  along_axis(c, list, pixel_unit, "distance");
  if (!has_true_distance(c)) return;
  list.value("distance", "d = s G", {F::distance_s, F::distance_g, F::distance_d},
             list.of(F::distance_s) * list.of(F::distance_g), F::distance_d);
}

void lod(const Config& c, List& list, const Unit& pixel_unit, const Unit& neighbour_unit) {
  const Grid bias{6, 4, true};
  const Grid level{6, 1, true};
  list.value("lod", "lambda - level", {F::lod_lambda, F::lod_frac}, list.of(F::lod_lambda) - level,
             F::lod_frac);
  // Of the second texture unit, whose bias is another one by less than 4.
  list.value("lod", "lambda + bias", {F::lod_lambda}, list.of(F::lod_lambda) + Grid{2, 4, true},
             F::lod_lambda);
  switch (c.lod) {
    case LodMode::none:
      list.value("lod", "lambda = bias", {F::lod_lambda}, bias, F::lod_lambda);
      break;
    case LodMode::zone_s:
    case LodMode::zone_d: {
      const bool by_d = takes_true_distance(c.lod);
      if (!by_d) along_axis(c, list, pixel_unit, "lod");
      const Grid start = zone_starts();
      list.quotient("lod", "k_i = 1 / S_i", {F::lod_k}, Grid{2, 0, true}, start, F::lod_k);
      const F by = by_d ? F::distance_d : F::distance_s;
      list.value("lod", by_d ? "f = (d - S_z) k_z" : "f = (s - S_z) k_z", {by, F::lod_k, F::lod_frac},
                 (list.of(by) - start) * list.of(F::lod_k), F::lod_frac);
      list.value("lod", "lambda = z + f + bias", {F::lod_frac, F::lod_lambda},
                 level + list.of(F::lod_frac) + bias, F::lod_lambda);
      break;
    }
    case LodMode::gradient:
    case LodMode::finite: {
      const Unit& unit = has_neighbours(c.lod) ? neighbour_unit : pixel_unit;
      if (has_neighbours(c.lod) || !span_or_depth_has_unit(c)) list.unit(unit);
      list.product("lod", "u_x = (gu_x - u h_x) m 2^-e",
                   {F::plane_g_grad, F::span_uv, F::plane_h_grad, F::span_h, F::setup_b, F::lod_slope},
                   nullptr, list.of(F::plane_g_grad) - list.of(F::span_uv) * list.of(F::plane_h_grad), unit,
                   F::lod_slope);
      const Grid log{8, c.format(F::lod_slope).word, true};
      list.value("lod", "lambda = E + (rho 2^-E - 1) + bias", {F::lod_slope, F::lod_lambda}, log + bias,
                 F::lod_lambda);
      break;
    }
  }
}

void texture(const Config& c, List& list) {
  const Grid code{8, 0, true};
  const Grid mix = list.of(F::texture_mix);
  const Grid alpha = list.of(F::texture_alpha);
  list.value("texture", "V = texel", {F::texture_mix}, code, F::texture_mix);
  list.quotient("texture", "a / 255", {F::texture_alpha}, code, code, F::texture_alpha);
  if (weighs_texels(c.filter)) {
    const Grid e = list.of(F::texture_frac);
    const Grid rest = Grid{1, 0, true} - e;
    const Grid u = list.of(F::span_uv);
    list.value("texture", "Ex = u - 1/2 - i'", {F::span_uv, F::texture_frac},
               aligned(u, u.fraction + (has_lod(c) ? max_mip_level : 0)) - Grid{0, 1, true}, F::texture_frac);
    list.value("texture", "V5 = V1 (1 - Ex) + V4 Ex", {F::texture_frac, F::texture_mix},
               code * rest + code * e, F::texture_mix);
    list.value("texture", "V = V5 (1 - Ey) + V6 Ey", {F::texture_mix, F::texture_frac}, mix * rest + mix * e,
               F::texture_mix);
    list.value("texture", "alpha of V = alpha of V5 (1 - Ey) + alpha of V6 Ey",
               {F::texture_alpha, F::texture_frac}, alpha * rest + alpha * e, F::texture_alpha);
  }
  if (mixes_levels(c.mip)) {
    const Grid f = list.of(F::lod_frac);
    const Grid rest = Grid{1, 0, true} - f;
    list.value("texture", "V = V_l (1 - f) + V_l+1 f", {F::texture_mix, F::lod_frac}, mix * rest + mix * f,
               F::texture_mix);
    list.value("texture", "alpha of V = alpha of V_l (1 - f) + alpha of V_l+1 f",
               {F::texture_alpha, F::lod_frac}, alpha * rest + alpha * f, F::texture_alpha);
  }
  list.value("texture", "r = V_r r", {F::texture_mix, shade_factor(c), F::texture_color},
             mix * list.of(shade_factor(c)), F::texture_color);
  list.value("texture", "a = V_a a", {F::texture_alpha, shade_factor(c)}, alpha * list.of(shade_factor(c)),
             F::texture_alpha);
}

void project(const Config& c, List& list, const Unit& unit) {
  list.unit(unit);
  list.product("project", "s = X m 2^-e", {F::project_value, F::span_uv}, nullptr, list.of(F::project_value),
               unit, F::span_uv);
  list.product("project", "ratio = (h + B) m 2^-e",
               {F::span_h, F::setup_b, F::project_value, F::project_ratio}, nullptr,
               list.of(F::span_h) + list.of(F::setup_b), unit, F::project_ratio);
  list.value("project", "A = B s_max'", {F::setup_b, F::setup_s, F::distance_a},
             list.of(F::setup_b) * list.of(F::setup_s), F::distance_a);
  const Grid h = list.of(F::project_h);
  list.value("project", "h = A ratio - B", {F::distance_a, F::project_ratio, F::setup_b, F::project_h},
             list.of(F::distance_a) * list.of(F::project_ratio) - list.of(F::setup_b), F::project_h);
  if (is_complement_of_h(c.depth_code)) {
    list.value("project", "z = zmax - h", {F::project_h}, Grid{c.depth_bits, 0, true} - h, c.depth_format(),
               "depth");
  } else {
    list.value("project", "z = h", {F::project_h}, h, c.depth_format(), "depth");
  }
}

// The reciprocal square root, and what it makes of length 1.
void unit_vector(const Config& c, List& list, const std::string& of, std::initializer_list<FormatId> made_of,
                 Grid x, FormatId into) {
  const RootUnit& root = c.light_root;
  const std::string square = of + "." + of;
  const Grid d = x * x + x * x + x * x;
  list.value("light", square, made_of, d, into);
  const Grid n{2, root.operand_bits, true};
  Grid y{1, root.table_bits, true};
  for (int step = 0; step < root.steps; ++step) {
    const Grid inside{3, root.internal_bits, true};
    list.value("light", "n y", {FormatId::light_root}, n * y, FormatId::light_root);
    list.value("light", "n y y", {FormatId::light_root}, inside * y, FormatId::light_root);
    list.value("light", "y (3 - n y y)", {FormatId::light_root}, y * inside, FormatId::light_root);
    y = {1, root.internal_bits, true};
  }
  list.value("light", "y", {FormatId::light_root}, y, FormatId::light_root);
  const Grid product = x * list.of(FormatId::light_root);
  // 4^e <= d
  list.value("light", of + " m 2^-e", made_of, product + scaled(product, d.integer / 2 + 1), into);
  list.value("light", of + " m 2^-e", made_of, product + scaled(product, -(d.fraction + 1) / 2), into);
}

void light(const Config& c, List& list, Grid coordinate) {
  const Grid cosine = list.of(F::light_cosine);
  const Grid specular = list.of(F::light_specular);
  const Grid value = list.of(F::light_value);
  unit_vector(c, list, "N", {F::normal_value, F::light_root, F::light_normal}, list.of(F::normal_value),
              F::light_normal);
  const Grid place = list.of(F::light_position);
  if (has_light_points(c)) {
    const F s = lights_pixels(c.light) ? F::distance_s : F::setup_s;
    const Grid across = coordinate - Grid{c.coordinate_bits, 1, true};
    list.value("light", "x s k", {s, F::light_scale, F::light_position},
               across * list.of(s) * list.of(F::light_scale), F::light_position);
    list.value("light", "s", {s, F::light_position}, list.of(s), F::light_position);
  }
  unit_vector(c, list, "L", {F::light_position, F::light_root, F::light_direction},
              has_light_points(c) ? place - place : place, F::light_direction);
  if (has_relief(c)) {
    const Grid code{8, 0, true};
    unit_vector(c, list, "2 V - 255", {F::texture_mix, F::light_root, F::light_normal},
                scaled(list.of(F::texture_mix), -1) - code, F::light_normal);
    unit_vector(c, list, "Lp - uv", {F::relief_value, F::span_uv, F::light_root, F::light_direction},
                list.of(F::relief_value) - list.of(F::span_uv), F::light_direction);
  }
  const Grid both = list.of(F::light_normal) * list.of(F::light_direction);
  list.value("light", "c = N.L", {F::light_normal, F::light_direction, F::light_cosine}, both + both + both,
             F::light_cosine);
  list.value("light", "g = Lz - 2 c Nz", {F::light_normal, F::light_direction, F::light_cosine},
             list.of(F::light_direction) - scaled(cosine * list.of(F::light_normal), -1), F::light_cosine);
  // x Inv(T) 2^-2e, 4^e <= T < 4^(e+1).
  const auto divided = [&](const std::string& text, std::initializer_list<FormatId> made_of, Grid x, Grid t,
                           FormatId into) {
    list.value("light", text, made_of, x + scaled(x, t.integer), into);
    list.value("light", text, made_of, x + scaled(x, -(t.fraction + 1)), into);
  };
  if (has_lunar(c) || has_light_fall(c)) {
    const Grid root = list.of(F::light_root);
    list.value("light", "m m", {F::light_root, F::light_inverse}, root * root, F::light_inverse);
  }
  if (has_lunar(c)) {
    const Grid lunar = list.of(F::light_lunar);
    list.value("light", "1 + k Nz", {F::light_lunar, F::light_normal},
               Grid{1, 0, true} + lunar * list.of(F::light_normal), F::light_lunar);
    divided("c Inv", {F::light_lunar, F::light_inverse, F::light_cosine}, cosine * list.of(F::light_inverse),
            lunar, F::light_cosine);
  }
  if (has_light_fall(c)) {
    const Grid distance = list.of(F::light_distance);
    const Grid part = (place - place) * list.of(F::light_direction);
    list.value("light", "d = D.Unit(D)", {F::light_position, F::light_direction}, part + part + part,
               F::light_position);
    list.value("light", "d w", {F::light_position, F::light_scale, F::light_distance},
               place * list.of(F::light_scale), F::light_distance);
    list.value("light", "d + K", {F::light_distance},
               falls_by_square(c.light_fall) ? distance * distance + distance : distance + distance,
               F::light_distance);
    divided("Inv", {F::light_distance, F::light_inverse, F::light_fall}, list.of(F::light_inverse), distance,
            F::light_fall);
    list.value("light", "V = f U + ka", {F::light_fall, F::light_value},
               value * list.of(F::light_fall) + value, F::light_value);
  }
  if (has_light_fall(c) || has_light_shadow(c)) {
    list.value("light", "U = kd c + ks spec", {F::light_cosine, F::light_specular, F::light_value},
               value * cosine + value * specular, F::light_value);
  }
  if (has_light_shadow(c)) {
    list.value("light", "U share", {F::texture_alpha, F::light_value}, value * list.of(F::texture_alpha),
               F::light_value);
    list.value("light", "V = U + ka", {F::light_value}, value + value, F::light_value);
  }
  const Grid place_in_table{1, std::max(cosine.fraction - c.light_index_bits, 0), true};
  list.value("light", "t_j + (t_j+1 - t_j) x", {F::light_cosine, F::light_specular},
             specular + (specular - specular) * place_in_table, F::light_specular);
  list.value("light", "V = kd c + ks spec + ka", {F::light_cosine, F::light_specular, F::light_value},
             value * cosine + value * specular + value, F::light_value);
  list.value("light", "r = r V", {F::texture_color, F::light_value}, list.of(F::texture_color) * value,
             F::texture_color);
}

void texture_second(List& list) {
  const Grid code{8, 0, true};
  const Grid mix = list.of(F::texture_mix);
  const Grid alpha = list.of(F::texture_alpha);
  const Grid color = list.of(F::texture_color);
  const Grid rest = Grid{1, 0, true} - alpha;
  list.quotient("texture.second", "F = V / 255", {F::texture_mix, F::texture_alpha}, mix, code,
                F::texture_alpha);
  list.value("texture.second", "r = r F 2^2", {F::texture_color, F::texture_alpha}, scaled(color * alpha, -2),
             F::texture_color);
  list.value("texture.second", "r = r (1 - V_a) + V_r V_a",
             {F::texture_color, F::texture_mix, F::texture_alpha}, color * rest + mix * alpha,
             F::texture_color);
  list.value("texture.second", "r = r (1 - F) + K F", {F::texture_color, F::texture_alpha},
             color * rest + code * alpha, F::texture_color);
  list.value("texture.second", "r = r + V_r", {F::texture_color, F::texture_mix}, color + mix,
             F::texture_color);
  list.value("texture.second", "a = a V_a", {F::texture_alpha}, alpha * alpha, F::texture_alpha);
}

void fog(const Config& c, List& list, const Unit& pixel_unit) {
  const Grid color = list.of(F::texture_color);
  if (!has_fog(c.fog)) {
    list.value("fog", "r = r of texture", {F::texture_color, F::fog_color}, color, F::fog_color);
    return;
  }
  if (is_linear_in_distance(c.fog)) {
    if (!has_pixel_reciprocal(c.perspective) && !is_linear_in_distance(c.depth_code)) list.unit(pixel_unit);
    const Grid base{1, 0, true};
    list.product("fog", "factor = 1 - fog_scale m 2^-e", {F::fog_scale, F::span_h, F::setup_b, F::fog_factor},
                 &base, list.of(F::fog_scale), pixel_unit, F::fog_factor);
  }
  if (takes_distance(c.fog) && !takes_true_distance(c.fog)) {
    // The place between two entries has the bits of s below its highest one.
    const Grid entry = list.of(F::fog_factor);
    const Grid place{1, c.format(F::distance_s).word + 3, true};
    list.value("fog", "factor = f_i + (f_i+1 - f_i) t", {F::distance_s, F::fog_factor},
               entry + (entry - entry) * place, F::fog_factor);
  }
  const Grid vt{8, 0, true};
  list.value("fog", "r = VT_r + (r - VT_r) factor", {F::texture_color, F::fog_factor, F::fog_color},
             vt + (color - vt) * list.of(F::fog_factor), F::fog_color);
}

void merge(List& list) {
  const Grid dst{8, 0, true};
  list.value("merge", "r = dst_r + (r - dst_r) a", {F::fog_color, F::texture_alpha, F::merge_color},
             dst + (list.of(F::fog_color) - dst) * list.of(F::texture_alpha), F::merge_color);
}

}  // namespace

std::vector<ExactIntermediate> exact_intermediates(const Config& c) {
  List list(c);
  const Grid coordinate = signed_grid(c.coordinate_format());
  const bool rows_of_depth = has_plane_rows(c.perspective);
  const Grid dy = coordinate - coordinate;
  const Grid length = list.of(F::edge_x) - list.of(F::edge_x);
  const Grid edge_q = list.of(F::edge_h) + list.of(F::setup_b);
  const Grid span_q = list.of(F::span_h) + list.of(F::setup_b);
  const Unit edge_unit{"reciprocal.edge", c.edge_reciprocal, positive(dy)};
  const Unit area_unit{"reciprocal.edge", c.edge_reciprocal, positive(dy * dy - dy * dy)};
  const Unit row_unit{"reciprocal.row", c.row_reciprocal, positive(rows_of_depth ? span_q : length)};
  const Unit edge_pixel_unit{"reciprocal.pixel", c.pixel_reciprocal, positive(edge_q)};
  const Unit pixel_unit{"reciprocal.pixel", c.pixel_reciprocal, positive(span_q)};
  const Unit neighbour_unit{"reciprocal.pixel", c.pixel_reciprocal,
                            positive(span_q + list.of(F::plane_h_grad))};

  constants(c, list);
  list.value("setup", "area = (x1-x0)(y2-y0) - (x2-x0)(y1-y0)", {}, dy * dy - dy * dy, Format{1, 1, true},
             "raster");
  if (!rows_of_depth) {
    setup_edge(c, list, edge_unit, coordinate);
    if (has_setup_plane(c)) setup_plane(c, list, area_unit, coordinate);
  }
  setup_channels(c, list, edge_unit, area_unit, coordinate);
  if (rows_of_depth) {
    plane_walk(c, list, coordinate);
  } else {
    edge_walk(c, list, edge_pixel_unit, coordinate);
    edge_walk_channels(c, list, coordinate);
  }
  span_setup(c, list, row_unit, coordinate);
  span_setup_channels(c, list, row_unit, coordinate);
  span(c, list, pixel_unit);
  span_channels(c, list, pixel_unit);
  depth(c, list, pixel_unit);
  if (has_setup_gradients(c)) gradients(list, coordinate);
  if (has_distance(c)) distance(c, list, pixel_unit);
  if (has_lod(c)) lod(c, list, pixel_unit, neighbour_unit);
  texture(c, list);
  if (has_project(c.project)) {
    project(c, list, {"reciprocal.pixel", c.pixel_reciprocal, positive(list.of(F::project_value))});
  }
  texture_second(list);
  if (has_light(c.light)) light(c, list, coordinate);
  fog(c, list, pixel_unit);
  merge(list);
  return list.take();
}

}  // namespace bitspan
