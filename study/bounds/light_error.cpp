// SPDX-License-Identifier: Apache-2.0
#include "study/bounds/light_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "config/modes.hpp"
#include "study/bounds/format_range.hpp"
#include "study/bounds/root_error.hpp"

namespace bitspan::bounds {
namespace {

using F = FormatId;

constexpr std::string_view normal_line = "the normal's channels";
constexpr std::string_view surface_place = "the place on the surface";

// The smallest e with x <= 2^e; x above 0.
int octaves(double x) {
  int e = 0;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;
}

Interval clamped(Interval x, double low, double high) {
  return {std::clamp(x.lo, low, high), std::clamp(x.hi, low, high)};
}

Interval length_of(const Vector& x) { return root_of(square(x[0]) + square(x[1]) + square(x[2])); }

Interval product(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// x is not below 0.
Interval power_of(Interval x, int n) {
  Interval out = 1;
  for (; n > 0; n /= 2) {
    if (n % 2 != 0) out = out * x;
    x = square(x);
  }
  return {std::max(0.0, out.lo), out.hi};
}

// What a divisor's register gains where it is 0, which stands for its last place.
Interval raised_from_0(Interval held, const Format& f) {
  return {0, std::max(0.0, (Interval(ulp(f)) - held.lo).hi)};
}

// Replaces a sum by one term where that says more.
void narrow(ErrorSum& e, std::string_view source, Interval other) {
  if (other.mag() < e.total().mag()) e.replace(source, other);
}

}  // namespace

LightError::LightError(const Config& config, const LitView& view)
    : c_(config), view_(view), root_(root_error(config)), exponent_(octaves(view.s_max)) {
  const Light& light = view.light;
  falls_ = light.reach > 0 && (light.is_point || falls_to_viewer(config.light_fall_to));
  int down = exponent_;
  if (!light.is_point) {
    double largest = 0;
    for (const double x : light.place) largest = std::max(largest, std::fabs(x));
    down = octaves(largest);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    place_[i] = std::ldexp(light.place[i], -down);
    place_error_[i] = held(place_[i], F::light_position) - place_[i];
  }
  // 1 / x as a register and a power of two hold it.
  const auto inverse = [&](double x) {
    const Interval whole = std::ldexp(1.0, octaves(x));
    return held(whole / x, F::light_scale) / whole;
  };
  if (light.is_point || falls_) {
    exact_scale_ = Interval(1) / view.focal;
    scale_ = inverse(view.focal);
  }
  if (falls_) {
    const Interval whole = std::ldexp(1.0, exponent_);
    exact_per_reach_ = whole / light.reach;
    per_reach_ = inverse(light.reach) * whole;
  }
  ambient_ = held(light.ambient, F::light_value);
  highlight_ = held(light.specular, F::light_value);
  diffuse_ = held(1 - ambient_ - highlight_, F::light_value);
  exact_diffuse_ = Interval(1) - light.ambient - light.specular;
  if (!light.is_point) far_ = unit_of(place_, place_error_, F::light_direction, "light.position");
}

Interval LightError::held(Interval exact, F id) const {
  const Format& f = format(id);
  if (!saturates(f) && !(exact + rounding(f)).inside(values(f))) return values(f);
  return quantised(exact, f);
}

LightError::Unit LightError::unit_of(const Vector& exact, const Vector& error, F to,
                                     std::string_view source) const {
  Unit out;
  out.source = source;
  out.length = length_of(exact);
  const double off = root_of(square(Interval(error[0].mag())) + square(Interval(error[1].mag())) +
                             square(Interval(error[2].mag())))
                         .hi;
  const bool is_zero = exact == Vector{};
  if (is_zero && error == Vector{}) {
    out.is_none = true;
    return out;
  }
  // Two vectors of length 1 are apart by at most 2 |X' - X| / (|X'| + |X|).
  const Interval lengths = Interval(out.length.lo) + (Interval(out.length.lo) - off);
  if (is_zero) {
    out.turn = 1;
  } else if (lengths.lo <= off) {
    out.turn = 2;  // the registers may be 0, too
  } else {
    out.turn = std::min(2.0, (Interval(2) * off / lengths.lo).hi);
  }
  out.scale = 1 + root_.relative;
  const Format& f = format(to);
  out.rounding = rounding(f);
  for (std::size_t i = 0; i < 3; ++i) {
    out.exact[i] = is_zero             ? Interval(0)
                   : out.length.lo > 0 ? clamped(exact[i] / out.length, -1, 1)
                                       : Interval(-1, 1);
    out.near[i] = clamped(out.exact[i] + Interval::plus_minus(out.turn), -1, 1);
    ErrorSum& e = out.error[i];
    e.add(source, Interval::plus_minus(out.turn));
    e.add("light.root", out.near[i] * root_.relative);
    e.add(key_of(to), out.rounding);
    if (root_.any) e.replace("overflow", values(f) - out.exact[i]);
    if (root_.any || !(out.exact[i] + e.total()).inside(values(f))) out.overflows = true;
    settle(e, f, out.exact[i]);
  }
  return out;
}

ErrorSum LightError::dot(const Unit& n, const Unit& l, Interval exact) const {
  ErrorSum e;
  if (n.is_none || l.is_none) return e;
  if (n.overflows || l.overflows) {
    for (std::size_t i = 0; i < 3; ++i) {
      e.add(n.error[i], l.exact[i] + l.error[i].total());
      e.add(l.error[i], n.exact[i]);
    }
  } else {
    if (n.turn + l.turn < 1) {
      // An angle turns by at most d in all: cos(t + d) - cos t = cos t (cos d - 1) - sin t sin d.
      const auto angle = [](double turn) {
        return Interval(turn) / root_of(1 - square(Interval(turn)) * 0.25);
      };
      const double sine = root_of(clamped(1 - square(exact), 0, 1)).hi;
      const Interval of_n = angle(n.turn);
      const Interval of_l = angle(l.turn);
      e.add(n.source, Interval::plus_minus((of_n * sine).hi));
      e.add(l.source, Interval::plus_minus((of_l * sine).hi));
      e.add("both turns", exact * share_of(-square(of_n + of_l) * 0.5));
    } else {
      e.add(n.source, Interval::plus_minus(n.turn));
      e.add(l.source, Interval::plus_minus(l.turn));
    }
    const Interval turned = clamped(exact + e.total(), -1, 1);
    e.add("light.root", turned * (n.scale * l.scale - 1));
    e.add("light.direction", n.scale * product(n.near, {l.rounding, l.rounding, l.rounding}));
    e.add("light.normal",
          l.scale * product(l.near, {n.rounding, n.rounding, n.rounding}) + 3 * (n.rounding * l.rounding));
  }
  const int grid = format(F::light_normal).fraction() + format(F::light_direction).fraction();
  e.add("light.cosine", rounding(format(F::light_cosine), grid));
  settle(e, format(F::light_cosine), exact);
  return e;
}

ErrorSum LightError::power(Interval exact, Interval held_at, double resolution) const {
  const int n = view_.light.exponent;
  ErrorSum e;
  const Interval from = power_of(exact, n);
  const Interval to = power_of(held_at, n);
  // Of one exact value, to - from is all that the cosine's error does. Of many, the slope says more.
  e.add("the mirrored cosine", to - from);
  const Interval slope = Interval(n) * power_of(hull(exact, held_at), n - 1);
  narrow(e, "the mirrored cosine", (held_at - exact) * slope);
  // A chord lies above the power, at most by an eighth of its curvature at the interval's upper end.
  const double intervals = std::ldexp(1.0, c_.light_index_bits);
  const double last = std::min(intervals - 1, std::floor(held_at.hi * intervals + resolution));
  const Interval end = Interval(last + 1) / intervals;
  if (n > 1) {
    const Interval curve = Interval(static_cast<double>(n) * (n - 1)) * power_of(end, n - 2);
    e.add("light.index_bits", share_of(curve / (8 * intervals * intervals)));
  }
  const Format& f = format(F::light_specular);
  ErrorSum entry;
  entry.add("light.specular (table)", rounding(f));
  settle(entry, f, Interval(0, power_of(end, n).hi));
  e.add(entry);
  e.add("light.specular",
        rounding(f, f.fraction() + std::max(0, format(F::light_cosine).fraction() - c_.light_index_bits)));
  settle(e, f, from);
  return e;
}

// With m = (1 + r) / sqrt(n), n in 1..4, the register holds (1 + r)^2 / n and its rounding.
Interval LightError::inverse_error() const {
  const Format& f = format(F::light_inverse);
  const Interval mantissa(0.25, 1);
  const Interval of_root = square(1 + root_.relative) - 1;
  ErrorSum e;
  e.add("light.root", of_root * mantissa);
  e.add("light.inverse", rounding(f));
  if (!root_.any && (mantissa + e.total()).inside(values(f))) return of_root + rounding(f) * Interval(1, 4);
  if (root_.any) e.replace("overflow", values(f) - mantissa);
  settle(e, f, mantissa);
  return e.total() * Interval(1, 4);
}

ErrorSum LightError::lunar(const ErrorSum& scattered, Interval exact, const Unit& normal) const {
  const Format& f = format(F::light_lunar);
  const double exact_k = view_.light.lunar;
  const Interval k = held(exact_k, F::light_lunar);
  const Interval away = clamped(-normal.exact[2], 0, 1);
  const Interval t = 1 + Interval(exact_k) * away;
  ErrorSum off;
  off.add("normal", share_of(-normal.error[2].total()) * k);
  off.add("light.lunar",
          (k - exact_k) * away + rounding(f, f.fraction() + format(F::light_normal).fraction()));
  settle(off, f, t);
  off.add("light.lunar", raised_from_0(t + off.total(), f));
  const Interval register_t(std::max(ulp(f), (t + off.total()).lo), std::max(ulp(f), (t + off.total()).hi));
  // D'(1 + i) / T' - D / T = ((D' - D) - D (T' - T) / T + D' i) / T'
  const Interval inverse = inverse_error();
  ErrorSum e;
  e.add(scattered, Interval(1) / register_t);
  e.add("light.lunar", -(exact * off.total()) / t / register_t);
  e.add("light.inverse", (exact + scattered.total()) * inverse / register_t);
  e.add("light.cosine", rounding(format(F::light_cosine)));
  settle(e, format(F::light_cosine), exact / t);
  return e;
}

LightError::Fall LightError::fall(const Vector& exact, const Vector& error, const Unit& unit) const {
  Fall out;
  const Interval length = length_of(exact);
  const Interval off = root_of(square(Interval(error[0].mag())) + square(Interval(error[1].mag())) +
                               square(Interval(error[2].mag())));
  Vector at;
  for (std::size_t i = 0; i < 3; ++i) at[i] = exact[i] + error[i];
  const Format& position = format(F::light_position);
  const Format& distance = format(F::light_distance);
  // D'.Unit(D') = |D'| (1 + r) + D'.rounding
  ErrorSum d;
  if (unit.overflows) {
    Vector held_unit;
    for (std::size_t i = 0; i < 3; ++i) held_unit[i] = unit.exact[i] + unit.error[i].total();
    d.add("overflow", product(at, held_unit) - length);
  } else if (!unit.is_none) {
    d.add(surface_place, Interval::plus_minus(off.hi));
    d.add("light.root", (length + Interval::plus_minus(off.hi)) * root_.relative);
    d.add("light.direction", product(at, {unit.rounding, unit.rounding, unit.rounding}));
  }
  d.add("light.position", rounding(position));
  settle(d, position, length);
  const Interval reached = length * exact_per_reach_;
  ErrorSum r;
  r.add(d, per_reach_);
  r.add("light.scale", length * (per_reach_ - exact_per_reach_));
  r.add("light.distance", rounding(distance));
  settle(r, distance, reached);
  const bool by_square = falls_by_square(c_.light_fall);
  const Interval offset = view_.light.offset;
  const Interval t = (by_square ? square(reached) : reached) + offset;
  ErrorSum e;
  e.add(r, by_square ? reached * 2 + r.total() : Interval(1));
  e.add("light.distance", (held(offset, F::light_distance) - offset) + rounding(distance));
  settle(e, distance, t);
  if (!(t.lo > 1e-200)) {
    out.none = true;
    return out;
  }
  const Interval register_t(std::max(ulp(distance), (t + e.total()).lo),
                            std::max(ulp(distance), (t + e.total()).hi));
  const Format& f = format(F::light_fall);
  out.exact = Interval(1) / t;
  for (const auto& term : e.terms()) out.error.add(term.first, -term.second / t / register_t);
  const Interval raised = raised_from_0(t + e.total(), distance);
  out.error.add("light.distance", -raised / t / register_t);
  out.error.add("light.inverse", inverse_error() / register_t);
  out.error.add("light.fall", rounding(f));
  settle(out.error, f, out.exact);
  return out;
}

LightErrors LightError::at(const LitPoint& p) const {
  LightErrors out;
  const Light& light = view_.light;
  const Unit n = unit_of(p.normal, p.normal_error, F::light_normal, normal_line);
  Vector here, here_error;
  if (light.is_point || falls_) {
    const Format& position = format(F::light_position);
    const std::array from_middle{p.x, p.y};
    for (std::size_t i = 0; i < 3; ++i) {
      here[i] = i < 2 ? from_middle[i] * p.s * exact_scale_ : p.s;
      ErrorSum e;
      e.add(surface_place,
            i < 2 ? from_middle[i] * (p.s_error * scale_ + p.s * (scale_ - exact_scale_)) : p.s_error);
      e.add("light.position", rounding(position));
      settle(e, position, here[i]);
      here_error[i] = e.total();
    }
  }
  Unit l = far_;
  Vector to, to_error;
  if (light.is_point) {
    for (std::size_t i = 0; i < 3; ++i) {
      to[i] = place_[i] - here[i];
      to_error[i] = place_error_[i] - here_error[i];
    }
    l = unit_of(to, to_error, F::light_direction, surface_place);
  }
  out.normal = n.error;
  out.direction = l.error;

  // `ideal` is in double precision, and a difference of large numbers is less exact.
  const auto resolution = [](double largest, Interval length) {
    return length.lo > 0 ? std::ldexp(1 + (Interval(largest) / length.lo).hi, -48) : 1;
  };
  const double of_normal = n.is_none ? 0 : resolution(p.largest, n.length);
  const double of_direction =
      light.is_point ? resolution((length_of(place_) + length_of(here)).hi, l.length) : std::ldexp(1.0, -48);
  out.vector_resolution = std::max(of_normal, of_direction);
  out.cosine_resolution = 4 * (of_normal + of_direction);
  out.specular_resolution = light.exponent * out.cosine_resolution + std::ldexp(1.0, -46);
  out.value_resolution = out.specular_resolution + out.cosine_resolution;

  const Interval c = clamped(product(n.exact, l.exact), -1, 1);
  out.exact_cosine = c;
  out.cosine = dot(n, l, c);
  const Interval off = out.cosine.total();
  const Interval register_c = c + off;
  const Interval g = clamped(l.exact[2] - 2 * (c * n.exact[2]), -1, 1);
  const Format& cosine = format(F::light_cosine);
  out.mirrored.add(l.error[2]);
  out.mirrored.add(out.cosine, -2 * (n.exact[2] + n.error[2].total()));
  out.mirrored.add(n.error[2], -2 * c);
  out.mirrored.add("light.cosine",
                   rounding(cosine, std::max(format(F::light_direction).fraction(),
                                             cosine.fraction() + format(F::light_normal).fraction() - 1)));
  settle(out.mirrored, cosine, g);

  // Which sides of the terminator there may be, exactly and by the register.
  const bool lit = c.hi > -out.cosine_resolution;
  const bool dark = c.lo <= out.cosine_resolution;
  const bool register_lit = register_c.hi > 0;
  const bool register_dark = register_c.lo <= 0;

  ErrorSum scattered = out.cosine;
  Interval exact_scattered = clamped(c, 0, 1);
  Interval spec = 0;
  if (!lit && !register_lit) {
    scattered = {};
  } else {
    if (dark || register_dark) scattered.share();
    const Interval at = clamped(g, 0, 1);
    const Interval at_register = clamped(g + out.mirrored.total(), 0, 1);
    spec = power_of(at, light.exponent);
    out.specular = power(at, at_register, out.cosine_resolution * std::ldexp(1.0, c_.light_index_bits));
    if (dark || register_dark) {
      // Only one of the two may have the highlight.
      const Interval whole = (spec + out.specular.total());
      Interval e = share_of(out.specular.total());
      if (lit && register_dark) e = hull(e, -spec);
      if (dark && register_lit) e = hull(e, clamped(whole, 0, values(format(F::light_specular)).hi));
      out.specular.replace("the terminator", e);
      spec = !lit ? Interval(0) : dark ? share_of(spec) : spec;
    }
  }
  if (light.lunar > 0 && (lit || register_lit)) {
    const Interval t = 1 + Interval(light.lunar) * clamped(-n.exact[2], 0, 1);
    scattered = lunar(scattered, exact_scattered, n);
    exact_scattered = exact_scattered / t;
  }

  const Format& value = format(F::light_value);
  const int sum_grid = value.fraction() + std::max(cosine.fraction(), format(F::light_specular).fraction());
  ErrorSum e;
  e.add(scattered, diffuse_);
  e.add(out.specular, highlight_);
  const Interval of_shares =
      exact_scattered * (diffuse_ - exact_diffuse_) + spec * (highlight_ - light.specular);
  const Interval exact_sum = exact_scattered * exact_diffuse_ + spec * light.specular;
  Interval brightness = exact_sum;
  if (falls_) {
    const Fall f = light.is_point && !falls_to_viewer(c_.light_fall_to)
                       ? fall(to, to_error, l)
                       : fall(here, here_error, unit_of(here, here_error, F::light_direction, surface_place));
    if (f.none) {
      out.value_unbounded = true;
      return out;
    }
    e.add("shares", of_shares);
    if (register_lit) e.add("light.value", rounding(value, sum_grid));
    settle(e, value, exact_sum);
    brightness = exact_sum * f.exact;
    ErrorSum near;
    near.add(e, f.exact + f.error.total());
    near.add(f.error, exact_sum);
    e = near;
    e.add("shares", ambient_ - light.ambient);
    e.add("light.value", rounding(value));
    out.value_resolution *= 1 + f.exact.mag();
  } else {
    e.add("shares", of_shares + (ambient_ - light.ambient));
    if (register_lit) e.add("light.value", rounding(value, sum_grid));
  }
  out.exact_value = brightness + light.ambient;
  settle(e, value, out.exact_value);
  out.value = e;
  return out;
}

ErrorSum LightError::color(const LightErrors& errors, Interval color) const {
  const Format& f = format(F::texture_color);
  ErrorSum e;
  e.add(errors.value, color);
  e.add("texture.color", rounding(f, f.fraction() + format(F::light_value).fraction()));
  settle(e, f, color * errors.exact_value);
  return e;
}

}  // namespace bitspan::bounds
