// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/reference.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "config/lines.hpp"
#include "tests/support/reciprocal_definition.hpp"

namespace bitspan::reference {
namespace {

Rational half() { return Rational(1, 2); }

Rational ulp(const Format& f) { return power_of_two(-f.fraction()); }

// Nearest integer with ties as the mode says; the tie's two candidates are floor and floor + 1.
Integer round(const Rational& x, Rounding mode) {
  const Integer low = floor(x);
  const Rational fraction = x - low;
  if (mode == Rounding::trn) return low;
  if (mode == Rounding::trn_zero) return x < 0 && fraction != 0 ? Integer(low + 1) : low;
  if (fraction < half()) return low;
  if (fraction > half()) return low + 1;
  switch (mode) {
    case Rounding::rnd:
      return low + 1;
    case Rounding::rnd_zero:
      return x < 0 ? Integer(low + 1) : low;
    case Rounding::rnd_min_inf:
      return low;
    case Rounding::rnd_inf:
      return x < 0 ? low : Integer(low + 1);
    default:  // rnd_conv
      return low % 2 == 0 ? low : Integer(low + 1);
  }
}

// The kept low bits of a two's complement integer.
Integer low_bits(const Integer& x, int bits) {
  const Integer modulus = Integer(1) << bits;
  const Integer r = x % modulus;
  return r < 0 ? Integer(r + modulus) : r;
}

Integer as_signed(const Integer& bits, const Format& f) {
  return f.is_signed && bits >= (Integer(1) << (f.word - 1)) ? Integer(bits - (Integer(1) << f.word)) : bits;
}

Integer overflow(const Integer& x, const Format& f) {
  const Integer highest = (Integer(1) << (f.is_signed ? f.word - 1 : f.word)) - 1;
  const Integer lowest = f.is_signed ? Integer(-highest - 1) : Integer(0);
  const bool symmetric = f.overflow == Overflow::sat_sym && f.is_signed;
  if (x >= (symmetric ? Integer(-highest) : lowest) && x <= highest) return x;
  switch (f.overflow) {
    case Overflow::wrap:
      return as_signed(low_bits(x, f.word), f);
    case Overflow::sat:
      return x < 0 ? lowest : highest;
    case Overflow::sat_zero:
      return 0;
    case Overflow::sat_sym:
      return x < 0 ? (symmetric ? Integer(-highest) : lowest) : highest;
    case Overflow::wrap_sm:
      break;
  }
  // The bit above the kept ones becomes the sign; where it differs from the old sign the others are inverted.
  const Integer wide = low_bits(x, f.word + 1);
  const bool above = boost::multiprecision::bit_test(wide, static_cast<unsigned>(f.word));
  const bool sign = boost::multiprecision::bit_test(wide, static_cast<unsigned>(f.word - 1));
  Integer rest = low_bits(wide, f.word - 1);
  if (above != sign) rest = (Integer(1) << (f.word - 1)) - 1 - rest;
  return rest - (above ? Integer(Integer(1) << (f.word - 1)) : Integer(0));
}

Rational offset(const StartOffset& o, const Rational& kept_ulp) {
  return o.half_ulp ? Rational(kept_ulp / 2) : Rational(o.value);
}

Rational scaled(const MantissaExponent& r, const Reciprocal& unit) {
  return value(r.m, unit.output) * power_of_two(-r.e);
}

Rational sum_ulp(const Config& c, FormatId h) {
  return std::min(ulp(c.format(h)), ulp(c.format(FormatId::setup_b)));
}

}  // namespace

Rational power_of_two(int exponent) {
  const Integer p = Integer(1) << std::abs(exponent);
  return exponent >= 0 ? Rational(p) : Rational(1, p);
}

Integer floor(const Rational& x) {
  const Integer n = numerator(x);
  const Integer d = denominator(x);
  Integer q = n / d;
  if (n % d != 0 && n < 0) --q;
  return q;
}

Rational value(std::int64_t raw, const Format& format) { return Rational(raw) * ulp(format); }

std::int64_t quantize(const Rational& x, const Format& format) {
  return static_cast<std::int64_t>(overflow(round(x / ulp(format), format.rounding), format));
}

MantissaExponent reciprocal(const Rational& d_in, const Rational& ulp, const Reciprocal& unit) {
  const Rational d = d_in <= 0 ? ulp : d_in;
  const ReciprocalByDefinition r = reciprocal_by_definition(unit, d);
  return {quantize(r.value, unit.output), r.e};
}

SpanRecord span_setup(const Config& c, const RowRecord& row, std::int64_t b) {
  const auto real = [&](std::int64_t raw, FormatId id) { return value(raw, c.format(id)); };
  const auto q = [&](const Rational& x, FormatId id) { return quantize(x, c.format(id)); };
  SpanRecord s;
  s.x = row.x_first;
  s.count = row.x_last - row.x_first + 1;
  const Rational length = real(row.r_x, FormatId::edge_x) - real(row.l_x, FormatId::edge_x);
  const Rational p = row.x_first + half() - real(row.l_x, FormatId::edge_x);
  const Rational h_l = real(row.l_h, FormatId::edge_h);
  const Rational h_r = real(row.r_h, FormatId::edge_h);
  const Rational q_l = h_l + real(b, FormatId::setup_b);
  const Rational q_r = h_r + real(b, FormatId::setup_b);
  Rational inverse = 0;  // of a row without length: every slope is 0
  if (length > 0) {
    inverse = 1 / length;
    if (c.row_slope == RowSlope::reciprocal) {
      const MantissaExponent r = reciprocal(length, ulp(c.format(FormatId::edge_x)), c.row_reciprocal);
      s.recip_m = r.m;
      s.recip_e = r.e;
      inverse = scaled(r, c.row_reciprocal);
    }
  }
  // A slope is 0 exactly where the row has no length, whatever its format makes of 0.
  const auto slope = [&](const Rational& difference, FormatId id) {
    return length > 0 ? q(difference * inverse, id) : 0;
  };
  s.h_step = slope(h_r - h_l, FormatId::span_h_step);
  s.h =
      q(h_l + real(s.h_step, FormatId::span_h_step) * p + offset(c.start_offset.span_h, 1), FormatId::span_h);
  const bool affine = c.perspective == Perspective::affine;
  const FormatId step = affine ? FormatId::span_uv_step : FormatId::span_f_step;
  const FormatId acc = affine ? FormatId::span_uv_acc : FormatId::span_f;
  const Rational f_offset =
      offset(c.start_offset.span_f, ulp(c.format(affine ? FormatId::span_uv : FormatId::span_f)));
  const auto texture = [&](std::int64_t raw_l, std::int64_t raw_r, std::int64_t& diff, std::int64_t& base,
                           std::int64_t& f_step, std::int64_t& f) {
    const Rational l = real(raw_l, FormatId::edge_uv);
    const Rational r = real(raw_r, FormatId::edge_uv);
    Rational numerator = r - l;
    Rational left = l;
    if (c.perspective == Perspective::delta_f) {
      diff = q((r - l) * q_r, FormatId::span_f_diff);
      base = raw_l;
      numerator = real(diff, FormatId::span_f_diff);
      left = 0;
    } else if (c.perspective == Perspective::hyperbolic) {
      diff = q(r * q_r, FormatId::span_f_diff);
      left = real(q(l * q_l, FormatId::span_f_diff), FormatId::span_f_diff);
      numerator = real(diff, FormatId::span_f_diff) - left;
    }
    f_step = slope(numerator, step);
    f = q(left + real(f_step, step) * p + f_offset, acc);
  };
  texture(row.l_u, row.r_u, s.fu_diff, s.u1, s.fu_step0, s.fu);
  texture(row.l_v, row.r_v, s.fv_diff, s.v1, s.fv_step0, s.fv);
  s.fu_step1 = s.fu_step0;
  s.fv_step1 = s.fv_step0;
  if (!c.rtl.shades) return s;
  const Rational shade_offset = offset(c.start_offset.span_shade, ulp(c.format(FormatId::span_shade)));
  const auto shade = [&](std::int64_t raw_l, std::int64_t raw_r, std::int64_t& step0, std::int64_t& step1,
                         std::int64_t& start) {
    const Rational l = real(raw_l, FormatId::edge_shade);
    step0 = step1 = slope(real(raw_r, FormatId::edge_shade) - l, FormatId::span_shade_step);
    start = q(l + real(step0, FormatId::span_shade_step) * p + shade_offset, FormatId::span_shade_acc);
  };
  shade(row.l_r, row.r_r, s.r_step0, s.r_step1, s.r);
  shade(row.l_g, row.r_g, s.g_step0, s.g_step1, s.g);
  shade(row.l_b, row.r_b, s.b_step0, s.b_step1, s.b);
  shade(row.l_a, row.r_a, s.a_step0, s.a_step1, s.a);
  return s;
}

SpanRecord span_setup(const Config& c, const PlaneRowRecord& row, std::int64_t b) {
  const auto q = [&](const Rational& x, FormatId id) { return quantize(x, c.format(id)); };
  SpanRecord s;
  s.x = row.major_first;
  s.count = row.count;
  s.phase = row.phase;
  s.h = row.h;
  const Rational d = value(row.h, c.format(FormatId::span_h)) + value(b, c.format(FormatId::setup_b));
  const MantissaExponent r = reciprocal(d, sum_ulp(c, FormatId::span_h), c.row_reciprocal);
  s.recip_m = r.m;
  s.recip_e = r.e;
  const Rational inverse = scaled(r, c.row_reciprocal);
  const Rational f_offset = offset(c.start_offset.span_f, ulp(c.format(FormatId::span_uv)));
  const auto start = [&](std::int64_t g) {
    return q(value(g, c.format(FormatId::span_f)) * inverse + f_offset, FormatId::span_uv_acc);
  };
  const auto step = [&](std::int64_t g) {
    return q(value(g, c.format(FormatId::span_f_step)) * inverse, FormatId::span_uv_step);
  };
  s.fu = start(row.gu);
  s.fv = start(row.gv);
  s.fu_step0 = step(row.gu_step0);
  s.fu_step1 = step(row.gu_step1);
  s.fv_step0 = step(row.gv_step0);
  s.fv_step1 = step(row.gv_step1);
  if (!c.rtl.shades) return s;
  s.r = row.r;
  s.g = row.g;
  s.b = row.b;
  s.a = row.a;
  s.r_step0 = row.r_step0;
  s.g_step0 = row.g_step0;
  s.b_step0 = row.b_step0;
  s.a_step0 = row.a_step0;
  s.r_step1 = row.r_step1;
  s.g_step1 = row.g_step1;
  s.b_step1 = row.b_step1;
  s.a_step1 = row.a_step1;
  return s;
}

SpanChannelRecord span_setup(const Config& c, const RowRecord& row, const SpanRecord& span,
                             const RowChannelRecord& ends) {
  const Line line = line_of(channel_line(ends.channel), c.perspective);
  const Format& end = c.format(line.edge.kept);
  const Format& step = c.format(line.row.step);
  const Format& x = c.format(FormatId::edge_x);
  const Rational length = value(row.r_x, x) - value(row.l_x, x);
  SpanChannelRecord r{.x = span.x, .channel = ends.channel};
  if (length > 0) {
    const Rational inverse = c.row_slope == RowSlope::reciprocal
                                 ? scaled({span.recip_m, static_cast<int>(span.recip_e)}, c.row_reciprocal)
                                 : Rational(1 / length);
    r.w_step0 = r.w_step1 = quantize((value(ends.r, end) - value(ends.l, end)) * inverse, step);
  }
  const Rational p = row.x_first + half() - value(row.l_x, x);
  Rational start = value(ends.l, end) + value(r.w_step0, step) * p;
  if (line.row.offset != nullptr) {
    const Rational kept_ulp = line.row.half_ulp_of ? ulp(c.format(*line.row.half_ulp_of)) : Rational(1);
    start += offset(c.start_offset.*line.row.offset, kept_ulp);
  }
  r.w = quantize(start, c.format(line.row.acc));
  return r;
}

std::vector<Pixel> span(const Config& c, const SpanRecord& s, std::int64_t k_raw, std::int64_t b) {
  const bool rows = c.perspective == Perspective::const_depth_rows;
  const bool linear = rows || c.perspective == Perspective::affine;
  const Format acc = c.format(linear ? FormatId::span_uv_acc : FormatId::span_f);
  const Format step_format = c.format(linear ? FormatId::span_uv_step : FormatId::span_f_step);
  const Format shade_acc = c.format(FormatId::span_shade_acc);
  const Format shade_step = c.format(FormatId::span_shade_step);
  std::array shades{s.r, s.g, s.b, s.a};
  const std::array shade_step0{s.r_step0, s.g_step0, s.b_step0, s.a_step0};
  const std::array shade_step1{s.r_step1, s.g_step1, s.b_step1, s.a_step1};
  const Format& h_format = c.format(FormatId::span_h);
  const Rational k = value(k_raw, c.format(FormatId::plane_k));
  const int phase_bits = c.format(FormatId::plane_k).fraction();
  Rational phase = Rational(s.phase) * power_of_two(-phase_bits);
  std::int64_t h = s.h;
  std::int64_t fu = s.fu;
  std::int64_t fv = s.fv;
  std::vector<Pixel> pixels;
  for (std::int64_t i = 0; i < s.count; ++i) {
    Pixel pixel;
    FragmentRecord& f = pixel.fragment;
    f.x = s.x + i;
    f.last = i + 1 == s.count ? 1 : 0;
    f.h = h;
    f.fu = fu;
    f.fv = fv;
    Rational u = value(fu, acc);
    Rational v = value(fv, acc);
    const Rational d = value(h, h_format) + value(b, c.format(FormatId::setup_b));
    if (c.perspective == Perspective::hyperbolic) {
      const Rational divisor = d > 0 ? d : sum_ulp(c, FormatId::span_h);
      u /= divisor;
      v /= divisor;
    } else if (!linear) {
      const MantissaExponent r = reciprocal(d, sum_ulp(c, FormatId::span_h), c.pixel_reciprocal);
      f.recip_m = r.m;
      f.recip_e = r.e;
      u = value(s.u1, c.format(FormatId::edge_uv)) + u * scaled(r, c.pixel_reciprocal);
      v = value(s.v1, c.format(FormatId::edge_uv)) + v * scaled(r, c.pixel_reciprocal);
    }
    f.u = quantize(u, c.format(FormatId::span_uv));
    f.v = quantize(v, c.format(FormatId::span_uv));
    if (rows) {
      phase += k;
      pixel.step = k >= 0 ? phase >= 1 : phase < 0;
      if (pixel.step) phase += k >= 0 ? -1 : 1;
    }
    if (c.rtl.shades) {
      std::array<std::int64_t, 4> narrowed{};
      for (std::size_t k = 0; k < 4; ++k) {
        narrowed[k] = quantize(value(shades[k], shade_acc), c.format(FormatId::span_shade));
        const std::int64_t by = pixel.step ? shade_step1[k] : shade_step0[k];
        shades[k] = quantize(value(shades[k], shade_acc) + value(by, shade_step), shade_acc);
      }
      std::tie(f.r, f.g, f.b, f.a) = std::tuple_cat(narrowed);
    }
    pixels.push_back(pixel);
    h = quantize(value(h, h_format) + value(s.h_step, c.format(FormatId::span_h_step)), h_format);
    fu = quantize(value(fu, acc) + value(pixel.step ? s.fu_step1 : s.fu_step0, step_format), acc);
    fv = quantize(value(fv, acc) + value(pixel.step ? s.fv_step1 : s.fv_step0, step_format), acc);
  }
  return pixels;
}

std::vector<FragmentChannelRecord> span(const Config& c, const SpanChannelRecord& record,
                                        std::span<const Pixel> pixels) {
  const Line line = line_of(channel_line(record.channel), c.perspective);
  const Format& acc = c.format(line.row.acc);
  const Format& step = c.format(line.row.step);
  std::vector<FragmentChannelRecord> values;
  std::int64_t w = record.w;
  for (const Pixel& pixel : pixels) {
    Rational kept = value(w, acc);
    if (line.span_divides) {
      kept *= scaled({pixel.fragment.recip_m, static_cast<int>(pixel.fragment.recip_e)}, c.pixel_reciprocal);
    }
    values.push_back(
        {.x = pixel.fragment.x, .channel = record.channel, .w = quantize(kept, c.format(line.row.kept))});
    w = quantize(value(w, acc) + value(pixel.step ? record.w_step1 : record.w_step0, step), acc);
  }
  return values;
}

}  // namespace bitspan::reference
