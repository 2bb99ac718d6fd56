// SPDX-License-Identifier: Apache-2.0
#include "engine/range.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "config/modes.hpp"

namespace bitspan {
namespace {

using F = FormatId;
using Real = long double;  // 64 significant bits or more: every product below is exact or far off a limit

constexpr std::int64_t kNoTriangle = -1;
constexpr int kMostCoordinateBits = 24;
constexpr int kMostFormatBits = 64;
constexpr Real kFar = 0x1p+90L;  // stands for any value beyond every format

// 2^n. A scene asks for some hundred per triangle, so they are at hand.
Real power(int n) {
  constexpr int most = 192;
  static const auto powers = [] {
    std::array<Real, 2 * most + 1> out{};
    int e = -most;
    for (Real& p : out) p = std::ldexp(1.0L, e++);
    return out;
  }();
  const int at = n + most;
  return at < 0 || at > 2 * most ? std::ldexp(1.0L, n) : powers[static_cast<std::size_t>(at)];
}

// The smallest n with x <= 2^n; x above 0.
int octaves(double x) {
  int n = 0;
  return std::frexp(x, &n) == 0.5 ? n - 1 : n;
}

// The same as std::floor, which calls a library for this type.
Real floor_of(Real x) {
  if (!(x > -0x1p62L && x < 0x1p62L)) return std::floor(x);
  const auto toward_zero = static_cast<Real>(static_cast<std::int64_t>(x));
  return toward_zero > x ? toward_zero - 1 : toward_zero;
}

Real ulp(const Format& f) { return power(-f.fraction()); }

// In whole ulps, as a real number.
Real rounded(Real x, const Format& f) {
  x = std::clamp(x, -kFar, kFar) * power(f.fraction());
  const Real down = floor_of(x);
  const Real rest = x - down;
  bool up = false;
  switch (f.rounding) {
    case Rounding::trn:
      break;
    case Rounding::trn_zero:
      up = x < 0 && rest > 0;
      break;
    case Rounding::rnd:
      up = rest >= 0.5L;
      break;
    case Rounding::rnd_min_inf:
      up = rest > 0.5L;
      break;
    case Rounding::rnd_zero:
      up = rest > 0.5L || (rest == 0.5L && x < 0);
      break;
    case Rounding::rnd_inf:
      up = rest > 0.5L || (rest == 0.5L && x > 0);
      break;
    case Rounding::rnd_conv:
      up = rest > 0.5L || (rest == 0.5L && std::fmod(down, 2.0L) != 0);
      break;
  }
  return up ? down + 1 : down;
}

Real lowest(const Format& f) {
  if (!f.is_signed) return 0;
  const Real half = power(f.word - 1);
  return f.overflow == Overflow::sat_sym ? 1 - half : -half;
}
Real highest(const Format& f) { return power(f.is_signed ? f.word - 1 : f.word) - 1; }

bool saturates(const Format& f) { return f.overflow == Overflow::sat || f.overflow == Overflow::sat_sym; }

bool holds(const Format& f, Real lo, Real hi) {
  return rounded(lo, f) >= lowest(f) && rounded(hi, f) <= highest(f);
}

// Q[f](x), so that values which overflow on purpose go on as the register has them.
Real quantised(Real x, const Format& f) {
  const Real raw = rounded(x, f);
  if (raw >= lowest(f) && raw <= highest(f)) return raw * ulp(f);
  const Real modulus = power(f.word);
  switch (f.overflow) {
    case Overflow::sat:
    case Overflow::sat_sym:
      return (raw < 0 ? lowest(f) : highest(f)) * ulp(f);
    case Overflow::sat_zero:
      return 0;
    case Overflow::wrap: {
      const Real kept = raw - modulus * std::floor(raw / modulus);
      return (f.is_signed && kept > highest(f) ? kept - modulus : kept) * ulp(f);
    }
    case Overflow::wrap_sm: {
      // The bit above the kept ones becomes the sign; where it differs from the old sign, the rest is
      // inverted.
      const Real half = modulus / 2;
      const Real kept = raw - modulus * std::floor(raw / modulus);
      const bool above = std::fmod(std::floor(raw / modulus), 2.0L) != 0;
      const bool old_sign = kept >= half;
      Real low = old_sign ? kept - half : kept;
      if (above != old_sign) low = half - 1 - low;
      return (above ? low - half : low) * ulp(f);
    }
  }
  return 0;
}

// The same format with another number of integer places; the fraction stays.
Format with_integer(Format f, int integer) {
  f.word += integer - f.integer;
  f.integer = integer;
  return f;
}

struct Range {
  Real lo = std::numeric_limits<Real>::infinity();
  Real hi = -std::numeric_limits<Real>::infinity();
  std::int64_t lo_triangle = kNoTriangle;
  std::int64_t hi_triangle = kNoTriangle;

  bool empty() const { return lo > hi; }
  void add(Real x, std::int64_t triangle) {
    if (x < lo) {
      lo = x;
      lo_triangle = triangle;
    }
    if (x > hi) {
      hi = x;
      hi_triangle = triangle;
    }
  }
};

std::string number(Real x) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.9Lg", x);
  return text.data();
}

struct Interval {
  Real lo, hi;
};

Interval operator+(Interval a, Real x) { return {a.lo + x, a.hi + x}; }
Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }

// Of doubles, for speed. Whoever uses products and quotients adds more than their rounding.
struct Bounds {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;

