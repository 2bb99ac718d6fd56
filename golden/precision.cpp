// SPDX-License-Identifier: Apache-2.0
#include "golden/precision.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>

#include "config/modes.hpp"
#include "golden/quantize.hpp"
#include "golden/values.hpp"

namespace bitspan::golden {

namespace {

// Every value is a multiple of 2^lo and at most 2^hi in magnitude.
struct Range {
  int lo = 0;
  int hi = 0;
  int bits() const { return std::max(hi - lo, 1); }
};

Range product(Range a, Range b) { return {a.lo + b.lo, a.hi + b.hi}; }
Range sum(Range a, Range b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi) + 1}; }
Range at_most(Range a, int hi) { return {a.lo, std::min(a.hi, hi)}; }
Range range_of(const Format& f) { return {-f.fraction(), f.is_signed ? f.integer - 1 : f.integer}; }

// A product that may lie far outside the format `out` that it is summed into, beside terms that lie within
// the formats `near` and an offset. Where overflow saturates, a product beyond the bound gives the format's
// limit whatever it is summed with, so that the exact sum needs no bits for the distance.
struct FarBound {
  bool wraps = true;
  int exponent = 0;  // the bound is 2^exponent: 4 times what any of the others holds
  FarBound(const Format& out, std::initializer_list<Format> near, double offset = 0)
      : wraps(out.overflow == Overflow::wrap || out.overflow == Overflow::wrap_sm), exponent(out.integer) {
    for (const Format& format : near) exponent = std::max(exponent, format.integer);
    if (offset != 0) exponent = std::max(exponent, std::ilogb(offset) + 1);
    exponent += 2;
  }
};

// A term of a sum: a register, or a product, which is held as a Pair and needs the bits of its wider factor.
struct Term {
  Range range;
  int bits = 0;
};
Term term(Range r) { return {r, r.bits()}; }
Term term(Range a, Range b) { return {product(a, b), std::max(a.bits(), b.bits())}; }

// What a reciprocal unit delivers: m 2^-e.
struct InverseRange {
  Range m;
  int e_min = 0;
  int e_max = 0;
  // Scaling by 2^-e costs no bit, wherever e puts the product.
  Term times(Range x) const {
    return {{x.lo + m.lo - e_max, x.hi + m.hi - e_min}, std::max(x.bits(), m.bits())};
  }
};

class StageNeeds {
 public:
  StageNeeds(std::string stage, std::vector<PrecisionRow>& rows)
      : stage_(std::move(stage)), rows_(rows), first_(rows.size()) {}

  void need(const std::string& expression, int bits) { need(expression, bits, bits); }
  void need(const std::string& expression, int bits, int held) {
    if (bits > significant_bits(Width::quad)) {
      throw InputError(stage_ + ": golden would need " + std::to_string(bits) + " significant bits for " +
                       expression + "; at most 113 are legal, narrow the formats it is made of");
    }
    held_ = std::max(held_, held);
    rows_.push_back({stage_, expression, bits, held, Width::quad});
  }

  // A register of the stage. Wrapping a signed one passes through its unsigned value.
  Range reg(const std::string& name, const Format& f) {
    need(name, f.is_signed && f.overflow != Overflow::wrap ? f.word - 1 : f.word);
    return range_of(f);
  }
  Range exact(const std::string& expression, Range r) {
    need(expression, r.bits());
    return r;
  }
  // A sum of products as one Pair, without a check: Pairs of p-bit numbers hold 2 p - 2 bits.
  Range exact_pair(const std::string& expression, Range r, int factor_bits) {
    need(expression, r.bits(), std::max(factor_bits, (r.bits() + 3) / 2));
    return r;
  }
  // Q of a sum, whose integer and fractional parts (in ulps) fit one number of quadruple precision each.
  void q_sum(const std::string& expression, std::initializer_list<Term> terms, const Format& out) {
    const int grow = static_cast<int>(std::bit_width(2 * terms.size() - 1));  // a product counts twice
    int bits = 1;
    int held = 1;
    for (const Term& t : terms) {
      held = std::max(held, t.bits);
      const int integer = t.range.hi + out.fraction() + grow;
      const int fraction = -t.range.lo - out.fraction() + 1;
      bits = std::max({bits, t.bits, integer, fraction});
    }
    need(expression, bits, held);
  }

  // The same with a product that may be far.
  void q_far(const std::string& expression, Term product, std::initializer_list<Term> near, const Format& out,
             const FarBound& bound) {
    if (!bound.wraps) product.range.hi = std::min(product.range.hi, bound.exponent);
    int bits = 1;
    int lo = product.range.lo;
    int hi = product.range.hi;
    for (const Term& t : near) {
      lo = std::min(lo, t.range.lo);
      hi = std::max(hi, t.range.hi);
      bits = std::max(bits, t.bits);
    }
    const int grow = static_cast<int>(std::bit_width(near.size() + 1));  // the product counts twice
    need(expression, std::max({bits, product.bits, hi + out.fraction() + grow, -lo - out.fraction() + 1}),
         std::max(bits, product.bits));
  }
  void q_product(const std::string& expression, Term product, const Format& out) {
    q_far(expression, product, {}, out, FarBound(out, {}));
  }

  // n / d: the quotient's candidate times d, and the remainder.
  static int quotient_bits(Range n, Range d, int fraction) {
    const int product_bits = std::max(n.hi + fraction, d.hi) + 1 - d.lo;
    const int rest_bits = d.hi + 1 - std::min(n.lo + fraction, d.lo);
    return std::max({n.bits(), d.bits(), product_bits, rest_bits});
  }
  void floor_of_quotient(const std::string& expression, Range n, Range d) {
    need(expression, quotient_bits(n, d, 0));
  }
  // Q of it, by the checked remainder. A Pair for n or d holds what exact_pair says.
  void q_quotient(const std::string& expression, Range n, Range d, int fraction) {
    need(expression, quotient_bits(n, d, fraction), std::max(n.bits(), d.bits()));
  }
  void q_quotient_of_pairs(const std::string& expression, Range n, Range d, int fraction) {
    need(expression, quotient_bits(n, d, fraction), 1);
  }