  void add(double value) {
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  operator Interval() const { return {lo, hi}; }  // NOLINT: the same, in the numbers of the checks
};

// What the vertices of all triangles have at most.
struct Extremes {
  Bounds x, y, s, c;
  std::array<Bounds, 2> t;               // u, v
  std::array<double, 2> t_over_s{};      // |t| / s
  std::array<double, 2> width{};         // of t in one triangle
  std::array<double, 2> width_over_s{};  // over the least s in it
  bool is_finite = true;
  bool has_line = false;

  explicit Extremes(std::span<const Triangle> triangles) {
    double zero = 0;  // NaN where anything is not finite
    for (const Triangle& triangle : triangles) {
      has_line = has_line || triangle.is_line;
      Bounds own_s;
      std::array<Bounds, 2> own_t;
      for (const Vertex& v : triangle.v) {
        x.add(v.x);
        y.add(v.y);
        own_s.add(v.s);
        for (const double shade : v.c) c.add(shade);
        for (std::size_t i = 0; i < 2; ++i) {
          const double value = i == 0 ? v.u : v.v;
          own_t[i].add(value);
          t_over_s[i] = std::max(t_over_s[i], std::fabs(value) / v.s);
        }
        zero += 0 * (v.x + v.y + v.s + v.u + v.v) + 0 * (v.c[0] + v.c[1] + v.c[2] + v.c[3]);
      }
      s.add(own_s.lo);
      s.add(own_s.hi);
      for (std::size_t i = 0; i < 2; ++i) {
        t[i].add(own_t[i].lo);
        t[i].add(own_t[i].hi);
        const double own_width = own_t[i].hi - own_t[i].lo;
        width[i] = std::max(width[i], own_width);
        width_over_s[i] = std::max(width_over_s[i], own_width / own_s.lo);
      }
    }
    is_finite = zero == 0;
  }
};

class RangeCheck {
 public:
  RangeCheck(const Config& config, const View& view, std::string name)
      : c_(config), view_(view), name_(std::move(name)) {
    constants();
    fixed_ranges();
  }

  const View& view() const { return view_; }

  // The first triangle has index `first`.
  void look(std::span<const Triangle> triangles, std::int64_t first, RangeBy by) {
    if (view_.fog && has_vertex_fog(c_.fog)) vertex_fog(triangles, first);
    if (view_.projector && has_project(c_.project)) vertex_projection(triangles, first);
    if (view_.light && (view_.light->is_point || view_.light->reach > 0) && lights_vertices(c_.light)) {
      vertex_light(triangles, first);
    }
    if (view_.light && has_light(c_.light)) vertex_normals(triangles, first);
    if (has_perspective_shades(c_.shade_lines)) vertex_shades(triangles, first);
    if (has_second_coordinates(c_.second_coordinates)) vertex_second(triangles, first);
    if (view_.light && has_relief(c_)) vertex_relief(triangles, first);
    if (by == RangeBy::bounds && surely_held(triangles)) return;
    for (const Triangle& t : triangles) triangle(t, first++);
  }

  // Whether every format holds what was seen.
  bool held() const {
    for (int i = 0; i < format_count; ++i) {
      if (!is_held(static_cast<F>(i))) return false;
    }
    return true;
  }

  void report() const {
    for (int i = 0; i < format_count; ++i) report(static_cast<F>(i));
  }

 private:
  const Format& format(F id) const { return c_.format(id); }
  Real q(F id, Real x) const { return quantised(x, format(id)); }
  Interval q(F id, Interval x) const { return {q(id, x.lo), q(id, x.hi)}; }

  // A start offset: of half an ulp of `kept`, or a number.
  static Real offset(const StartOffset& o, const Format& kept) {
    return o.half_ulp ? ulp(kept) / 2 : static_cast<Real>(o.value);
  }

  void add(F id, Real x, std::int64_t triangle) { ranges_[static_cast<std::size_t>(id)].add(x, triangle); }
  void add(F id, Interval x, std::int64_t triangle) {
    add(id, x.lo, triangle);
    add(id, x.hi, triangle);
  }

  [[noreturn]] void fail(const std::string& key, const std::string& text) const {
    throw InputError("scene " + (name_.empty() ? std::string("(unnamed)") : name_) + ", configuration " +
                     (c_.name.empty() ? std::string("(unnamed)") : c_.name) + ": " + key + ": " + text);
  }

  static std::string of_triangle(std::int64_t triangle) {
    return triangle == kNoTriangle ? "" : " (triangle " + std::to_string(triangle) + ")";
  }

  static std::string describe(const Format& f) {
    return std::string(f.is_signed ? "signed" : "unsigned") + ", word " + std::to_string(f.word) + ", int " +
           std::to_string(f.integer) + ", holds " + number(lowest(f) * ulp(f)) + ".." +
           number(highest(f) * ulp(f));
  }

  bool is_held(F id) const {
    const Range& r = ranges_[static_cast<std::size_t>(id)];
    const Format& f = format(id);
    return r.empty() || f.overflow_expected || holds(f, r.lo, r.hi);
  }

  // Refuses the field where it does not hold the range that was noted for it.
  void report(F id) const {
    if (is_held(id)) return;
    const Range& r = ranges_[static_cast<std::size_t>(id)];
    const Format& f = format(id);
    Format wide = f;
    wide.is_signed = f.is_signed || rounded(r.lo, f) < 0;
    int integer = 1 - f.fraction();
    while (integer < 128 && !holds(with_integer(wide, integer), r.lo, r.hi)) ++integer;
    const int word = integer + f.fraction();
    const std::string key = "formats." + std::string(key_of(id));
    std::string need = wide.is_signed != f.is_signed ? "signed = true, " : "";
    need +=
        "int = " + std::to_string(integer) + " (word = " + std::to_string(word) + " with the same fraction";
    if (word > (wide.is_signed ? kMostFormatBits : kMostFormatBits - 1)) {
      need += ", more than a format has";
    }
    need += ")";
    fail(key, "too narrow: the scene needs " + number(r.lo) + of_triangle(r.lo_triangle) + " to " +
                  number(r.hi) + of_triangle(r.hi_triangle) + " " + std::string(unit_of(id)) +
                  "; the format is " + describe(f) + "; needs " + need +
                  ", or overflow_expected = true where the overflow is meant");
  }

  // The fewest fraction places of a field with which `good` holds, in words.
  template <class Good>
  static std::string fraction_needed(Format f, Good good) {
    while (f.fraction() < 64) {
      ++f.word;
      if (good(f)) {
        return "needs a fraction of " + std::to_string(f.fraction()) +
               " bits (word = " + std::to_string(f.word) + " with int = " + std::to_string(f.integer) + ")";
      }
    }
    return "no fraction of up to 64 bits is enough";
  }

  // A range of distances as an eye's registers hold it.
  struct Eye {
    int exponent = 0;  // E
    Real s_min = 0, s_max = 0, b = 0;
  };
  // whose: in front of the names s_min and s_max.
  Eye eye(double least, double most, const std::string& whose) {
    const std::string names = whose + "s_min, " + whose + "s_max";
    if (!(std::isfinite(least) && std::isfinite(most) && least > 0 && least < most)) {
      fail(names, "are " + number(least) + ", " + number(most) + "; legal: finite, 0 < s_min < s_max");
    }
    const int e = octaves(most);
    const Real s_min = std::ldexp(static_cast<Real>(least), -e);
    const Real s_max = std::ldexp(static_cast<Real>(most), -e);
    add(F::setup_s, s_min, kNoTriangle);
    add(F::setup_s, s_max, kNoTriangle);
    report(F::setup_s);
    Eye out{.exponent = e, .s_min = q(F::setup_s, s_min), .s_max = q(F::setup_s, s_max)};
    if (!(out.s_min > 0 && out.s_min < out.s_max)) {
      fail("formats.setup.s", "too coarse: " + whose + "s_min and " + whose + "s_max, " + number(s_min) +
                                  " and " + number(s_max) + " of " + "2^" + std::to_string(e) + ", become " +
                                  number(out.s_min) + " and " + number(out.s_max) +
                                  "; legal: 0 < s_min' < s_max'; " +
                                  fraction_needed(format(F::setup_s), [&](const Format& f) {
                                    const Real low = quantised(s_min, f);
                                    return low > 0 && low < quantised(s_max, f);
                                  }));
    }
    const Real hmax = std::ldexp(1.0L, c_.depth_bits) - 1;
    const Real b = hmax * out.s_min / (out.s_max - out.s_min);
    add(F::setup_b, b, kNoTriangle);
    report(F::setup_b);
    out.b = q(F::setup_b, b);
    if (!(out.b > 0)) {
      fail("formats.setup.b",
           "too coarse: B, " + number(b) + ", becomes " + number(out.b) + "; legal: B > 0; " +
               fraction_needed(format(F::setup_b), [&](const Format& f) { return quantised(b, f) > 0; }));
    }
    return out;
  }

  void constants() {
    const Eye own = eye(view_.s_min, view_.s_max, "");
    exponent_ = own.exponent;
    s_min_ = own.s_min;
    s_max_ = own.s_max;
    b_ = own.b;
    const Real hmax = std::ldexp(1.0L, c_.depth_bits) - 1;
    if (is_linear_in_distance(c_.depth_code)) {
      add(F::depth_c1, hmax * b_ * s_max_ / (s_max_ - s_min_), kNoTriangle);
      add(F::depth_c0, hmax * s_min_ / (s_max_ - s_min_), kNoTriangle);
    }
    if (has_s(c_)) {
      add(F::distance_a, b_ * s_max_, kNoTriangle);
      add(F::distance_s, Interval{s_min_, s_max_}, kNoTriangle);
    }
    if (has_true_distance(c_)) {
      // From the middle to the corners.
      const Real x = static_cast<Real>(view_.width) / 2, y = static_cast<Real>(view_.height) / 2;
      const Real focal = static_cast<Real>(view_.focal);
      const Interval g{1, std::sqrt(1 + (x * x + y * y) / (focal * focal))};
      add(F::distance_g, g, kNoTriangle);
      add(F::distance_d, Interval{s_min_, s_max_ * g.hi}, kNoTriangle);
    }
    if (view_.projector && has_project(c_.project)) {
      const Eye of = eye(view_.projector->s_min, view_.projector->s_max, "projector.");
      projector_exponent_ = of.exponent;
      // A fragment nearer than s_min, or behind the projector, is meant to leave these ranges.
      add(F::distance_a, of.b * of.s_max, kNoTriangle);
      add(F::project_ratio, Interval{1 / of.s_max, 1 / of.s_min}, kNoTriangle);
      add_depth(F::project_h, {0, of.b * (of.s_max - of.s_min) / of.s_min}, 0);
    }
    if (view_.light && has_light(c_.light)) light(*view_.light);
    if (view_.fog && is_linear_in_distance(c_.fog)) linear_fog();
    if (!view_.fog || !has_fog(c_.fog)) add(F::fog_factor, 1, kNoTriangle);
  }