  // Slope(n, d, form, R, name).
  void slope(const std::string& expression, Range n, Range d, SlopeForm form, const InverseRange& inverse,
             const Format& out) {
    switch (form) {
      case SlopeForm::divide:
        q_quotient(expression + " / d", n, d, out.fraction());
        break;
      case SlopeForm::reciprocal:
        q_product(expression + " * m", inverse.times(n), out);
        break;
    }
  }

  // R(d), d > 0.
  InverseRange inverse(const std::string& name, const Reciprocal& unit, Range d) {
    const Range m = reg(name + " m", unit.output);
    InverseRange out{m, 0, 0};
    const Range n{d.lo - d.hi, 1};  // normalised at the largest e
    if (unit.normalize) {
      out.m = at_most(m, 1);
      out.e_min = d.lo;
      out.e_max = d.hi;
    }
    const Range nq{-unit.operand_bits, 1};
    switch (unit.kind) {
      case ReciprocalKind::restoring:
        q_quotient(name + " quotient * d", {0, 0}, unit.normalize ? n : d, unit.output.fraction());
        break;
      case ReciprocalKind::lut_linear: {
        const Range t{-std::max(unit.operand_bits - unit.index_bits, 0), 0};
        const Range entry{-unit.table_bits, 0};
        exact_pair(name + " c(j) - (c(j) - c(j+1)) t", sum(entry, product(entry, t)),
                   std::max(entry.bits(), t.bits()));
        break;
      }
      case ReciprocalKind::lut_quadratic: {
        const Range t{-std::max(unit.operand_bits - unit.index_bits, 0), 0};
        const Range entry{-unit.table_bits, 0};
        const Range g{-unit.internal_bits, 0};
        exact_pair(name + " c1 - c2 t", sum(entry, product(entry, t)), std::max(entry.bits(), t.bits()));
        exact_pair(name + " c0 - g t", sum(entry, product(g, t)),
                   std::max({entry.bits(), g.bits(), t.bits()}));
        break;
      }
      case ReciprocalKind::lut_newton: {
        Range y{-unit.table_bits, 0};
        const Range a{-unit.internal_bits, 1};
        for (int step = 0; step < unit.steps; ++step) {
          need(name + " nq y", product(nq, y).bits(), std::max(nq.bits(), y.bits()));
          need(name + " y (2 - a)", product(y, a).bits(), std::max(a.bits(), y.bits()));
          y = {-unit.internal_bits, 1};
        }
        break;
      }
    }
    return out;
  }

  // Ends the stage: the narrowest type that has its bits.
  Width choose(Width least = Width::f64) {
    Width width = least;
    while (significant_bits(width) < held_) width = width == Width::f64 ? Width::x87 : Width::quad;
    for (std::size_t i = first_; i < rows_.size(); ++i) rows_[i].width = width;
    return width;
  }

 private:
  std::string stage_;
  std::vector<PrecisionRow>& rows_;
  std::size_t first_;
  int held_ = 0;
};

class Chooser {
 public:
  explicit Chooser(const Config& config)
      : c_(config),
        k_(config.subpixel_bits),
        xy_(range_of(config.coordinate_format())),
        d_xy_{-k_, config.coordinate_bits},
        centre_{-std::max(k_, 1), config.coordinate_bits},
        b_(range_of(f(FormatId::setup_b))) {}

  Precision operator()() {
    constants();
    out_.setup = setup();
    if (has_plane_rows(c_.perspective)) {
      out_.plane_walk = plane_walk();
      out_.span_setup = plane_span_setup();
    } else {
      out_.edge_setup = edge_setup();
      if (by_plane()) out_.setup_plane = setup_plane();
      out_.edge_walk = edge_walk();
      out_.span_setup = by_plane() ? triangle_span_setup() : span_setup();
    }
    out_.span = span();
    out_.depth = depth();
    if (has_setup_gradients(c_)) out_.gradient = gradient();
    if (has_distance(c_)) out_.distance = distance();
    if (has_lod(c_)) out_.lod = lod();
    out_.texture = texture();
    if (has_project(c_.project)) out_.project = project();
    out_.texture_second = texture_second();
    if (has_light(c_.light)) out_.light = light();
    out_.fog = fog();
    out_.merge = merge();
    return out_;
  }

 private:
  const Format& f(FormatId id) const { return c_.format(id); }
  static std::string name(FormatId id) { return std::string(key_of(id)); }
  // What the lines of a triangle need: v needs what u does, the shades what red does.
  std::vector<Line> lines() const {
    std::vector<Line> out;
    for (const LineId id : {LineId::h, LineId::fu, LineId::r}) out.push_back(line_of(id, c_.perspective));
    for (const int channel : ChannelList(c_)) out.push_back(line_of(channel_line(channel), c_.perspective));
    return out;
  }
  // The line as it stands in an expression; w: fu or u.
  static std::string name(const Line& line, const std::string& w) {
    return line.product && !is_channel(line.id) ? w : std::string(line.name);
  }
  Range reg(StageNeeds& s, FormatId id) const { return s.reg(name(id), f(id)); }
  Range depth_sum(StageNeeds& s, Range h) const { return s.exact("h + B", sum(h, b_)); }
  Range exact_area(StageNeeds& s) const { return s.exact("area", {-2 * k_, 2 * c_.coordinate_bits + 1}); }
  // What a plane's gradient of w is divided from.
  Range numerator_of(StageNeeds& s, const std::string& w, Range values) const {
    const Range rise = sum(values, values);
    const Range cross = product(rise, d_xy_);
    return s.exact_pair("nx(" + w + ")", sum(cross, cross), std::max(rise.bits(), d_xy_.bits()));
  }
  // A plane's gradient of w, whose register is `out`; returns the range of its numerator.
  Range gradient_of(StageNeeds& s, const std::string& w, Range values, Range area, FormatId out) const {
    const Range n = numerator_of(s, w, values);
    s.q_quotient_of_pairs("nx(" + w + ") / area", n, area, f(out).fraction());
    return n;
  }
  bool by_plane() const { return has_setup_plane(c_); }