  // Where it stands, and the points that it is seen from; or its direction, whose largest part is 1/2 to 1.
  void light(const Light& light) {
    int down = exponent_;
    const bool falls = light.reach > 0 && (light.is_point || falls_to_viewer(c_.light_fall_to));
    if (has_lunar(c_)) add(F::light_lunar, 1 + static_cast<Real>(light.lunar), kNoTriangle);
    if (falls && has_light_fall(c_)) {
      add(F::light_scale, std::ldexp(1 / static_cast<Real>(light.reach), octaves(light.reach)), kNoTriangle);
      add(F::light_distance, static_cast<Real>(light.offset), kNoTriangle);
    }
    if (light.is_point || falls) {
      const auto focal = static_cast<Real>(view_.focal);
      add(F::light_scale, std::ldexp(1 / focal, octaves(view_.focal)), kNoTriangle);
      if (lights_pixels(c_.light)) {
        for (const int size : {view_.width, view_.height}) {
          const Real most = static_cast<Real>(size - 1) / 2 * s_max_ / focal;
          add(F::light_position, Interval{-most, most}, kNoTriangle);
        }
        add(F::light_position, Interval{s_min_, s_max_}, kNoTriangle);
      }
    }
    if (!light.is_point) {
      double most = 0;
      for (const double part : light.place) most = std::max(most, std::fabs(part));
      down = octaves(most);
    }
    for (const double part : light.place) {
      add(F::light_position, std::ldexp(static_cast<Real>(part), -down), kNoTriangle);
    }
  }
  void vertex_light(std::span<const Triangle> triangles, std::int64_t first) {
    for_each_vertex(triangles, first, [this](const Vertex& v, Real /*h*/, std::int64_t index) {
      const Real s = std::ldexp(static_cast<Real>(v.s), -exponent_);
      const Real per_pixel = s / static_cast<Real>(view_.focal);
      add(F::light_position, (static_cast<Real>(v.x) - static_cast<Real>(view_.width) / 2) * per_pixel,
          index);
      add(F::light_position, (static_cast<Real>(v.y) - static_cast<Real>(view_.height) / 2) * per_pixel,
          index);
      add(F::light_position, s, index);
    });
  }

  void linear_fog() {
    if (!(std::isfinite(view_.fog->distance) && view_.fog->distance > 0)) {
      fail("fog distance", "is " + number(view_.fog->distance) + "; legal: finite, above 0");
    }
    const Real distance = std::ldexp(static_cast<Real>(view_.fog->distance), -exponent_);
    add(F::fog_scale, b_ * s_max_ / distance, kNoTriangle);
    // Below 0 the factor is meant to stop at 0, which an unsigned saturating format does.
    const Format& f = format(F::fog_factor);
    const bool stops = !f.is_signed && f.overflow != Overflow::wrap;
    const Real far = 1 - s_max_ / distance;
    add(F::fog_factor, stops ? std::max(far, Real{0}) : far, kNoTriangle);
    add(F::fog_factor, std::max(1 - s_min_ / distance, stops ? Real{0} : far), kNoTriangle);
  }

  // Between the vertices lies what lies at them.
  void vertex_fog(std::span<const Triangle> triangles, std::int64_t index) {
    for (const Triangle& triangle : triangles) {
      for (const Vertex& v : triangle.v) {
        const Real factor = v.fog < 0 ? std::exp(-static_cast<Real>(v.s) / view_.fog->distance) : v.fog;
        const Real kept = q(F::fog_acc, q(F::fog_vertex, factor));
        add(F::fog_vertex, factor, index);
        add(F::fog_acc, q(F::fog_vertex, factor), index);
        add(F::fog_factor, kept, index);
      }
      ++index;
    }
  }