  static Term offset(const StartOffset& o, const Format& kept) {
    const auto value = start_offset<double>(o, kept);
    if (value == 0) return term({-kept.fraction(), -kept.fraction()});
    int hi = 0;
    double rest = std::frexp(std::fabs(value), &hi);
    int lo = hi;
    while (rest != 0) {
      rest *= 2;
      --lo;
      rest -= std::floor(rest);
    }
    return term({lo, hi});
  }

  Term offset(const LineWalk& walk) const {
    if (walk.offset == nullptr) return term({0, 0});
    return offset(c_.start_offset.*walk.offset, kept_of(walk));
  }
  Format kept_of(const LineWalk& walk) const {
    return walk.half_ulp_of ? f(*walk.half_ulp_of) : c_.depth_format();
  }
  // The start of a line on its walk from a value in `from`.
  void pre_step(StageNeeds& s, const std::string& expression, FormatId from, Range distance,
                const LineWalk& walk) {
    if (walk.offset == nullptr) {
      s.q_far(expression, term(range_of(f(walk.step)), distance), {term(range_of(f(from)))}, f(walk.acc),
              FarBound(f(walk.acc), {f(from)}));
      return;
    }
    pre_step(s, expression, range_of(f(from)), range_of(f(walk.step)), distance, c_.start_offset.*walk.offset,
             kept_of(walk), f(walk.acc), f(from));
  }
  void pre_step(StageNeeds& s, const std::string& expression, Range from, Range step, Range distance,
                const StartOffset& o, const Format& kept, const Format& accumulator,
                const Format& from_format) {
    const FarBound bound(accumulator, {from_format}, start_offset<double>(o, kept));
    s.q_far(expression, term(step, distance), {term(from), offset(o, kept)}, accumulator, bound);
  }

  void constants() {
    StageNeeds s("constants", out_.rows);
    const Range normal_s = at_most(reg(s, FormatId::setup_s), 0);
    const Range hmax{0, c_.depth_bits};
    const Range b = reg(s, FormatId::setup_b);
    s.q_quotient("hmax s_min / (s_max - s_min)", product(hmax, normal_s), normal_s,
                 f(FormatId::setup_b).fraction());
    if (is_linear_in_distance(c_.depth_code)) {
      reg(s, FormatId::depth_c1);
      reg(s, FormatId::depth_c0);
      s.q_quotient("hmax B s_max / (s_max - s_min)", product(hmax, product(b, normal_s)), normal_s,
                   f(FormatId::depth_c1).fraction());
      s.q_quotient("hmax s_min / (s_max - s_min) as c0", product(hmax, normal_s), normal_s,
                   f(FormatId::depth_c0).fraction());
    }
    if (is_linear_in_distance(c_.fog)) {
      // The quotient is in range times a distance of 53 significant bits.
      const Range scale = reg(s, FormatId::fog_scale);
      s.need("B s_max", product(b, normal_s).bits());
      s.need("fog.scale * distance", scale.bits() + 53);
    }
    s.choose(Width::quad);
  }