  // Calls f(vertex, its h, index) for those of triangles that have an area. A channel's products are linear
  // on the screen, so that what lies at the vertices bounds them.
  template <class F>
  void for_each_vertex(std::span<const Triangle> triangles, std::int64_t index, F f) {
    for (const Triangle& triangle : triangles) {
      std::array<Point, 3> p{};
      for (std::size_t i = 0; i < 3; ++i) p[i] = vertex(triangle.v[i], index);
      for (std::size_t i = 0; area_of(p) != 0 && i < 3; ++i) f(triangle.v[i], p[i].h, index);
      ++index;
    }
  }
  void vertex_shades(std::span<const Triangle> triangles, std::int64_t first) {
    for_each_vertex(triangles, first, [this](const Vertex& v, Real h, std::int64_t index) {
      for (const double shade : v.c) {
        const Real kept = q(F::setup_shade, shade);
        add(F::shade_acc, kept * (h + b_), index);
        add(F::shade_value, kept, index);
      }
    });
  }
  void vertex_second(std::span<const Triangle> triangles, std::int64_t first) {
    for_each_vertex(triangles, first, [this](const Vertex& v, Real h, std::int64_t index) {
      for (const double w : {v.u2, v.v2}) {
        const Real product = q(F::plane_g, q(F::setup_uv, w) * (h + b_));
        add(F::setup_uv, w, index);
        add(F::plane_g, q(F::setup_uv, w) * (h + b_), index);
        add(F::edge_f, product, index);
        add(F::span_f, q(F::edge_f, product), index);
        add(F::span_uv, w, index);
      }
    });
  }
  // Normals are mostly of length 1 and fit: one look over all of them says so.
  void vertex_normals(std::span<const Triangle> triangles, std::int64_t first) {
    constexpr std::array at_pixels{F::normal_vertex, F::normal_acc, F::normal_value};
    const std::span<const F> taken =
        lights_pixels(c_.light) ? std::span<const F>(at_pixels) : std::span(at_pixels).last(1);
    double most = 0;
    for (const Triangle& triangle : triangles) {
      for (const Vertex& v : triangle.v) {
        most = std::max({most, std::fabs(v.nx), std::fabs(v.ny), std::fabs(v.nz)});
      }
    }
    if (std::ranges::all_of(taken, [&](F id) { return holds(format(id), -most, most); })) return;
    for_each_vertex(triangles, first, [&](const Vertex& v, Real /*h*/, std::int64_t index) {
      for (const double w : {v.nx, v.ny, v.nz}) {
        for (const F id : taken) add(id, w, index);
      }
    });
  }
  void vertex_relief(std::span<const Triangle> triangles, std::int64_t first) {
    for_each_vertex(triangles, first, [this](const Vertex& v, Real /*h*/, std::int64_t index) {
      for (const double w : {v.lx, v.ly, v.lz}) {
        for (const F id : {F::relief_vertex, F::relief_acc, F::relief_value}) add(id, w, index);
      }
    });
  }
  void vertex_projection(std::span<const Triangle> triangles, std::int64_t first) {
    for_each_vertex(triangles, first, [this](const Vertex& v, Real h, std::int64_t index) {
      for (const double at : {v.project_x, v.project_y, v.project_w}) {
        const Real w = std::ldexp(static_cast<Real>(at), -projector_exponent_);
        const Real product = q(F::project_vertex, w) * (h + b_);
        add(F::project_vertex, w, index);
        add(F::project_acc, product, index);
        add(F::project_value, q(F::project_acc, product), index);
      }
    });
  }

  // Notes a register of h and gives its values. By the rounding of B, h may pass hmax a little: a saturating
  // format is meant to stop it there.
  Interval add_depth(F id, Interval h, Real shift) {
    const Format& f = format(id);
    const bool stops = saturates(f);
    const Real hmax = std::ldexp(1.0L, c_.depth_bits) - 1;
    add(id, stops ? Interval{h.lo, std::min(h.hi, hmax + shift)} : h, kNoTriangle);
    return q(id, h);
  }

  // Fields whose range does not depend on the triangles.
  void fixed_ranges() {
    const Interval h{0, b_ * (s_max_ - s_min_) / s_min_};
    const Interval setup = add_depth(F::setup_h, h, 0);
    if (has_plane_rows(c_.perspective)) {
      add_depth(F::span_h, setup, 0);
    } else if (has_setup_plane(c_)) {
      const Real shift = offset(c_.start_offset.span_h, c_.depth_format());
      add_depth(F::span_h, setup + shift, shift);
    } else {
      const Real shift = offset(c_.start_offset.edge_h, format(F::edge_h));
      const Interval edge = add_depth(F::edge_h, add_depth(F::edge_h_acc, setup + shift, shift), shift);
      const Real span_shift = offset(c_.start_offset.span_h, c_.depth_format());
      add_depth(F::span_h, edge + span_shift, shift + span_shift);
    }
    const Interval code{0, 255};
    add(F::texture_mix, code, kNoTriangle);
    add(F::texture_color, code, kNoTriangle);
    add(F::fog_color, code, kNoTriangle);
    add(F::texture_alpha, Interval{0, 1}, kNoTriangle);
  }

  struct Point {
    Real x, y, h;
    std::array<Real, 2> uv;
    std::array<Real, 4> c;
  };

  static Real area_of(const std::array<Point, 3>& p) {
    return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  }

  Point vertex(const Vertex& v, std::int64_t triangle) {
    const auto finite = [&](double value, const char* name) {
      if (!std::isfinite(value))
        fail(name, "is not finite" + of_triangle(triangle) + "; legal: a finite number");
      return static_cast<Real>(value);
    };
    Point p{};
    p.x = coordinate(finite(v.x, "x"), "x", triangle);
    p.y = coordinate(finite(v.y, "y"), "y", triangle);
    const Real s = std::max(q(F::setup_s, std::ldexp(finite(v.s, "s"), -exponent_)), s_min_);
    p.h = q(F::setup_h, b_ * (s_max_ - s) / s);
    p.uv = {finite(v.u, "u"), finite(v.v, "v")};
    for (std::size_t i = 0; i < v.c.size(); ++i) p.c[i] = finite(v.c[i], "c");
    return p;
  }

  Real coordinate(Real x, const char* name, std::int64_t triangle) const {
    const Format f = c_.coordinate_format();
    if (!holds(f, x, x)) {
      int bits = f.integer;
      while (bits < 128 && !holds(with_integer(f, bits), x, x)) ++bits;
      fail("raster.coordinate_bits",
           "is " + std::to_string(c_.coordinate_bits) + ", too narrow for " + name + " = " + number(x) +
               of_triangle(triangle) + ", holds " + number(lowest(f) * ulp(f)) + ".." +
               number(highest(f) * ulp(f)) + "; needs " + std::to_string(bits) +
               (bits > kMostCoordinateBits ? ", more than the 24 there are: clip the triangle" : ""));
    }
    return rounded(x, f) * ulp(f);
  }

  void triangle(const Triangle& corners, std::int64_t index) {
    std::array<Point, 3> p{};
    for (std::size_t i = 0; i < 3; ++i) p[i] = vertex(corners.v[i], index);
    std::ranges::stable_sort(
        p, [](const Point& a, const Point& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
    if (area_of(p) == 0 && !corners.is_line) return;  // delivers no record
    for (Point& v : p) {
      for (Real& t : v.uv) {
        add(F::setup_uv, t, index);
        t = q(F::setup_uv, t);
      }
      for (Real& c : v.c) {
        add(F::setup_shade, c, index);
        c = q(F::setup_shade, c);
      }
    }
    const bool planes = has_plane_rows(c_.perspective);
    if (planes || has_setup_gradients(c_)) {
      for (const Point& v : p) {
        for (const Real t : v.uv) add(F::plane_g, t * (v.h + b_), index);
      }
    }
    if (corners.is_line) {
      line_ends(p[0], p[2], index);
    } else if (!planes) {
      edge(p[0], p[2], index);
      edge(p[0], p[1], index);
      edge(p[1], p[2], index);
    }
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    // A line has pixels on the first column and row, too.
    const auto meets = [&](Real low, Real high, int size) {
      return low < size && (corners.is_line ? high >= 0 : high > 0);
    };
    const bool seen = meets(left, right, view_.width) && meets(p[0].y, p[2].y, view_.height);
    if (!seen) return;
    for (std::size_t i = 0; i < 2; ++i) {
      if (has_setup_plane(c_)) {
        triangle_texture(p, i, index);
      } else {
        planes ? plane_texture(p, i, index) : span_texture(p, i, index);
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      Interval shade = hull(p, [i](const Point& v) { return v.c[i]; });
      if (!planes && !has_setup_plane(c_)) {
        shade = q(F::edge_shade_acc, shade + offset(c_.start_offset.edge_shade, format(F::edge_shade)));
        shade = q(F::edge_shade, shade);
      }
      shade = shade + offset(c_.start_offset.span_shade, format(F::span_shade));
      add(F::span_shade_acc, shade, index);
      add(F::span_shade, q(F::span_shade_acc, shade), index);
    }
  }

  // Returns whether every register holds what intervals around all triangles give, which is far less work
  // than looking at each. Where it is false, `triangle` decides. Every formula of `triangle` stands here,
  // too.
  bool surely_held(std::span<const Triangle> triangles) const {
    if (triangles.empty()) return true;
    const Extremes of(triangles);
    // The bounds know nothing of the ends of lines.
    if (!of.is_finite || of.has_line) return false;
    bool held = true;
    // The register's values. One that saturates on purpose keeps their order; others in doubt are left to
    // `triangle`.
    const auto keep = [&](F id, Interval x) {
      const Format& f = format(id);
      held = held && (holds(f, x.lo, x.hi) || (f.overflow_expected && saturates(f)));
      return q(id, x);
    };
    const auto around = [](Real most) { return Interval{-most, most}; };

    const Format coordinates = c_.coordinate_format();
    held = held && holds(coordinates, of.x.lo, of.x.hi) && holds(coordinates, of.y.lo, of.y.hi);
    const Interval x = Interval(of.x) + Interval{-ulp(coordinates), ulp(coordinates)};
    const Interval s = keep(F::setup_s, {std::ldexp(of.s.lo, -exponent_), std::ldexp(of.s.hi, -exponent_)});
    // h + B = B s_max / s in the vertex, up to an ulp of h and what the rounding of s makes of it.
    const Real scale = b_ * s_max_, s_ratio = 1 + ulp(format(F::setup_s)) / s_min_;
    const Real h_error = ulp(format(F::setup_h));
    const Real most_q = scale / std::max(s.lo, s_min_) + h_error;
    const Interval setup_h = keep_depth(F::setup_h, {0, most_q}, held);
    Real span_error = h_error;  // of h, where it comes by edges
    if (!has_plane_rows(c_.perspective) && !has_setup_plane(c_)) {
      const Real shift = offset(c_.start_offset.edge_h, format(F::edge_h));
      keep_depth(F::edge_h, keep_depth(F::edge_h_acc, setup_h + shift, held), held);
      span_error += std::fabs(shift) + ulp(format(F::edge_h_acc)) + ulp(format(F::edge_h));
    }
    const bool planes = has_plane_rows(c_.perspective), affine = has_linear_edges(c_.perspective);
    const Real unit = power(-exponent_);  // of s
    for (std::size_t i = 0; i < 2; ++i) {
      const Interval t = keep(F::setup_uv, of.t[i]);
      const Real most = std::max(std::fabs(t.lo), std::fabs(t.hi));
      // Bounds of a product of q and a coordinate, or a difference of two, each with the errors given.
      const auto times_q = [&](Real over_s, Real value, Real error, Real q_error) {
        return (over_s * scale * s_ratio / unit + value * q_error + error * (most_q + q_error)) *
               (1 + 0x1p-40L);
      };
      const Real t_error = ulp(format(F::setup_uv)), kept_error = t_error + ulp(format(F::edge_uv));
      const Real width = of.width[i] + 2 * t_error, kept_width = of.width[i] + 2 * kept_error;
      const Interval product = around(times_q(of.t_over_s[i], most, t_error, h_error));
      const Interval difference =
          affine ? around(width) : around(times_q(of.width_over_s[i], of.width[i], 2 * t_error, h_error));
      if (planes || has_setup_gradients(c_)) keep(F::plane_g, product);
      if (has_setup_plane(c_)) {
        const bool is_relative = has_pixel_reciprocal(c_.perspective);
        if (is_relative) keep(F::edge_uv, t);
        const Interval relative =
            affine ? around(kept_width)
                   : around(times_q(of.width_over_s[i], of.width[i], 2 * kept_error, h_error));
        const Interval f = keep(F::plane_g, is_relative ? relative : affine ? t : product);
        if (affine) {
          keep_linear(f, keep);
        } else {
          keep(F::span_f, f + offset(c_.start_offset.span_f, format(F::span_f)));
          keep(F::span_uv, t);
        }
        continue;
      }
      if (planes) {
        keep(F::span_f, keep(F::plane_g, product));
        keep_linear(t, keep);
        continue;
      }
      const Interval walked = (affine ? t : Interval{0, 0}) + keep(F::edge_f_diff, difference) +
                              offset(c_.start_offset.edge_f, format(F::edge_f));
      const Interval f = keep(F::edge_f, walked);
      const Interval kept = keep(F::edge_uv, affine ? f : t);
      if (affine) {
        keep_linear(kept, keep);
        continue;
      }
      keep(F::span_uv, kept);
      const Interval span =
          around(has_pixel_quotients(c_.perspective)
                     ? times_q(of.t_over_s[i], most, kept_error, span_error)
                     : times_q(of.width_over_s[i], of.width[i], 2 * kept_error, span_error));
      keep(F::span_f, keep(F::span_f_diff, span) + offset(c_.start_offset.span_f, format(F::span_f)));
    }
    if (!planes && has_x_step(c_)) {
      keep(F::edge_x, keep(F::edge_x_acc, x + offset(c_.start_offset.edge_x, format(F::edge_x))));
    } else if (!planes) {
      keep(F::edge_x, x);
    }
    Interval shade = keep(F::setup_shade, of.c);
    if (!planes && !has_setup_plane(c_)) {
      shade = keep(F::edge_shade_acc, shade + offset(c_.start_offset.edge_shade, format(F::edge_shade)));
      shade = keep(F::edge_shade, shade);
    }
    shade = shade + offset(c_.start_offset.span_shade, format(F::span_shade));
    keep(F::span_shade, keep(F::span_shade_acc, shade));
    return held;
  }

  // What fixed_ranges looks at; here only whether the order of values stays.
  Interval keep_depth(F id, Interval h, bool& held) const {
    const Format& f = format(id);
    held = held && (saturates(f) || holds(f, h.lo, h.hi));
    return q(id, h);
  }
  template <class Keep>
  void keep_linear(Interval uv, const Keep& keep) const {
    keep(F::span_uv, keep(F::span_uv_acc, uv + offset(c_.start_offset.span_f, format(F::span_uv))));
  }

  template <class Get>
  static Interval hull(const std::array<Point, 3>& p, Get get) {
    const auto [lo, hi] = std::minmax({get(p[0]), get(p[1]), get(p[2])});
    return {lo, hi};
  }

  void line_ends(const Point& a, const Point& b, std::int64_t index) {
    const auto pixel = [](Real at) { return std::floor(at); };
    const bool along_y = std::abs(pixel(b.y) - pixel(a.y)) > std::abs(pixel(b.x) - pixel(a.x));
    for (const Point& end : {a, b}) {
      add(F::edge_x, pixel(along_y ? end.y : end.x) + 0.5L, index);
      for (const Real t : end.uv) add(F::edge_uv, t, index);
      for (const Real c : end.c) add(F::edge_shade, c, index);
    }
  }

  void edge(const Point& a, const Point& b, std::int64_t index) {
    if (!(b.y > a.y)) return;
    const bool affine = has_linear_edges(c_.perspective);
    // Only the rows of the picture are walked.
    const Real from = std::max(a.y, Real{0.5L});
    const Real to = std::min(b.y, static_cast<Real>(view_.height) - 0.5L);
    const bool walked = from <= to;
    if (has_setup_plane(c_)) {
      if (walked) edge_x(a, b, from, to, index);
      return;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const Real diff = (b.uv[i] - a.uv[i]) * (affine ? 1 : b.h + b_);
      add(F::edge_f_diff, diff, index);
      if (!walked) continue;
      const Real start = affine ? a.uv[i] : 0;
      const Real end = start + q(F::edge_f_diff, diff);
      const Real shift = offset(c_.start_offset.edge_f, format(F::edge_f));
      const Interval f = Interval{std::min(start, end), std::max(start, end)} + shift;
      add(F::edge_f, f, index);
      const Interval uv{std::min(a.uv[i], b.uv[i]), std::max(a.uv[i], b.uv[i])};
      add(F::edge_uv, affine ? q(F::edge_f, f) : uv, index);
    }
    if (!walked) return;
    for (std::size_t i = 0; i < 4; ++i) {
      const Interval shade = Interval{std::min(a.c[i], b.c[i]), std::max(a.c[i], b.c[i])} +
                             offset(c_.start_offset.edge_shade, format(F::edge_shade));
      add(F::edge_shade_acc, shade, index);
      add(F::edge_shade, q(F::edge_shade_acc, shade), index);
    }
    edge_x(a, b, from, to, index);
  }

  void edge_x(const Point& a, const Point& b, Real from, Real to, std::int64_t index) {
    for (const Real y : {from, to}) {
      Real x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
      if (has_x_step(c_)) {
        x += offset(c_.start_offset.edge_x, format(F::edge_x));
        add(F::edge_x_acc, x, index);
        x = q(F::edge_x_acc, x);
      }
      add(F::edge_x, x, index);
    }
  }

  // i: 0 for u, 1 for v.
  void span_texture(const std::array<Point, 3>& p, std::size_t i, std::int64_t index) {
    std::array<Real, 3> t{};
    std::array<Real, 3> depth{};  // q = h + B at the vertices, as an edge delivers it
    for (std::size_t n = 0; n < 3; ++n) {
      t[n] = q(F::edge_uv, p[n].uv[i]);
      const Real h = q(F::edge_h_acc, p[n].h + offset(c_.start_offset.edge_h, format(F::edge_h)));
      depth[n] = q(F::edge_h, h) + b_;
    }
    const auto [least, most] = std::minmax({t[0], t[1], t[2]});
    if (has_linear_edges(c_.perspective)) {
      linear_texture({least, most}, index);
      return;
    }
    add(F::span_uv, Interval{least, most}, index);
    // (u - u_l) q is linear on the screen for any fixed u_l in least..most, so it is extreme at a vertex; u q
    // too.
    const bool hyperbolic = has_pixel_quotients(c_.perspective);
    Interval diff{hyperbolic ? t[0] * depth[0] : 0, hyperbolic ? t[0] * depth[0] : 0};
    for (std::size_t n = 0; n < 3; ++n) {
      diff.lo = std::min(diff.lo, (hyperbolic ? t[n] : t[n] - most) * depth[n]);
      diff.hi = std::max(diff.hi, (hyperbolic ? t[n] : t[n] - least) * depth[n]);
    }
    add(F::span_f_diff, diff, index);
    add(F::span_f, q(F::span_f_diff, diff) + offset(c_.start_offset.span_f, format(F::span_f)), index);
  }

  // slope.row = plane: the numerator is linear on the screen, so it is extreme at a vertex.
  void triangle_texture(const std::array<Point, 3>& p, std::size_t i, std::int64_t index) {
    Real from = 0;
    if (has_pixel_reciprocal(c_.perspective)) {
      add(F::edge_uv, p[0].uv[i], index);
      from = q(F::edge_uv, p[0].uv[i]);
    }
    const bool affine = has_linear_edges(c_.perspective);
    const Interval f = hull(p, [&](const Point& v) { return (v.uv[i] - from) * (affine ? 1 : v.h + b_); });
    add(F::plane_g, f, index);
    if (affine) {
      linear_texture(q(F::plane_g, f), index);
      return;
    }
    add(F::span_f, q(F::plane_g, f) + offset(c_.start_offset.span_f, format(F::span_f)), index);
    add(F::span_uv, hull(p, [i](const Point& v) { return v.uv[i]; }), index);
  }

  void plane_texture(const std::array<Point, 3>& p, std::size_t i, std::int64_t index) {
    add(F::span_f, hull(p, [&](const Point& v) { return q(F::plane_g, v.uv[i] * (v.h + b_)); }), index);
    linear_texture(hull(p, [i](const Point& v) { return v.uv[i]; }), index);
  }

  void linear_texture(Interval uv, std::int64_t index) {
    const Interval acc = uv + offset(c_.start_offset.span_f, format(F::span_uv));
    add(F::span_uv_acc, acc, index);
    add(F::span_uv, q(F::span_uv_acc, acc), index);
  }

  const Config& c_;
  const View view_;
  const std::string name_;
  std::array<Range, format_count> ranges_{};
  int exponent_ = 0;
  int projector_exponent_ = 0;  // of a view with a projector
  Real s_min_ = 0;
  Real s_max_ = 0;
  Real b_ = 0;
};

}  // namespace

struct PiecewiseRange::State {
  const Config& config;
  std::string name;
  RangeBy by;
  Views views;
  std::optional<RangeCheck> check;  // of the triangles of one view
  std::int64_t triangles = 0;       // seen

  // Those are looked at that are drawn with the view in force.
  void look(std::span<const Triangle> part) {
    if (!part.empty() && check && check->view() != views.now()) {
      check->report();
      check.reset();
    }
    if (!part.empty()) {
      if (!check) check.emplace(config, views.now(), name);
      check->look(part, triangles, by);
    }
    triangles += static_cast<std::int64_t>(part.size());
  }
};

PiecewiseRange::PiecewiseRange(const Config& config, const Scene& scene, RangeBy by)
    : state_(std::make_unique<State>(State{config, scene.name, by, Views(scene), {}})) {}

PiecewiseRange::~PiecewiseRange() = default;

bool PiecewiseRange::add(const Scene& piece) {
  std::size_t first = 0;
  const auto look = [&](std::size_t end) {
    state_->look(std::span(piece.triangles).subspan(first, end - first));
    first = end;
  };
  for (const DrawCommand& command : piece.commands) {
    if (!may_change_view(command)) continue;
    look(command.before);
    state_->views.execute(command);
  }
  look(piece.triangles.size());
  // A scene without triangles still has constants.
  if (!state_->check) state_->check.emplace(state_->config, state_->views.now(), state_->name);
  return state_->check->held();
}

void PiecewiseRange::finish() const {
  if (state_->check) state_->check->report();
}

void check_scene_range(const Config& config, const Scene& scene, RangeBy by) {
  PiecewiseRange range(config, scene, by);
  range.add(scene);
  range.finish();
}

}  // namespace bitspan