  Width setup() {
    StageNeeds s("setup", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const Range normal_s = at_most(reg(s, FormatId::setup_s), 0);
    for (const Line& line : lines()) {
      const Range vertex = reg(s, line.vertex);
      if (!is_channel(line.id) || !line.is_homogeneous()) continue;
      reg(s, *line.product);
      s.q_product("w (h + B)", term(vertex, depth_sum(s, range_of(f(FormatId::setup_h)))), f(*line.product));
    }
    const Range n = product(b_, normal_s);
    s.need("B (s_max - s)", n.bits(), std::max(b_.bits(), normal_s.bits()));
    s.q_quotient_of_pairs("B (s_max - s) / s", n, normal_s, f(FormatId::setup_h).fraction());
    exact_area(s);
    return s.choose();
  }

  Width edge_setup() {
    StageNeeds s("setup.edge", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const SlopeForm form = c_.edge_slope;
    InverseRange inverse;
    if (shares_reciprocal(form) && (!by_plane() || has_x_step(c_))) {
      inverse = s.inverse("R_edge", c_.edge_reciprocal, d_xy_);
    }
    if (has_x_step(c_)) {
      reg(s, FormatId::edge_x_step);
      s.slope("(x2 - x1)", d_xy_, d_xy_, form, inverse, f(FormatId::edge_x_step));
    }
    if (by_plane()) return s.choose();
    for (const Line& line : lines()) {
      const Range vertex = reg(s, walked_from(line));
      const std::string w = name(line, "u");
      const std::string rise = w + "2 - " + w + "1";
      const Range difference = s.exact(rise, sum(vertex, vertex));
      const Format& step = f(line.edge.step);
      reg(s, line.edge.step);
      if (!line.edge.difference) {
        s.slope("(" + rise + ")", difference, d_xy_, form, inverse, step);
        continue;
      }
      const Range scale = is_divided(line) ? depth_sum(s, range_of(f(FormatId::setup_h))) : Range{0, 0};
      s.q_product("(u2 - u1)(h2 + B)", term(difference, scale), f(*line.edge.difference));
      s.slope("fu_diff", reg(s, *line.edge.difference), d_xy_, form, inverse, step);
    }
    return s.choose();
  }

  Width setup_plane() {
    StageNeeds s("setup.plane", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const Range h = reg(s, FormatId::setup_h);
    const Range area = exact_area(s);
    const SlopeForm form = c_.edge_slope;
    InverseRange inverse;
    if (shares_reciprocal(form)) inverse = s.inverse("R_edge of the area", c_.edge_reciprocal, area);
    for (const Line& line : lines()) {
      Range values = reg(s, line.vertex);
      if (line.product && is_divided(line)) {
        const Range base = reg(s, FormatId::edge_uv);
        const Range from =
            has_pixel_reciprocal(c_.perspective) ? s.exact("u_i - u1", sum(values, base)) : values;
        s.q_product("(u_i - u1)(h_i + B)", term(from, depth_sum(s, h)), f(*line.product));
      }
      if (line.product) values = reg(s, *line.product);
      reg(s, line.gradient);
      const std::string w = name(line, "fu");
      s.exact("difference of " + w, sum(values, values));
      if (shares_reciprocal(form)) {
        s.slope("nx(" + w + ")", numerator_of(s, w, values), area, form, inverse, f(line.gradient));
      } else {
        gradient_of(s, w, values, area, line.gradient);
      }
    }
    return s.choose();
  }

  Width triangle_span_setup() {
    StageNeeds s("span_setup", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    reg(s, FormatId::edge_uv);
    for (const Line& line : lines()) {
      const Range g = reg(s, line.gradient);
      reg(s, line.row.step);
      reg(s, line.row.acc);
      const std::string w = name(line, "fu");
      s.q_sum(w + "0 + " + w + "_x X + " + w + "_y Y + offset",
              {term(reg(s, line.product.value_or(line.vertex))), term(g, centre_), term(g, centre_),
               offset(line.row)},
              f(line.row.acc));
      s.q_sum(w + "_step", {term(g)}, f(line.row.step));
    }
    return s.choose();
  }

  Width edge_walk() {
    StageNeeds s("edge_walk", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const Range t = centre_;
    reg(s, FormatId::edge_x);
    reg(s, FormatId::edge_x_acc);
    if (!has_x_step(c_)) {
      s.exact("(x2 - x1) t", product(d_xy_, t));
      const Range n{product(d_xy_, t).lo, xy_.hi + d_xy_.hi};
      s.floor_of_quotient("X as a pixel", n, d_xy_);
      s.q_quotient("X for edge.x", n, d_xy_, f(FormatId::edge_x).fraction());
    } else {
      const Range x_step = reg(s, FormatId::edge_x_step);
      const Format& acc = f(FormatId::edge_x_acc);
      pre_step(s, "x1 + x_step t + offset", xy_, x_step, t, c_.start_offset.edge_x, f(FormatId::edge_x), acc,
               c_.coordinate_format());
      s.q_sum("x_acc + x_step", {term(range_of(acc)), term(x_step)}, acc);
    }
    if (by_plane()) return s.choose();
    for (const Line& line : lines()) {
      const Range vertex = reg(s, walked_from(line));
      const Range step = reg(s, line.edge.step);
      const Range acc = reg(s, line.edge.acc);
      reg(s, line.edge.kept);
      const std::string w = name(line, "fu");
      const std::string from = is_divided(line) ? "" : w + "1 + ";
      pre_step(s, from + w + "_step t + offset", walked_from(line), t, line.edge);
      s.q_sum(w + " + " + w + "_step", {term(acc), term(step)}, f(line.edge.acc));
      if (!is_divided(line)) continue;
      const InverseRange inverse =
          s.inverse("R_pixel", c_.pixel_reciprocal, depth_sum(s, range_of(f(FormatId::edge_h))));
      s.q_far("u1 + fu m 2^-e", inverse.times(acc), {term(vertex)}, f(line.edge.kept),
              FarBound(f(line.edge.kept), {f(line.vertex)}));
    }
    return s.choose();
  }

  Width plane_walk() {
    StageNeeds s("plane_walk", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const Range h = reg(s, FormatId::setup_h);
    const Range k = at_most(reg(s, FormatId::plane_k), 0);
    const Range area = exact_area(s);
    const Range crossing =
        s.exact("distance of a centre from an edge", {-k_ - std::max(k_, 1), 2 * c_.coordinate_bits + 1});
    s.floor_of_quotient("crossing of an edge", crossing, d_xy_);
    const Range above = {s.exact("k (m - m0) + 1/2", sum(product(k, {0, c_.coordinate_bits}), {-1, -1})).lo,
                         0};
    for (const Line& line : lines()) {
      Range values = reg(s, walked_from(line));
      if (is_divided(line)) {
        s.q_product("u (h + B)", term(values, depth_sum(s, h)), f(*line.product));
        values = reg(s, *line.product);
      }
      // The numerators of u and v go along a row in the registers of a mode that divides per pixel.
      const FormatId start = is_divided(line) ? FormatId::span_f : line.row.acc;
      const FormatId step = is_divided(line) ? FormatId::span_f_step : line.row.step;
      const std::string w = name(line, "gu");
      const Range g = reg(s, line.gradient);
      reg(s, start);
      const Range n = gradient_of(s, w, values, area, line.gradient);
      if (line.id == LineId::h) {
        s.q_quotient_of_pairs("nx(h) / ny(h)", n, n, f(FormatId::plane_k).fraction());
      }
      if (line.id == LineId::h || (is_divided(line) && is_on_ideal_line(c_.numerator))) {
        s.q_sum(w + "0 + " + w + "_M (Mc - M0) + " + w + "_N (Nl - N0)",
                {term(values), term(g, centre_), term(g, centre_), term(g, above)}, f(start));
        if (line.id != LineId::h) s.q_sum(w + "_M + k " + w + "_N", {term(g), term(k, g)}, f(step));
      } else {
        const Term by = is_divided(line) ? term({0, 0}) : offset(line.row);
        s.q_sum(w + "0 + " + w + "_M (Mc - M0) + " + w + "_N (Np - N0) + offset",
                {term(values), term(g, centre_), term(g, centre_), by}, f(start));
        s.q_sum(w + "_M + sg " + w + "_N", {term(g), term(g)}, f(step));
      }
      if (line.id != LineId::h) reg(s, step);
    }
    return s.choose();
  }

  Width plane_span_setup() {
    StageNeeds s("span_setup", out_.rows);
    const Range h = reg(s, FormatId::span_h);
    const Range g = reg(s, FormatId::span_f);
    const Range g_step = reg(s, FormatId::span_f_step);
    reg(s, FormatId::span_uv_acc);
    reg(s, FormatId::span_uv_step);
    const InverseRange inverse = s.inverse("R_row", c_.row_reciprocal, depth_sum(s, h));
    const Format& acc = f(FormatId::span_uv_acc);
    const StartOffset& start = c_.start_offset.span_f;
    s.q_far("gu m 2^-e + offset", inverse.times(g), {offset(start, f(FormatId::span_uv))}, acc,
            FarBound(acc, {}, start_offset<double>(start, f(FormatId::span_uv))));
    s.q_product("gu_step m 2^-e", inverse.times(g_step), f(FormatId::span_uv_step));
    return s.choose();
  }

  Width span_setup() {
    StageNeeds s("span_setup", out_.rows);
    const Range x = reg(s, FormatId::edge_x);
    const Range h = reg(s, FormatId::edge_h);
    const Range length = s.exact("L", sum(x, x));
    const Range pre = s.exact("p", {std::min(x.lo, -1), std::max(xy_.hi, x.hi) + 1});
    const SlopeForm form = form_of(c_.row_slope);
    InverseRange inverse;
    if (shares_reciprocal(form)) inverse = s.inverse("R_row", c_.row_reciprocal, at_most(length, x.hi + 1));
    for (const Line& line : lines()) {
      const Range end = reg(s, line.edge.kept);
      reg(s, line.row.step);
      reg(s, line.row.acc);
      const std::string w = name(line, "u");
      const std::string rise = w + "_r - " + w + "_l";
      Range numerator = s.exact(rise, sum(end, end));
      FormatId from = line.edge.kept;
      if (line.row.difference) {
        const Range difference = reg(s, *line.row.difference);
        const bool hyperbolic = has_pixel_quotients(c_.perspective);
        s.q_product(hyperbolic ? "u_r (h_r + B)" : "(u_r - u_l)(h_r + B)",
                    term(hyperbolic ? end : numerator, depth_sum(s, h)), f(*line.row.difference));
        numerator = hyperbolic ? s.exact("gr - gl", sum(difference, difference)) : difference;
        if (hyperbolic) from = *line.row.difference;
      }
      s.slope(rise, numerator, length, form, inverse, f(line.row.step));
      pre_step(s, w + "_l + " + w + "_step p + offset", from, pre, line.row);
    }
    return s.choose();
  }

  Width span() {
    StageNeeds s("span", out_.rows);
    for (const Line& line : lines()) {
      const std::string w = name(line, "fu");
      const Range step = reg(s, line.row.step);
      s.q_sum(w + " + " + w + "_step", {term(reg(s, line.row.acc)), term(step)}, f(line.row.acc));
      reg(s, line.row.kept);
      if (line.span_divides) quotient(s, line);
    }
    const Range h = range_of(f(FormatId::span_h));
    const Range acc = range_of(f(line_of(LineId::fu, c_.perspective).row.acc));
    const Range edge_uv = reg(s, FormatId::edge_uv);
    switch (c_.perspective) {
      case Perspective::delta_f: {
        const InverseRange inverse = s.inverse("R_pixel", c_.pixel_reciprocal, depth_sum(s, h));
        s.q_far("u1 + fu m 2^-e", inverse.times(acc), {term(edge_uv)}, f(FormatId::span_uv),
                FarBound(f(FormatId::span_uv), {f(FormatId::edge_uv)}));
        break;
      }
      case Perspective::hyperbolic:
        s.q_quotient("fu / (h + B)", acc, depth_sum(s, h), f(FormatId::span_uv).fraction());
        break;
      case Perspective::const_depth_rows:
        s.exact("phase + k", sum(at_most(reg(s, FormatId::plane_k), 0), {-1, 0}));
        break;
      case Perspective::affine:
        break;
    }
    return s.choose();
  }

  // A channel over h + B.
  void quotient(StageNeeds& s, const Line& line) const {
    const Range acc = range_of(f(line.row.acc));
    const Range q = depth_sum(s, range_of(f(FormatId::span_h)));
    const std::string w(line.name);
    if (has_pixel_reciprocal(c_.perspective)) {
      s.q_product(w + " m 2^-e", s.inverse("R_pixel", c_.pixel_reciprocal, q).times(acc), f(line.row.kept));
    } else {
      s.q_quotient(w + " / (h + B)", acc, q, f(line.row.kept).fraction());
    }
  }

  Width depth() {
    StageNeeds s("depth", out_.rows);
    const Range h = reg(s, FormatId::span_h);
    s.reg("depth.z", c_.depth_format());
    switch (c_.depth_code) {
      case DepthCode::inverse:
        break;
      case DepthCode::opengl:
        s.q_sum("zmax - h", {term({0, c_.depth_bits}), term(h)}, c_.depth_format());
        break;
      case DepthCode::float_dz: {
        s.q_sum("zmax - h", {term({0, c_.depth_bits}), term(h)}, c_.depth_format());
        const Range gradient = reg(s, FormatId::plane_h_grad);
        s.exact("|h_x| + |h_y|", sum(gradient, gradient));
        break;
      }
      case DepthCode::linear: {
        const Range c1 = reg(s, FormatId::depth_c1);
        const Range c0 = reg(s, FormatId::depth_c0);
        const InverseRange inverse = s.inverse("R_pixel", c_.pixel_reciprocal, depth_sum(s, h));
        s.q_far("c1 m 2^-e - c0", inverse.times(c1), {term(c0)}, c_.depth_format(),
                FarBound(c_.depth_format(), {f(FormatId::depth_c0)}));
        break;
      }
      case DepthCode::w_float: {
        const Range q = depth_sum(s, h);
        s.exact("hmax + B", sum({0, c_.depth_bits}, b_));
        // Within its octave q keeps its bits; its last place moves with K.
        const Range place{c_.depth_bits - w_float_exponent_bits + 1 - q.bits(), c_.depth_bits + 1};
        s.exact("2^p (L + 2) - 2^p q 2^(L+1-K)", place);
        s.q_sum("2^p (L + 2) - 2^p q 2^(L+1-K)", {term({0, c_.depth_bits + 1}), term(place)},
                c_.depth_format());
        break;
      }
    }
    return s.choose();
  }

  Width gradient() {
    StageNeeds s("setup.gradient", out_.rows);
    s.reg("coordinate", c_.coordinate_format());
    const Range h = reg(s, FormatId::setup_h);
    const Range uv = reg(s, FormatId::setup_uv);
    const Range g = reg(s, FormatId::plane_g);
    reg(s, FormatId::plane_h_grad);
    reg(s, FormatId::plane_g_grad);
    s.q_product("u (h + B)", term(uv, depth_sum(s, h)), f(FormatId::plane_g));
    const Range area = exact_area(s);
    s.exact("difference of h", sum(h, h));
    gradient_of(s, "h", h, area, FormatId::plane_h_grad);
    s.exact("difference of gu", sum(g, g));
    gradient_of(s, "gu", g, area, FormatId::plane_g_grad);
    return s.choose();
  }

  // s of a stage.
  Range along_axis(StageNeeds& s) const {
    const Range a = reg(s, FormatId::distance_a);
    const Range normal_s = at_most(reg(s, FormatId::setup_s), 0);
    s.q_product("B s_max'", term(b_, normal_s), f(FormatId::distance_a));
    const InverseRange inverse =
        s.inverse("R_pixel", c_.pixel_reciprocal, depth_sum(s, reg(s, FormatId::span_h)));
    s.q_product("A' m 2^-e", inverse.times(a), f(FormatId::distance_s));
    return reg(s, FormatId::distance_s);
  }

  // The comparison by which a pixel has its zone. A picture's side is a coordinate.
  void zone(StageNeeds& s) const {
    switch (c_.fog_zone) {
      case FogZone::r2:
        s.exact("16 ((2x+1-W)^2 + (2y+1-H)^2)", {0, 2 * c_.coordinate_bits + 5});
        break;
      case FogZone::r:
        s.exact("4^j ((2x+1-W)^2 + (2y+1-H)^2)", {0, 2 * c_.coordinate_bits + 1 + 2 * c_.fog_zone_bits});
        break;
    }
  }

  Width distance() {
    StageNeeds s("distance", out_.rows);
    const Range along = along_axis(s);
    if (has_true_distance(c_)) {
      zone(s);
      reg(s, FormatId::distance_d);
      s.q_product("s G", term(along, reg(s, FormatId::distance_g)), f(FormatId::distance_d));
    }
    return s.choose();
  }

  Width lod() {
    StageNeeds s("lod", out_.rows);
    const Range share = reg(s, FormatId::lod_frac);
    reg(s, FormatId::lod_lambda);
    const Format& lambda = f(FormatId::lod_lambda);
    s.exact("lambda - level", {std::min(-lambda.fraction(), -1), std::max(lambda.integer, 5) + 1});
    Range x{0, 0};
    switch (c_.lod) {
      case LodMode::none:
        break;
      case LodMode::zone_s:
      case LodMode::zone_d: {
        const Range distance = takes_true_distance(c_.lod) ? reg(s, FormatId::distance_d) : along_axis(s);
        const Range k = reg(s, FormatId::lod_k);
        s.q_quotient("1 / S_i", {0, 0}, {-16, max_mip_level}, f(FormatId::lod_k).fraction());
        const Range beyond = s.exact("s - S_z", sum(distance, {-16, max_mip_level}));
        s.q_product("(s - S_z) k_z", term(beyond, k), f(FormatId::lod_frac));
        x = s.exact("z + f", {std::min(share.lo, 0), 5});
        break;
      }
      case LodMode::gradient:
      case LodMode::finite: {
        const Range h_grad = reg(s, FormatId::plane_h_grad);
        const Range g_grad = reg(s, FormatId::plane_g_grad);
        const Range uv = reg(s, FormatId::span_uv);
        const Format& slope = f(FormatId::lod_slope);
        reg(s, FormatId::lod_slope);
        const Range own = depth_sum(s, reg(s, FormatId::span_h));
        const Range next = has_neighbours(c_.lod) ? s.exact("h + B + h_x", sum(own, h_grad)) : own;
        const InverseRange inverse = s.inverse("R_pixel", c_.pixel_reciprocal, next);
        const Range n = s.exact("gu_x - u h_x", sum(g_grad, product(uv, h_grad)));
        s.q_product("(gu_x - u h_x) m 2^-e", inverse.times(n), slope);
        x = s.exact("E + (rho 2^-E - 1)", {-slope.word, 7});
        break;
      }
    }
    s.q_sum("x + bias", {term(x), term({-4, 5})}, lambda);
    return s.choose();
  }

  // What a texture unit finds: V and its alpha.
  void texel(StageNeeds& s) const {
    const Range uv = reg(s, FormatId::span_uv);
    const Range mix = reg(s, FormatId::texture_mix);
    const Range alpha = reg(s, FormatId::texture_alpha);
    const Range code{0, 8};
    s.q_quotient("a / 255", code, code, f(FormatId::texture_alpha).fraction());
    s.exact("u - 1/2", sum({has_lod(c_) ? uv.lo - max_mip_level : uv.lo, uv.hi}, {-1, -1}));
    if (weighs_texels(c_.filter)) {
      const Range frac = reg(s, FormatId::texture_frac);
      const Range rest = s.exact("1 - Ex", sum(frac, {0, 0}));
      const Range widest_v{std::min(mix.lo, 0), std::max(mix.hi, 8)};
      s.q_sum("V1 (1-Ex) + V4 Ex", {term(product(widest_v, rest)), term(product(widest_v, frac))},
              f(FormatId::texture_mix));
      s.q_sum("alpha1 (1-Ex) + alpha4 Ex", {term(product(alpha, rest)), term(product(alpha, frac))},
              f(FormatId::texture_alpha));
    }
    if (mixes_levels(c_.mip)) {
      const Range level = reg(s, FormatId::lod_frac);
      const Range rest = s.exact("1 - f", sum(level, {0, 0}));
      s.q_sum("V_l (1-f) + V_l+1 f",
              {term(s.exact("V_l (1-f)", product(mix, rest))), term(s.exact("V_l+1 f", product(mix, level)))},
              f(FormatId::texture_mix));
      s.q_sum("alpha_l (1-f) + alpha_l+1 f",
              {term(s.exact("alpha_l (1-f)", product(alpha, rest))),
               term(s.exact("alpha_l+1 f", product(alpha, level)))},
              f(FormatId::texture_alpha));
    }
  }

  Width texture() {
    StageNeeds s("texture", out_.rows);
    const Range shade = reg(s, shade_factor(c_));
    reg(s, FormatId::texture_color);
    texel(s);
    s.exact("V * shade", product(range_of(f(FormatId::texture_mix)), shade));
    s.exact("alpha * shade", product(range_of(f(FormatId::texture_alpha)), shade));
    return s.choose();
  }

  Width project() {
    StageNeeds s("project", out_.rows);
    const Range w = reg(s, FormatId::project_value);
    const InverseRange inverse = s.inverse("R_pixel of W", c_.pixel_reciprocal, w);
    reg(s, FormatId::span_uv);
    s.q_product("X m 2^-e", inverse.times(w), f(FormatId::span_uv));
    const Range ratio = reg(s, FormatId::project_ratio);
    s.q_product("(h + B) m 2^-e", inverse.times(depth_sum(s, reg(s, FormatId::span_h))),
                f(FormatId::project_ratio));
    const Range a = reg(s, FormatId::distance_a);
    s.q_product("B_p s_max'", term(b_, at_most(reg(s, FormatId::setup_s), 0)), f(FormatId::distance_a));
    const Range h = reg(s, FormatId::project_h);
    s.q_far("A_p ratio - B_p", term(a, ratio), {term(b_)}, f(FormatId::project_h),
            FarBound(f(FormatId::project_h), {f(FormatId::setup_b)}));
    s.reg("depth.z", c_.depth_format());
    if (is_complement_of_h(c_.depth_code)) {
      s.q_sum("zmax - h_p", {term({0, c_.depth_bits}), term(h)}, c_.depth_format());
    }
    return s.choose();
  }

  Width texture_second() {
    StageNeeds s("texture.second", out_.rows);
    texel(s);
    const Range mix = range_of(f(FormatId::texture_mix));
    const Range alpha = range_of(f(FormatId::texture_alpha));
    const Range color = reg(s, FormatId::texture_color);
    const Range code{0, 8};
    if (has_lod(c_)) {
      reg(s, FormatId::lod_frac);
      const Range lambda = reg(s, FormatId::lod_lambda);
      s.exact("lambda - level", {std::min(lambda.lo, -1), std::max(lambda.hi, 5) + 1});
      s.q_sum("lambda + bias", {term(lambda), term({-4, 2})}, f(FormatId::lod_lambda));
    }
    s.q_quotient("V / 255", mix, code, f(FormatId::texture_alpha).fraction());
    s.exact("alpha alpha", product(alpha, alpha));
    const Range scaled = s.exact("C F 2^scale", product(color, {alpha.lo, alpha.hi + 2}));
    const Range both = s.exact("C + V", sum(color, mix));
    s.q_sum("min(255, C F 2^scale)", {term({std::min(scaled.lo, 0), std::max(scaled.hi, 8)})},
            f(FormatId::texture_color));
    s.q_sum("min(255, C + V)", {term({std::min(both.lo, 0), std::max(both.hi, 8)})},
            f(FormatId::texture_color));
    const Range rest = s.exact("1 - alpha", sum(alpha, {0, 0}));
    s.q_sum(
        "C (1 - alpha) + V alpha",
        {term(s.exact("C (1 - alpha)", product(color, rest))), term(s.exact("V alpha", product(mix, alpha)))},
        f(FormatId::texture_color));
    s.q_sum("C (1 - F) + CC F", {term(product(color, rest)), term(s.exact("CC F", product(code, alpha)))},
            f(FormatId::texture_color));
    return s.choose();
  }

  // X / |X| by the reciprocal square root.
  void unit_vector(StageNeeds& s, const std::string& x, Range of, FormatId into) const {
    const RootUnit& root = c_.light_root;
    const Range square = product(of, of);
    const Range d = s.exact(x + "." + x, sum(sum(square, square), square));
    const Range n = s.exact("n", {-root.operand_bits, 2});
    Range y{-root.table_bits, 1};
    const Range inside{-root.internal_bits, 3};
    for (int step = 0; step < root.steps; ++step) {
      s.exact("n y", product(n, y));
      s.exact("n y y", product(inside, y));
      s.exact("y (3 - n y y)", product(y, inside));
      y = {-root.internal_bits, 1};
    }
    const Range m = reg(s, FormatId::light_root);
    reg(s, into);
    // 4^e <= d
    const InverseRange inverse{m, (d.lo - 1) / 2, d.hi / 2 + 1};
    s.q_product(x + " m 2^-e", inverse.times(of), f(into));
  }

  Width light() {
    StageNeeds s("light", out_.rows);
    const Range color = reg(s, FormatId::texture_color);
    const Range value = reg(s, FormatId::light_value);
    const Range specular = reg(s, FormatId::light_specular);
    const Range cosine = reg(s, FormatId::light_cosine);
    const Range normal = range_of(f(FormatId::light_normal));
    const Range direction = range_of(f(FormatId::light_direction));
    const Range place = reg(s, FormatId::light_position);
    reg(s, FormatId::light_direction);
    unit_vector(s, "N", reg(s, FormatId::normal_value), FormatId::light_normal);
    if (has_light_points(c_)) {
      // The focal length moves the point alone.
      const Range along = reg(s, FormatId::distance_s);
      const Range scale = reg(s, FormatId::light_scale);
      const Range across = s.exact("x s", product(centre_, along));
      s.exact("x s k", product(across, scale));
      unit_vector(s, "L", s.exact("Lp - P", sum(place, place)), FormatId::light_direction);
    }
    if (has_relief(c_)) {
      const Range mix = range_of(f(FormatId::texture_mix));
      unit_vector(s, "2 V - 255", sum({mix.lo + 1, mix.hi + 1}, {0, 8}), FormatId::light_normal);
      const Range relief = range_of(f(FormatId::relief_value));
      unit_vector(s, "Lp - uv", sum(relief, range_of(f(FormatId::span_uv))), FormatId::light_direction);
    }
    const Range both = product(normal, direction);
    s.exact("N.L", sum(sum(both, both), both));
    const Range turned = product({cosine.lo + 1, cosine.hi + 1}, normal);
    s.exact("Lz - 2 c Nz", sum(direction, turned));
    if (has_lunar(c_) || has_light_fall(c_)) {
      const Range m = range_of(f(FormatId::light_root));
      s.exact("m m", product(m, m));
      reg(s, FormatId::light_inverse);
    }
    // x Inv 2^-2e, 4^e <= T.
    const auto divided = [&](const std::string& text, Range x, FormatId t) {
      const Range by = range_of(f(t));
      s.exact(text, product(product(x, range_of(f(FormatId::light_inverse))), {-(by.hi + 1), 1 - by.lo}));
    };
    if (has_lunar(c_)) {
      const Range lunar = reg(s, FormatId::light_lunar);
      s.exact("1 + k Nz", sum({0, 0}, product(lunar, normal)));
      divided("c Inv", cosine, FormatId::light_lunar);
    }
    if (has_light_fall(c_)) {
      const Range distance = reg(s, FormatId::light_distance);
      const Range fall = reg(s, FormatId::light_fall);
      const Range part = product(sum(place, place), direction);
      s.exact("D.Unit(D)", sum(sum(part, part), part));
      s.exact("d w", product(place, product(reg(s, FormatId::light_scale),
                                            {-reach_octaves - 1, reach_octaves + 1})));
      s.exact("d d + K", sum(product(distance, distance), distance));
      divided("Inv", {0, 0}, FormatId::light_distance);
      s.exact("f U + ka", sum(product(fall, value), value));
    }
    if (has_light_shadow(c_)) {
      s.q_quotient("V / 255", range_of(f(FormatId::texture_mix)), {0, 8},
                   f(FormatId::texture_alpha).fraction());
      s.q_product("U share", term(value, reg(s, FormatId::texture_alpha)), f(FormatId::light_value));
    }
    const Range share{std::min(cosine.lo + c_.light_index_bits, 0), c_.light_index_bits + 1};
    s.exact("g 2^n", share);
    const Range rise = s.exact("t_j+1 - t_j", sum(specular, specular));
    s.exact("t_j + (t_j+1 - t_j) x", sum(specular, product(rise, {share.lo, 0})));
    s.exact("kd c + ks spec + ka", sum(sum(value, product(value, cosine)), product(value, specular)));
    s.q_product("r V", term(color, value), f(FormatId::texture_color));
    return s.choose();
  }

  Width fog() {
    StageNeeds s("fog", out_.rows);
    const Range color = reg(s, FormatId::texture_color);
    const Range factor = reg(s, FormatId::fog_factor);
    reg(s, FormatId::fog_color);
    const Range code{0, 8};
    s.q_sum("VT + (r - VT) factor", {term(code), term(product(s.exact("r - VT", sum(color, code)), factor))},
            f(FormatId::fog_color));
    if (!has_fog(c_.fog)) return s.choose();
    const Range h = reg(s, FormatId::span_h);
    switch (c_.fog) {
      case FogMode::none:
      case FogMode::vertex:
        break;
      case FogMode::linear: {
        const Range scale = reg(s, FormatId::fog_scale);
        const InverseRange inverse = s.inverse("R_pixel", c_.pixel_reciprocal, depth_sum(s, h));
        s.q_far("1 - fog_scale m 2^-e", inverse.times(scale), {term({0, 0})}, f(FormatId::fog_factor),
                FarBound(f(FormatId::fog_factor), {}, 1.0));
        break;
      }
      case FogMode::table:
        zone(s);
        break;
      case FogMode::distance:
        reg(s, FormatId::distance_d);
        break;
      case FogMode::log: {
        reg(s, FormatId::distance_s);
        const Format& along = f(FormatId::distance_s);
        s.exact("Lg(s) + 16", {1 - along.word, 8});
        const Range place = s.exact("(Lg(s) + 16) 2^(n-4)",
                                    {std::min(0, c_.fog_depth_bits - 3 - along.word), c_.fog_depth_bits + 1});
        const Range rise = s.exact("f_i+1 - f_i", sum(factor, factor));
        s.q_sum("f_i + (f_i+1 - f_i) t", {term(factor), term(rise, place)}, f(FormatId::fog_factor));
        break;
      }
    }
    return s.choose();
  }

  Width merge() {
    StageNeeds s("merge", out_.rows);
    const Range color = reg(s, FormatId::fog_color);
    const Range alpha = reg(s, FormatId::texture_alpha);
    const Range code{0, 8};
    reg(s, FormatId::merge_color);
    s.q_sum("dst + (r - dst) a", {term(code), term(product(s.exact("r - dst", sum(color, code)), alpha))},
            f(FormatId::merge_color));
    return s.choose();
  }

  const Config& c_;
  int k_;
  Range xy_;      // a snapped coordinate
  Range d_xy_;    // a difference of two
  Range centre_;  // a pixel centre less a coordinate
  Range b_;
  Precision out_;
};

}  // namespace

Precision choose_precision(const Config& config) { return Chooser(config)(); }

}  // namespace bitspan::golden
